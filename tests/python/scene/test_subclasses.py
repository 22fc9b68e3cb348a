"""A subclass of a public class is one of its kind: it builds, renders and pickles as its base does."""

import inspect
import pickle

import numpy as np
import pytest

import raywright as rw
from raywright import accelerators, cameras, integrators, lights, materials, media, shapes, textures
from raywright.rendering import filters, samplers
from raywright.scene.instance import Instance
from raywright.shapes.mesh import Mesh

GLASS, METAL, PAPER = rw.Dielectric(1.5), rw.Conductor("Au", roughness=0.2), rw.Diffuse((0.8, 0.5, 0.2))
PICTURE = np.random.default_rng(3).random((4, 8, 3)).astype(np.float32)
CORNERS = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], float)
FACES = np.array([[0, 1, 2], [0, 2, 3]])
DENSITY = np.linspace(0.1, 2, 27, dtype=np.float32).reshape(3, 3, 3)
# Arguments of the classes that need some, or that their defaults leave dull.
ARGUMENTS = {
    "MediumInterface": (rw.Homogeneous(0.1, 2.0),),
    "BumpMap": (PAPER, rw.Checker(0.0, 0.1, 3.0)),
    "Conductor": ("Cu",),
    "Mask": (PAPER, 0.5),
    "Mix": (PAPER, METAL, 0.3),
    "NormalMap": (PAPER, rw.Checker((0.5, 0.5, 1.0), (0.6, 0.5, 0.9), 3.0)),
    "SoapFilm": (400.0,),
    "ThinDielectric": (1.4,),
    "Tinted": (GLASS, 0.5),
    "TwoSided": (PAPER, METAL),
    "Cauchy": (1.5, 0.004),
    "Sellmeier": ((1.03961212, 0.231792344), (0.00600069867, 0.0200179144)),
    "ImageTexture": (PICTURE,),
    "MixTexture": (0.2, rw.Checker()),
    "ProductTexture": (0.5, rw.Checker()),
    "Spectrum": ((400, 550, 700), (0.1, 0.8, 0.3)),
    "Blackbody": (3000.0, 0.1),
    "ObjectTransform": (3.0,),
    "UvTransform": (3.0, 20.0),
    "PointLight": ((0, 2, 3), 20.0),
    "SpotLight": ((0, 0, 4), (0, 0, 0), 20.0),
    "DirectionalLight": ((0, -1, -1), 3.0),
    "ProjectorLight": (PICTURE, (0, 0, 4), (0, 0, 0)),
    "EnvironmentMap": (PICTURE,),
    "SunSky": ((0.2, 1, 0.5),),
    "Emission": (2.0, True),
    "Homogeneous": (0.1, 0.3),
    "HenyeyGreenstein": (0.4,),
    "Polygon": (CORNERS,),
    "Implicit": ("x**2 + y**2 + z**2 - 0.5",),
    "Mesh": (CORNERS, FACES),
    "Instance": ([rw.Sphere(radius=0.5)], np.eye(4)),
    "Camera": ((0, 1, 4), (0, 0, 0)),
    "Fisheye": ((0, 1, 4), (0, 0, 0)),
    "Panorama": ((0, 1, 4), (0, 0, 0)),
    "Pose": ((0, 1, 4), (0, 0, 0)),
    "CroppedFilter": (rw.rendering.GaussianFilter(),),
}
NAMED = {
    "GridMedium": {"density": DENSITY, "scattering": 1.0, "bounds": ((-2, -2, -2), (2, 2, 2))},
    "Orthographic": {"position": (0, 1, 4), "target": (0, 0, 0), "scale": 3.0},
    "ThinFilm": {"thickness": 300.0, "base": GLASS},
    "ThinLens": {"position": (0, 1, 4), "target": (0, 0, 0), "aperture_radius": 0.1},
    "PhotonMap": {"photons": 500},
    "ProgressivePhotonMap": {"photons": 500},
}
# What has no instances of its own, is found by a function, or is final (SparseGrid).
BASES = {
    *("Material", "Texture", "Medium", "Shape", "Light", "Environment", "AnyCamera", "Integrator"),
    *("CoreIntegrator", "Dispersion", "Illuminants", "Glasses", "MetalIndex", "SparseGrid"),
    *("AcceleratorInfo", "Rng"),
}
MODULES = (accelerators, cameras, integrators, lights, materials, media, shapes, textures)
PUBLIC = {
    kind.__name__: kind
    for kind in (
        *(getattr(module, name) for module in MODULES for name in module.__all__),
        *(
            vars(module)[name]
            for module in (samplers, filters)
            for name in vars(module)
            if name in rw.rendering.__all__
        ),
        *(Mesh, Instance),
    )
    if inspect.isclass(kind) and kind.__name__ not in BASES
}
CAMERA = rw.Camera((0, 1, 4), (0, 0, 0), width=8, height=8)
BALL = rw.Sphere(radius=0.8, material=PAPER)


def arguments(name):
    if name == "Radiosity":
        return (rw.radiosity(room()),), {}
    return ARGUMENTS.get(name, ()), NAMED.get(name, {})


