"""View factors of many faces: sparse matrices by rays, and what they take."""

import subprocess
import sys

import numpy as np
import pytest
from test_view_factors import inward_box

import raywright as rw
from raywright.exchange import view_factors as module


def by_rays(scene: rw.Scene, monkeypatch: pytest.MonkeyPatch, **how: object) -> rw.exchange.ViewFactors:
    pytest.importorskip("scipy")
    monkeypatch.setattr(module, "_MOST_DENSE", 10)
    return rw.view_factors(scene, progress=False, **how)  # type: ignore[arg-type]


def uneven_room() -> rw.Scene:
    """A room whose sides have faces of several sizes, with a block in it."""
    trimesh = pytest.importorskip("trimesh")
    block = trimesh.creation.box((0.4, 0.3, 0.5))
    block.apply_translation((0.55, 0.45, 0.4))
    coarse, fine = inward_box(cuts=2), inward_box(cuts=5)
    return rw.Scene([*coarse[:3], *fine[3:], rw.Mesh(block.vertices, block.faces)])


def test_without_scipy_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "_MOST_DENSE", 10)
    monkeypatch.setitem(sys.modules, "scipy.sparse", None)
    with pytest.raises(ImportError, match=r"need scipy: pip install 'raywright\[sparse\]'"):
        rw.view_factors(uneven_room(), progress=False)


def test_rows_by_rays_are_reciprocal_and_add_up(monkeypatch: pytest.MonkeyPatch) -> None:
    found = by_rays(uneven_room(), monkeypatch, rays=64)
    exchanged = found.areas[:, None] * found.matrix.toarray()
    np.testing.assert_allclose(exchanged, exchanged.T, rtol=1e-12, atol=0)
    np.testing.assert_allclose(found.to_surroundings, 0, atol=1e-12)
    spread = found.areas[:, None] * found.standard_error.toarray()
    np.testing.assert_allclose(spread, spread.T, rtol=1e-12, atol=0)
    # If all faces have equal radiosity, each has that irradiance: no ray is lost.
    np.testing.assert_allclose(found.matvec(np.ones(len(found))), 1, atol=1e-12)


def test_errors_of_rows_by_rays_are_those_of_their_spread(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = uneven_room()
    truth = rw.view_factors(scene, rays=256, progress=False)
    off, told = [], []
    for seed in range(3):
        found = by_rays(scene, monkeypatch, rays=32, seed=seed)
        monkeypatch.undo()
        off.append(found.matrix.toarray() - truth.matrix)
        told.append(found.standard_error.toarray())
    # Nets of 64 rays are better than the binomial law, and scaling improves rows. Over 10,000 entries the
    # mean of squares is known to some per cent.
    seen = truth.matrix > 1e-3
    ratio = np.sqrt(np.mean(np.square(off)[:, seen]) / np.mean(np.square(told)[:, seen]))
    assert 0.7 < ratio < 1.15


def test_the_error_of_a_product_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = uneven_room()
    x = np.zeros(len(rw.view_factors(scene, rays=1, progress=False)))
    x[:8] = 1.0
    truth = rw.view_factors(scene, rays=256, progress=False)
    np.testing.assert_allclose(
        truth.matvec_error(x), np.sqrt(truth.standard_error**2 @ x**2), rtol=1e-12, atol=0
    )
    two = truth.matvec_error(np.stack([x, 2 * x], axis=1))
    np.testing.assert_allclose(two[:, 1], 2 * two[:, 0])
    found = by_rays(scene, monkeypatch, rays=64)
    off = np.abs(found.matvec(x) - truth.matvec(x))
    both = np.hypot(found.matvec_error(x), truth.matvec_error(x))
    # Batches of few rays estimate errors to a fifth or so; of 186 rows, 5 % may be beyond 3.
    assert np.mean(off > 3 * both + 1e-12) < 0.05
    with pytest.raises(ValueError, match=r"x must be \(186,\) or \(186, K\), got \(3,\)"):
        found.matvec_error([1.0, 2.0, 3.0])


MANY = """
import resource, sys
import numpy as np
import raywright as rw
from test_view_factors import inward_box

scene = rw.Scene(inward_box(cuts=int(sys.argv[1])))
scene.build(progress=False)
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
found = rw.view_factors(scene, rays=4, progress=False)
after = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
assert abs(found.to_surroundings).max() < 1e-9
x = found.matvec(np.ones(len(found)))
assert abs(x - 1).max() < 1e-9
print(len(found), found.matrix.nnz, (after - before) * 1024)
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="peaks are told in other units elsewhere")
def test_many_faces_take_memory_by_their_rays() -> None:
    pytest.importorskip("scipy")
    from pathlib import Path

    here = Path(__file__).parent
    run = subprocess.run(
        [sys.executable, "-c", MANY, "41"], capture_output=True, text=True, cwd=here, check=True
    )
    faces, entries, peak = map(int, run.stdout.split())
    assert faces == 12 * 41**2 > 20_000
    # 64 rays a face give at most 128 entries a row; a dense matrix would take 3.3 GB.
    assert entries <= 128 * faces
    # Twice the result, at 12 bytes an entry and as many of its variance, plus the rays themselves.
    assert peak < 2.5 * 24 * entries + 1.5e8
