"""Samplers and filters: what they keep, what they refuse, and that they change the noise and nothing else."""

import pickle
from dataclasses import FrozenInstanceError

import numpy as np
import pytest

import raywright as rw

BATCHED = [rw.rendering.Stratified, rw.rendering.Halton, rw.rendering.Sobol, rw.rendering.Lattice]
SAMPLERS = [rw.rendering.Independent(), *(kind(8) for kind in BATCHED)]
FILTERS = [
    rw.rendering.BoxFilter(),
    rw.rendering.TriangleFilter(),
    rw.rendering.GaussianFilter(),
    rw.rendering.MitchellFilter(),
    rw.rendering.BlackmanHarrisFilter(),
    rw.rendering.LanczosFilter(),
]


def name(value):
    return type(value).__name__


@pytest.mark.parametrize("value", SAMPLERS + FILTERS, ids=name)
def test_values_pickle_compare_hash_and_stay(value):
    back = pickle.loads(pickle.dumps(value))
    assert back == value
    assert hash(back) == hash(value)
    with pytest.raises(FrozenInstanceError):
        value.radius = 3


@pytest.mark.parametrize("kind", BATCHED, ids=lambda k: k.__name__)
def test_batches_are_powers_of_two(kind):
    assert kind().batch is None
    assert [kind(np.int32(b)).batch for b in (1, 2, 64)] == [1, 2, 64]
    for batch in (0, 128, -1):
        with pytest.raises(ValueError, match=f"batch must be between 1 and 64, got {batch}"):
            kind(batch)
    with pytest.raises(ValueError, match="batch must be a power of two, got 12"):
        kind(12)
    with pytest.raises(TypeError, match="batch must be an integer"):
        kind(8.0)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: rw.rendering.BoxFilter(0), "radius must be between 1e-06 and 64, got 0"),
        (lambda: rw.rendering.TriangleFilter(-1), "radius must be between"),
        (lambda: rw.rendering.GaussianFilter(sigma=float("nan")), "sigma must be finite"),
        (lambda: rw.rendering.GaussianFilter(radius=65), "radius must be between"),
        (lambda: rw.rendering.MitchellFilter(b=2), "b must be between 0 and 1, got 2"),
        (lambda: rw.rendering.MitchellFilter(c=-0.1), "c must be between 0 and 1"),
        (lambda: rw.rendering.BlackmanHarrisFilter(float("inf")), "radius must be finite"),
        (lambda: rw.rendering.LanczosFilter(0), "lobes must be between 1 and 16, got 0"),
    ],
)
def test_filters_refuse_what_makes_no_sense(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_render_refuses_what_is_no_sampler_or_filter(box, camera):
    with pytest.raises(TypeError, match="sampler must be one of raywright's, got str"):
        rw.render(rw.Scene(box), camera, sampler="sobol", progress=False)
    with pytest.raises(TypeError, match="filter must be one of raywright's, got int"):
        rw.render(rw.Scene(box), camera, filter=1, progress=False)


@pytest.mark.parametrize("sampler", SAMPLERS, ids=name)
def test_the_mean_does_not_depend_on_the_sampler(box, camera, sampler):
    scene = rw.Scene(box, environment=1.0)
    images = [
        rw.render(scene, camera, samples=512, seed=s, sampler=k, progress=False)
        for s, k in ((1, rw.rendering.Independent()), (2, sampler))
    ]
    difference = sum(i.rgb.astype(float).mean() * sign for i, sign in zip(images, (1, -1), strict=True))
    # Pixels are independent, and channels count as one. Five standard errors: once in two million.
    error = np.sqrt(sum((i.standard_error.astype(float) ** 2).sum() * 3 for i in images)) / images[0].rgb.size
    assert abs(difference) < 5 * error


@pytest.mark.parametrize("filter", FILTERS, ids=name)
def test_filters_keep_an_even_picture(filter):
    camera = rw.Camera((0, 0, 5), (0, 0, 6), width=8, height=8)
    how = {"samples": 256, "sampler": rw.rendering.Independent(), "filter": filter, "progress": False}
    image = rw.render(rw.Scene([], environment=0.5), camera, **how)
    off = np.abs(image.rgb.astype(float) - 0.5)
    # Weights have the mean 1; 192 values within six standard errors: once in two million.
    assert (off <= 6 * image.standard_error + 1e-6).all()
