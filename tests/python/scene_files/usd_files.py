"""Stages of USD, written for tests."""

import raywright as rw

HEAD = '#usda 1.0\n(\n    upAxis = "Z"\n)\n'
CAMERA = """
def Camera "Eye" {
    double3 xformOp:translate = (0, 0, 6)
    uniform token[] xformOpOrder = ["xformOp:translate"]
    float focalLength = 50
    float horizontalAperture = 36
    float verticalAperture = 24
}
"""
LAMP = 'def DistantLight "Sun" {\n    float inputs:intensity = 2\n    bool inputs:normalize = 1\n}\n'
PAINT = """
def Material "Paint" {{
    token outputs:surface.connect = </Paint/S.outputs:surface>
    def Shader "S" {{
        uniform token info:id = "UsdPreviewSurface"
        {inputs}
        token outputs:surface
    }}
    {more}
}}
"""
SQUARE = """
def Mesh "Square" (prepend apiSchemas = ["MaterialBindingAPI"]) {
    int[] faceVertexCounts = [4]
    int[] faceVertexIndices = [0, 1, 2, 3]
    point3f[] points = [(0, 0, 0), (2, 0, 0), (2, 1, 0), (0, 1, 0)]
    texCoord2f[] primvars:st = [(0, 0), (1, 0), (1, 1), (0, 1)] (interpolation = "faceVarying")
    rel material:binding = </Paint>
    uniform token subdivisionScheme = "none"
    double3 xformOp:scale = (1, 2, 1)
    uniform token[] xformOpOrder = ["xformOp:scale"]
}
"""


def paint(inputs, more=""):
    """Return a material with these inputs, and further shaders."""
    return PAINT.format(inputs=inputs, more=more)


def picture(name, inputs, outputs="float3 outputs:rgb"):
    """Return a shader that reads a picture by the coordinates of the mesh."""
    return f"""
    def Shader "P" {{
        uniform token info:id = "UsdUVTexture"
        asset inputs:file = @{name}@
        token inputs:wrapS = "clamp"
        token inputs:wrapT = "clamp"
        {inputs}
        float2 inputs:st.connect = </Paint/R.outputs:result>
        {outputs}
    }}
    def Shader "R" {{
        uniform token info:id = "UsdPrimvarReader_float2"
        string inputs:varname = "st"
        float2 outputs:result
    }}
"""


def write(folder, text, head=HEAD):
    """Write a stage, and return its path."""
    path = folder / "stage.usda"
    path.write_text(head + text, encoding="utf-8")
    return path


def load(folder, text, head=HEAD, **more):
    """Return the shot of a stage."""
    return rw.load(write(folder, text, head), **more)


def shapes(folder, text):
    """Return the shapes of a stage that has a camera and a light as well."""
    return load(folder, CAMERA + LAMP + text).scene.shapes
