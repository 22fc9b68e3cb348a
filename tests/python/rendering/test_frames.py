"""Animations: each frame is the picture that it would be alone."""

import sys
import types

import numpy as np
import pytest

import raywright as rw

HOW = {"samples": 4, "progress": False}


@pytest.fixture
def moving():
    """A mesh that goes to the right from frame to frame, in one scene."""
    corners = np.array([(-1, -1, 0), (0, -1, 0), (0, 0, 0), (-1, 0, 0)], float)
    scene = rw.Scene(rw.Mesh(corners, [(0, 1, 2), (0, 2, 3)]), environment=0.7)
    camera = rw.Camera((0, 0, 4), (0, 0, 0), fov=40, width=16, height=12)

    def frame(number):
        scene.refit(corners + np.array([0.3 * number, 0, 0]))
        return scene, camera

    return frame


def test_ten_frames_are_the_pictures_that_they_are_alone(moving):
    seen = {}
    assert rw.render_frames(moving, seen.__setitem__, 10, seed=2**64 - 3, **HOW) == []
    assert list(seen) == list(range(10))
    for number, image in seen.items():
        alone = rw.render(*moving(number), seed=(2**64 - 3 + number) % 2**64, **HOW)
        assert np.array_equal(image.rgb, alone.rgb)
    # The object has moved, and the noise differs.
    assert not np.array_equal(seen[0].rgb, seen[9].rgb)


def test_files_are_named_by_number(moving, tmp_path):
    still = [moving(0)] * 5
    paths = rw.render_frames(iter(still), tmp_path / "a{:03}.png", 3, exposure=1.0, tone="linear", **HOW)
    assert paths == [tmp_path / f"a{i:03}.png" for i in range(3)]
    assert sorted(tmp_path.iterdir()) == paths
    expected = tmp_path / "b.png"
    rw.render(*moving(0), seed=2, **HOW).save(expected, 1.0, "linear")
    assert paths[2].read_bytes() == expected.read_bytes()


def test_not_more_frames_are_made_than_are_wanted(moving):
    made = []
    every = (made.append(i) or moving(i) for i in range(9))
    rw.render_frames(every, lambda *_: None, 2, **HOW)
    assert made == [0, 1]


def test_a_bar_counts_frames_and_nothing_else(moving, capsys):
    rw.render_frames(moving, lambda *_: None, 2, samples=1)
    told = capsys.readouterr().err
    assert "2/2" in told
    assert "relMSE" not in told


class Film:
    """Takes the place of imageio."""

    def __init__(self, path, **how):
        self.path, self.how, self.frames, self.closed = path, how, [], False

    def append_data(self, frame):
        self.frames.append(frame)

    def close(self):
        self.closed = True
        self.path.write_bytes(b"film")


@pytest.fixture
def films(monkeypatch):
    made = []

    def get_writer(path, **how):
        made.append(Film(path, **how))
        return made[-1]

    monkeypatch.setitem(sys.modules, "imageio", types.SimpleNamespace(get_writer=get_writer))
    return made


def test_films_have_their_frames(moving, tmp_path, films):
    path = tmp_path / "a.mp4"
    seen = {}
    rw.render_frames(moving, seen.__setitem__, 3, **HOW)
    assert rw.render_frames(moving, path, 3, fps=30, **HOW) == [path]
    (film,) = films
    assert (film.path, film.closed, film.how["fps"]) == (path, True, 30.0)
    assert all(np.array_equal(frame, seen[i].srgb()) for i, frame in enumerate(film.frames))
    assert len(film.frames) == 3


def test_what_is_interrupted_keeps_what_is_done(moving, tmp_path, films):
    def frame(number):
        if number == 2:
            raise KeyboardInterrupt
        return moving(number)

    with pytest.raises(KeyboardInterrupt):
        rw.render_frames(frame, tmp_path / "a.mp4", 5, **HOW)
    assert films[0].closed
    assert len(films[0].frames) == 2