def room(emission=3.0):
    above = rw.Mesh(CORNERS + np.array([0, 0, 1]), FACES[:, ::-1], emission=emission)
    floor = rw.Mesh(CORNERS * 2, FACES, material=PAPER)
    return rw.Scene([floor, above], lights=[rw.PointLight((0, 1, 3), 9.0)])


def own(kind):
    """Return an instance of a subclass whose constructor takes nothing, with an attribute of its own."""
    given, named = arguments(kind.__name__)

    def make(self):
        kind.__init__(self, *given, **named)
        object.__setattr__(self, "note", "mine")

    name = f"Own{kind.__name__}"
    # Where pickles look for it.
    globals()[name] = type(name, (kind,), {"__init__": make, "__module__": __name__})
    return globals()[name]()


def quad(texture):
    look = {"uv": CORNERS[:, :2] + 1.0, "colors": np.abs(CORNERS) / 2}
    return rw.Mesh(CORNERS, FACES, **look, material=rw.Diffuse(texture))


def picture(thing):
    """Return a small picture that depends on a thing of any kind."""
    shape, rest, how, camera = BALL, {}, {}, CAMERA
    if isinstance(thing, rw.Pose) and not isinstance(thing, cameras.AnyCamera):
        camera = rw.Camera((1, 1, 4), (0, 0, 0), width=8, height=8, end_pose=thing)
    elif isinstance(thing, cameras.AnyCamera):
        camera = cameras.any_camera.resized(thing, 8, 8)
    elif isinstance(thing, materials.Material):
        shape = rw.Sphere(material=thing)
    elif isinstance(thing, materials.Dispersion):
        shape = rw.Sphere(material=rw.Dielectric(thing))
    elif isinstance(thing, rw.textures.UvTransform | rw.textures.ObjectTransform):
        shape = quad(rw.Checker(transform=thing))
    elif isinstance(thing, textures.Texture):
        shape = quad(thing)
    elif isinstance(thing, shapes.Shape | Mesh | Instance):
        shape = thing
    elif isinstance(thing, rw.Emission):
        shape = rw.Sphere(emission=thing)
    elif isinstance(thing, media.Medium):
        rest["medium"] = thing
    elif isinstance(thing, rw.media.Isotropic | rw.media.Rayleigh | rw.HenyeyGreenstein):
        rest["medium"] = rw.Homogeneous(0.1, 0.3, thing)
    elif isinstance(thing, lights.Environment):
        rest["environment"] = thing
    elif isinstance(thing, lights.Light):
        rest["lights"] = [thing]
    elif type(thing).__module__.startswith("raywright.accelerators") or isinstance(
        thing, accelerators.Accelerator
    ):
        rest["accelerator"] = thing
    elif isinstance(thing, samplers.Sampler):
        how["sampler"] = thing
    elif isinstance(thing, filters.Filter):
        how["filter"] = thing
    else:
        how["integrator"] = thing
    if isinstance(thing, rw.Radiosity | rw.integrators.BeamTraced | rw.integrators.ConeTraced):
        scene = room(None if isinstance(thing, rw.integrators.BeamTraced) else 3.0)
    else:
        light = {} if "lights" in rest else {"environment": rw.ConstantEnvironment((0.9, 1.0, 0.8))}
        scene = rw.Scene([shape], **{**light, **rest})
    return rw.render(
        scene, camera, samples=2, seed=5, threads=1, **{"integrator": rw.Path(max_depth=3), **how}
    ).rgb


@pytest.mark.parametrize("kind", PUBLIC.values(), ids=PUBLIC)
@pytest.mark.filterwarnings("ignore")
def test_a_subclass_of_any_public_class_works_like_its_base(kind):
    given, named = arguments(kind.__name__)
    expected = picture(kind(*given, **named))
    mine = own(kind)
    assert picture(mine).tobytes() == expected.tobytes()
    back = pickle.loads(pickle.dumps(mine))
    assert type(back) is type(mine)
    assert picture(back).tobytes() == expected.tobytes()


def test_all_kinds_are_among_them():
    assert len(PUBLIC) > 80


@pytest.mark.parametrize(
    ("stranger", "use"),
    [
        (type("Diffuse", (materials.Material,), {"reflectance": 0.5}), lambda m: rw.Sphere(material=m)),
        (type("Homogeneous", (media.Medium,), {}), lambda m: rw.Sphere(material=rw.MediumInterface(m))),
        (type("Wood", (textures.Texture,), {"range": ((0, 0, 0), (1, 1, 1))}), lambda t: quad(t)),
    ],
    ids=["material", "medium", "texture"],
)
def test_a_class_of_the_same_name_is_a_stranger(stranger, use):
    scene = rw.Scene([use(stranger())])
    with pytest.raises(TypeError, match=f"got {stranger.__name__}"):
        scene.intersect([[0, 0, 5]], [[0, 0, -1]])


def test_a_copy_keeps_its_class_and_what_is_its_own():
    ball = own(rw.Sphere)
    moved = rw.Scene([Instance([ball], np.diag([2.0, 2, 2, 1]))])
    assert moved.intersect([[0, 0, 5]], [[0, 0, -1]]).t[0] == 3.0
    back = pickle.loads(pickle.dumps(own(rw.Mesh)))
    assert back.note == "mine"
    assert not back.vertices.flags.writeable
