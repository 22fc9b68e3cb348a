"""Renders that were interrupted: their bits, their files, and what is refused."""

import errno
import json
import os
import pickle
import random
import signal
import subprocess
import sys
import threading
import time
import warnings
import zlib

import numpy as np
import pytest

import raywright as rw
from raywright.rendering import checkpoints

MAGIC = b"raywright checkpoint 1\n"
LIMITS = {"samples": 40, "seed": 5, "progress": False, "sampler": rw.rendering.Sobol(4)}


@pytest.fixture
def box():
    return rw.scenes.cornell_box(width=24, height=18)


@pytest.fixture
def path(tmp_path):
    return tmp_path / "box.checkpoint"


@pytest.fixture
def often(monkeypatch):
    """Checkpoints are written as often as can be."""
    monkeypatch.setattr(checkpoints, "_SECONDS", 0.0)
    monkeypatch.setattr(checkpoints, "_SHARE", 0.0)


def assert_same(a, b):
    assert np.array_equal(a.rgb, b.rgb)
    assert np.array_equal(a.standard_error, b.standard_error, equal_nan=True)
    assert (a.error, a.samples, a.biased) == (b.error, b.samples, b.biased)
    assert a.aov.keys() == b.aov.keys()
    assert all(np.array_equal(a.aov[name], b.aov[name]) for name in a.aov)
    for name in ("samples", "error"):
        assert np.array_equal(a.history[name], b.history[name], equal_nan=True)


def interrupt_after(seconds):
    timer = threading.Timer(seconds, signal.raise_signal, (signal.SIGINT,))
    timer.start()
    return timer


class Interrupts(rw.integrators.Integrator):
    """Something noisy in Python that presses Ctrl-C at its n-th batch."""

    def __init__(self, at=-1):
        self.at, self.batches = [at], [0]

    def __reduce__(self):
        return Interrupts, ()

    def radiance(self, scene, rays, rng):
        self.batches[0] += 1
        if self.batches[0] == self.at[0]:
            signal.raise_signal(signal.SIGINT)
        return np.stack([rng.next_1d() ** 3 for _ in range(3)], axis=1)


@pytest.mark.parametrize("how", [{}, {"adaptive": True}, {"clamp": 2.0}, {"adaptive": True, "clamp": 2.0}])
def test_interrupted_and_resumed_is_never_interrupted(box, path, how, often):
    whole = rw.render(*box, **LIMITS, **how)
    began = rw.render(*box, **{**LIMITS, "samples": 4}, **how, checkpoint=path)
    assert began.samples == 4
    assert_same(rw.render(*box, **LIMITS, **how, checkpoint=path), whole)
    # A finished render returns at once, for any number of threads.
    assert_same(rw.render(*box, **LIMITS, **how, checkpoint=path, threads=1), whole)


def test_a_sampler_goes_on_with_the_batches_it_began_with(box, path):
    few, many = ({"samples": samples, "seed": 5, "progress": False} for samples in (16, 64))
    begun = {"sampler": rw.rendering.Sobol(), "checkpoint": path}
    rw.render(*box, **few, **begun)
    # 16 samples have batches of four, and 64 batches of sixteen.
    assert_same(rw.render(*box, **many, **begun), rw.render(*box, **many, sampler=rw.rendering.Sobol(4)))
    with pytest.raises(ValueError, match=r"it has sampler Sobol\(batch=4\) instead of Sobol\(batch=8\)"):
        rw.render(*box, **many, sampler=rw.rendering.Sobol(8), checkpoint=path)


def test_a_sampler_that_was_chosen_is_kept(box, path):
    few, many = ({"samples": samples, "seed": 5, "progress": False} for samples in (16, 256))
    begun = rw.render(*box, **few, checkpoint=path)
    gone_on = rw.render(*box, **many, checkpoint=path)
    assert gone_on.plan.sampler == begun.plan.sampler
    assert [row.why for row in gone_on.plan.rows] == ["as the checkpoint has it"] * 4
    assert_same(gone_on, rw.render(*box, **many, sampler=begun.plan.sampler))
    # Named options apply as named, or are refused.
    with pytest.raises(ValueError, match=r"it has sampler .* instead of Independent\(\)"):
        rw.render(*box, **many, sampler=rw.rendering.Independent(), checkpoint=path)
    alone = path.with_name("alone")
    rw.render(*box, **few, sampler=rw.rendering.Independent(), checkpoint=alone)
    assert rw.render(*box, **many, checkpoint=alone).plan.sampler == rw.rendering.Independent()


def test_ctrl_c_writes_and_is_passed_on_within_a_pass(path):
    # One pass takes longer than the test waits.
    box = rw.scenes.cornell_box(width=200, height=150)
    timer = interrupt_after(1.0)
    began = time.perf_counter()
    with pytest.raises(KeyboardInterrupt):
        rw.render(*box, samples=100_000, progress=False, checkpoint=path)
    assert time.perf_counter() - began < 10
    timer.join()
    of = rw.render(*box, seconds=1e-9, progress=False, checkpoint=path)
    # The begun render is completed first, with identical bits.
    again = rw.render(*box, of.plan.path, samples=of.samples, sampler=of.plan.sampler, progress=False)
    assert np.array_equal(of.rgb, again.rgb)
    assert of.error == again.error