def test_films_have_the_sizes_that_their_codecs_have(tmp_path, films):
    def odd(number):
        eye = rw.Camera((0, 0, 4), (0, 0, 0), width=16, height=12 + number)
        return rw.Scene(rw.Sphere(), environment=1.0), eye

    with pytest.raises(ValueError, match="frame 1 is 16 by 13, but a video must have an even width"):
        rw.render_frames(odd, tmp_path / "a.mp4", 2, **HOW)
    assert len(films[0].frames) == 1
    rw.render_frames(odd, tmp_path / "a.webm", 2, **HOW)
    assert films[1].how["codec"] == "libvpx-vp9"


def test_an_encoder_that_fails_is_told(moving, tmp_path, films, monkeypatch):
    monkeypatch.setattr(Film, "close", lambda film: None)
    with pytest.raises(OSError, match="its encoder wrote no video"):
        rw.render_frames(moving, tmp_path / "a.mp4", 2, **HOW)


# imageio leaves its own pipes open.
@pytest.mark.filterwarnings("ignore:unclosed file:ResourceWarning")
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize("name", ["a.mp4", "a.mov", "a.mkv", "a.webm"])
def test_films_can_be_read(moving, tmp_path, name):
    imageio = pytest.importorskip("imageio")
    pytest.importorskip("imageio_ffmpeg")
    rw.render_frames(moving, tmp_path / name, 2, **HOW)
    with imageio.get_reader(tmp_path / name) as film:
        assert [film.get_data(0).shape, film.count_frames()] == [(12, 16, 3), 2]


def test_a_film_without_imageio_names_the_extra(moving, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "imageio", None)
    with pytest.raises(ImportError, match=r"a film needs imageio: pip install 'raywright\[video\]'"):
        rw.render_frames(moving, tmp_path / "a.mp4", 2, **HOW)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("change", "error", "told"),
    [
        ({"count": None}, ValueError, "count must be given where frames is a function"),
        ({"frames": 3}, TypeError, "frames must be a function or give scenes and cameras, got int"),
        ({"frames": [7]}, TypeError, "frame 0 must be a scene and a camera, got int"),
        ({"out": "a.png"}, ValueError, "out must have a place for the frame's number"),
        ({"out": "a{:04}{:04}.png"}, ValueError, "out must have one place for the frame's number"),
        ({"out": "a{name}.png"}, ValueError, "out must have one place for the frame's number"),
        ({"out": "a{}.gif"}, ValueError, "a picture is saved as"),
        ({"out": 3}, TypeError, "out must be a path or a function, got int"),
        ({"fps": 0}, ValueError, "fps must be greater than 0, got 0"),
        ({"tone": "dark"}, ValueError, "tone must be one of"),
        ({"progress": 3}, TypeError, "progress must be True or False, got 3"),
        ({"seed": -1}, ValueError, "seed must be"),
        ({"samples": 0}, ValueError, "samples must be"),
    ],
)
def test_wrong_arguments_are_told_in_one_line(moving, tmp_path, monkeypatch, change, error, told):
    monkeypatch.chdir(tmp_path)
    how = {"frames": moving, "out": "a{}.png", "count": 1, **HOW, **change}
    with pytest.raises(error, match=told):
        rw.render_frames(**how)
    assert list(tmp_path.iterdir()) == []


def test_frames_may_be_previews(moving, tmp_path):
    seen = {}
    sun = (0, 1, 1)
    assert rw.render_frames(moving, seen.__setitem__, 3, progress=False, preview=sun, ambient=0.25) == []
    for number, image in seen.items():
        scene, camera = moving(number)
        wanted = scene.preview(camera, sun, dtype=np.float32, ambient=0.25)
        assert np.array_equal(image.rgb, wanted)
        # How wrong it is nobody knows.
        assert np.isnan(image.error.estimate)
    files = rw.render_frames(moving, str(tmp_path / "{}.png"), 2, progress=False, preview="headlight")
    assert [file.name for file in files] == ["0.png", "1.png"]
    with pytest.raises(TypeError, match="scene of frame 0 must be a Scene, got str"):
        rw.render_frames([("scene", moving(0)[1])], print, progress=False, preview="headlight")
    with pytest.raises(TypeError, match="samples"):
        rw.render_frames(moving, print, 1, progress=False, preview="headlight", samples=4)
