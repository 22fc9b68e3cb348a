"""What is told of pictures whose light is gathered from about a point: how far a render is, and its blur."""

import time

import pytest

import raywright as rw
from raywright.rendering.photon_bias import rate
from raywright.rendering.progress import bar


def test_noise_falls_by_the_integrator():
    assert [rate(way) for way in (rw.Path(), rw.PhotonMap(), rw.Bidirectional())] == [1.0, 1.0, 1.0]
    assert rate(rw.ProgressivePhotonMap(alpha=0.5)) == 0.5
    assert rate(rw.Bidirectional(vertex_merging=True)) == pytest.approx(2 / 3)


@pytest.mark.parametrize(("rates", "share"), [((), "12%"), ((2 / 3,), "4%")])
def test_a_bar_goes_by_that(rates, share, capsys):
    # At 8 times the wanted error, an eighth of the samples is there; by the power of 2/3, a 23rd.
    with bar(None, 0.01, None, *rates) as report:
        # A bar is redrawn after a tenth of a second.
        time.sleep(0.15)
        report(1.0, 4, 0.08, True)
        told = capsys.readouterr().err
    assert share in told.replace(" ", "")


def test_blur_beyond_the_error_is_told():
    scene, look = rw.scenes.cornell_box(width=8, height=8)
    coarse = rw.PhotonMap(1000, k_nearest=None, radius=250.0, final_gather=0)
    image = rw.render(scene, look, coarse, 64, error=1e-9, progress=False)
    lines = [line for line in image.warnings if line.startswith("error=1e-09 is of noise alone")]
    assert len(lines) == 1
    assert "a smaller radius has less" in lines[0]
    # Without a requested error there is no warning.
    image = rw.render(scene, look, coarse, 4, progress=False)
    assert not any("noise alone" in line for line in image.warnings)
