"""Pictures in notebooks, as they come."""

import base64
import pickle
import subprocess
import sys
import types

import pytest

import raywright as rw

BOX = {"width": 64, "height": 64}


class Handle:
    """What IPython has for an output that changes."""

    made: list["Handle"]

    def __init__(self):
        self.calls = []
        self.made.append(self)

    def display(self, shown):
        self.calls.append(("display", shown))

    def update(self, shown):
        self.calls.append(("update", shown))


@pytest.fixture
def handles(monkeypatch):
    """IPython within a kernel, as far as it is asked; the handles that were made of it."""
    made = []
    shell = types.SimpleNamespace(kernel=object())
    ipython = types.ModuleType("IPython")
    ipython.get_ipython = lambda: shell
    ipython.display = types.ModuleType("IPython.display")
    ipython.display.DisplayHandle = type("DisplayHandle", (Handle,), {"made": made})
    monkeypatch.setitem(sys.modules, "IPython", ipython)
    monkeypatch.setitem(sys.modules, "IPython.display", ipython.display)
    made_of = types.SimpleNamespace(made=made, shell=shell)
    return made_of


def test_an_image_shows_itself_while_it_renders(handles):
    image = rw.render(*rw.scenes.cornell_box(**BOX), seconds=1.0)
    (handle,) = handles.made
    names = [name for name, _ in handle.calls]
    assert names == ["display"] + ["update"] * (len(names) - 1)
    assert len(names) >= 3
    assert handle.calls[-1][1] is image
    samples = [shown.samples for _, shown in handle.calls]
    assert samples == sorted(samples)
    assert samples[0] < image.samples
    assert all(shown._repr_png_().startswith(b"\x89PNG") for _, shown in handle.calls)


def test_it_is_quiet_when_told(handles):
    rw.render(*rw.scenes.cornell_box(**BOX), seconds=0.3, progress=False)
    rw.render(*rw.scenes.cornell_box(**BOX), seconds=0.3, progress=lambda image: None)
    assert handles.made == []


def test_a_terminal_shows_no_pictures(handles):
    handles.shell.kernel = None
    rw.render(*rw.scenes.cornell_box(**BOX), samples=2)
    del handles.shell.kernel
    rw.render(*rw.scenes.cornell_box(**BOX), samples=2)
    assert handles.made == []


def test_the_cell_that_rendered_it_shows_no_second_picture(handles, capsys):
    handles.shell.execution_count = 7
    image = rw.render(*rw.scenes.cornell_box(**BOX), samples=2)
    capsys.readouterr()
    image._ipython_display_()
    assert capsys.readouterr().out == f"{image!r}\n"
    # Copies, later cells, and pictures not yet shown use their PNG.
    copy = pickle.loads(pickle.dumps(image))
    assert copy == image
    quiet = rw.render(*rw.scenes.cornell_box(**BOX), samples=2, progress=False)
    for other in (copy, quiet):
        with pytest.raises(NotImplementedError):
            other._ipython_display_()
    handles.shell.execution_count = 8
    with pytest.raises(NotImplementedError):
        image._ipython_display_()
    assert capsys.readouterr().out == ""


def test_nothing_is_imported_for_it():
    code = (
        "import sys, raywright as rw; rw.render(*rw.scenes.cornell_box(width=8, height=8), samples=1);"
        "print('IPython' in sys.modules)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60
    )
    assert done.stdout == "False\n"


@pytest.mark.filterwarnings("default")
def test_a_real_kernel_sends_the_picture_again_and_again():
    nbclient = pytest.importorskip("nbclient", reason="nbclient is not installed")
    pytest.importorskip("ipykernel", reason="ipykernel is not installed")
    import nbformat

    source = (
        "import raywright as rw\n"
        "image = rw.render(*rw.scenes.cornell_box(width=64, height=64), seconds=1.0)\n"
        "import base64; print(base64.b64encode(image._repr_png_()).decode())"
    )
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(source)])
    heard = []

    class Client(nbclient.NotebookClient):
        def process_message(self, message, cell, index):
            heard.append(message["header"]["msg_type"])
            return super().process_message(message, cell, index)

    Client(notebook, timeout=60, kernel_name="python3").execute()
    assert heard.count("display_data") == 1
    assert heard.count("update_display_data") >= 2
    outputs = notebook.cells[0].outputs
    (last,) = (one for one in outputs if one.output_type == "display_data")
    text = "".join(one.text for one in outputs if one.get("name") == "stdout").strip()
    assert last.data["image/png"].replace("\n", "") == text
    assert base64.b64decode(text).startswith(b"\x89PNG")


@pytest.mark.filterwarnings("default")
def test_a_real_kernel_shows_one_picture_a_cell():
    nbclient = pytest.importorskip("nbclient", reason="nbclient is not installed")
    pytest.importorskip("ipykernel", reason="ipykernel is not installed")
    import nbformat

    render = "rw.render(*rw.scenes.cornell_box(width=32, height=32), samples=4)"
    sources = [
        f"import raywright as rw\n{render}",
        f"image = {render}",
        "image",
        f"image = {render}\nimage",
        f"image = {render[:-1]}, progress=False)\nimage",
    ]
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(source) for source in sources])
    nbclient.NotebookClient(notebook, timeout=120, kernel_name="python3").execute()
    for cell in notebook.cells:
        shown = [one for one in cell.outputs if "image/png" in one.get("data", ())]
        assert len(shown) == 1, cell.source
        assert not [one for one in cell.outputs if one.output_type == "error"]