def test_time_goes_on_where_it_was(box, path):
    first = rw.render(*box, seconds=0.4, progress=False, checkpoint=path)
    again = rw.render(*box, seconds=0.4, progress=False, checkpoint=path)
    assert_same(first, again)
    assert again.seconds >= first.history["seconds"][-1]
    more = rw.render(*box, seconds=0.8, progress=False, checkpoint=path)
    assert more.samples > first.samples
    assert len(more.history) > len(first.history)
    assert (np.diff(more.history["seconds"]) > 0).all()


@pytest.mark.parametrize("at", [1, 3, 6])
def test_python_integrators_may_be_interrupted_in_their_midst(path, at):
    scene, camera = rw.Scene([], environment=1.0), rw.Camera((0, 0, 5), (0, 0, 0), width=160, height=120)
    whole = rw.render(scene, camera, Interrupts(), samples=40, progress=False)
    with pytest.raises(KeyboardInterrupt):
        rw.render(scene, camera, Interrupts(at), samples=40, progress=False, checkpoint=path)
    assert_same(rw.render(scene, camera, Interrupts(), samples=40, progress=False, checkpoint=path), whole)


SCRIPT = """
import sys, raywright as rw
from raywright.rendering import checkpoints
checkpoints._SECONDS = checkpoints._SHARE = 0.0
scene, camera = rw.scenes.cornell_box(width=32, height=24)
image = rw.render(
    scene,
    camera,
    samples=400,
    seed=1,
    progress=False,
    threads=2,
    adaptive=bool(int(sys.argv[3])),
    checkpoint=sys.argv[1],
)
import numpy as np
np.savez(sys.argv[2], rgb=image.rgb, error=image.standard_error, counts=image.aov.get("samples", 0))
"""


@pytest.mark.slow
@pytest.mark.parametrize(("adaptive", "moments_in_all"), [(0, 12), (1, 8)])
def test_kill_9_at_twenty_moments(tmp_path, adaptive, moments_in_all):
    def start(name):
        command = [sys.executable, "-c", SCRIPT, tmp_path / f"{name}.checkpoint", tmp_path / f"{name}.npz"]
        return subprocess.Popen([*command, str(adaptive)])

    assert start("whole").wait(timeout=300) == 0
    moments = random.Random(7)
    killed = 0
    while killed < moments_in_all:
        process = start("killed")
        # From before the first checkpoint to long after; a start takes about half a second.
        try:
            process.wait(timeout=moments.uniform(0.3, 1.5))
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGKILL)
            process.wait()
            killed += 1
        else:
            # It has ended: the next one starts again.
            assert process.returncode == 0
            compare(tmp_path)
            (tmp_path / "killed.checkpoint").unlink()
    assert start("killed").wait(timeout=300) == 0
    compare(tmp_path)


def compare(folder):
    with np.load(folder / "whole.npz") as whole, np.load(folder / "killed.npz") as killed:
        for name in whole.files:
            assert np.array_equal(whole[name], killed[name]), name


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"seed": 6}, r"seed 5 instead of 6"),
        ({"adaptive": True}, r"adaptive False instead of True"),
        ({"clamp": 3.0}, r"clamp None instead of 3\.0"),
        ({"integrator": rw.Path(max_depth=3)}, r"another integrator"),
        ({"camera": rw.Camera((0, 0, 5), (0, 0, 0), width=24, height=18)}, r"another camera"),
        (
            {"camera": rw.Camera((0, 0, 5), (0, 0, 0), width=24, height=20)},
            r"height 18 instead of 20.* camera",
        ),
        ({"scene": rw.Scene([], environment=1.0)}, r"another scene"),
        ({"background": "transparent"}, r"background shown instead of transparent"),
        ({"scene": rw.Scene([], environment=1.0), "seed": 1}, r"another scene, seed 5 instead of 1"),
    ],
)
def test_of_another_render_it_is_refused(box, path, change, told):
    arguments = {"scene": box[0], "camera": box[1], "integrator": rw.Path(), **LIMITS, "checkpoint": path}
    rw.render(**{**arguments, "samples": 2})
    before = path.read_bytes()
    with pytest.raises(ValueError, match=rf"checkpoint .* is of another render: it has {told}") as caught:
        rw.render(**{**arguments, **change})
    assert "\n" not in str(caught.value)
    assert path.read_bytes() == before


def test_the_same_scene_is_the_same_however_it_came_to_be(box, path):
    rw.render(*box, **{**LIMITS, "samples": 4}, checkpoint=path)
    other = pickle.loads(pickle.dumps(box))
    assert_same(rw.render(*other, **LIMITS, checkpoint=path), rw.render(*box, **LIMITS))


@pytest.mark.parametrize("part", [0, 5, len(MAGIC), len(MAGIC) + 3, 100, 0.5, 0.99, -1])
def test_truncated_is_refused(box, path, part):
    rw.render(*box, **{**LIMITS, "samples": 3}, checkpoint=path)
    data = path.read_bytes()
    path.write_bytes(data[: int(part * len(data))] if isinstance(part, float) else data[:part])
    with pytest.raises(ValueError, match=r"^checkpoint \S+ is [a-z ]+$"):
        rw.render(*box, **LIMITS, checkpoint=path)


def test_hostile_bytes_are_refused_whatever_they_are(box, path):
    rw.render(*box, **{**LIMITS, "samples": 20}, adaptive=True, checkpoint=path)
    data = path.read_bytes()
    header = header_of(data)
    of, film = header["of"], zlib.decompress(data[-header["packed"] :])

    def write(film, **change):
        packed = zlib.compress(film, 1)
        text = json.dumps({"of": of, "bytes": len(film), "packed": len(packed), **change}).encode()
        path.write_bytes(MAGIC + len(text).to_bytes(4, "little") + text + packed)

    def attempt():
        return rw.render(*box, **LIMITS, adaptive=True, checkpoint=path)

    write(film)
    assert attempt().samples == 40
    lies = [
        {"bytes": 2**60},
        {"packed": 2**60},
        {"bytes": -1},
        {"bytes": "many"},
        {"bytes": True},
        {"of": []},
    ]
    for lie in [*lies, {"bytes": 3}, {"of": {**of, "more": 1}}, {"of": {**of, "seed": "5"}}, {"of": {}}]:
        write(film, **lie)
        with pytest.raises(ValueError, match=r"^checkpoint .* is "):
            attempt()
    # A decompression bomb: no more than the stated size is unpacked.
    write(b"\0" * 10**8, bytes=len(film))
    with pytest.raises(ValueError, match="is damaged"):
        attempt()
    for bad in (
        b"",
        film[:-1],
        film + b"\0",
        b"\xff" * len(film),
        b"\0" * len(film),
        b"\x40\0\0\0" + b"\0" * 999,
    ):
        write(bad)
        with pytest.raises(ValueError, match="is damaged: "):
            attempt()


def header_of(data):
    start = len(MAGIC) + 4
    return json.loads(data[start : start + int.from_bytes(data[len(MAGIC) : start], "little")])


def test_a_full_disk_is_told_and_costs_nothing(box, path, often, monkeypatch):
    whole = rw.render(*box, **LIMITS)

    def full(_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    rw.render(*box, **{**LIMITS, "samples": 3}, checkpoint=path)
    before = path.read_bytes()
    monkeypatch.setattr(os, "fsync", full)
    with pytest.warns(RuntimeWarning, match=r"checkpoint .* could not be written: no space left on device"):
        image = rw.render(*box, **LIMITS, checkpoint=path)
    assert np.array_equal(image.rgb, whole.rgb)
    assert any("no space left on device" in warning for warning in image.warnings)
    # The old file is unchanged, and no other exists.
    assert path.read_bytes() == before
    assert os.listdir(path.parent) == [path.name]


def test_where_warnings_are_errors_the_picture_is_still_had(box, path, monkeypatch):
    def full(_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        image = rw.render(*box, **LIMITS, checkpoint=path)
    assert any("no space left" in warning for warning in image.warnings)


@pytest.mark.skipif(not os.path.isdir("/proc/self"), reason="not even root makes files in /proc, where it is")
def test_a_folder_that_takes_no_file_is_told(box):
    with pytest.warns(RuntimeWarning, match="could not be written"):
        image = rw.render(*box, **LIMITS, checkpoint="/proc/raywright.checkpoint")
    assert image.samples == 40
    assert len(image.warnings) == 1


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="root writes anywhere")
def test_a_read_only_folder_is_told(box, tmp_path):
    tmp_path.chmod(0o555)
    with pytest.warns(RuntimeWarning, match="could not be written: permission denied"):
        image = rw.render(*box, **LIMITS, checkpoint=tmp_path / "a.checkpoint")
    tmp_path.chmod(0o755)
    assert image.samples == 40
    assert len(image.warnings) == 1


def test_no_folder_and_no_file_are_told_at_once(box, tmp_path):
    with pytest.raises(FileNotFoundError):
        rw.render(*box, **LIMITS, checkpoint=tmp_path / "missing" / "a.checkpoint")
    with pytest.raises(IsADirectoryError):
        rw.render(*box, **LIMITS, checkpoint=tmp_path)
    with pytest.raises(TypeError, match="checkpoint must be a path, got int"):
        rw.render(*box, **LIMITS, checkpoint=3)
    assert os.listdir(tmp_path) == []
