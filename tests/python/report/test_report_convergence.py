"""Error against run time, told: tables, slopes, and what is refused."""

import csv
import functools
import io
import subprocess
import sys

import numpy as np
import pytest
from cornell_picture import cornell_picture
from PIL import Image as Pillow

import raywright as rw
from raywright.report.convergence import LEVELS

SCENE, CAMERA, TRUTH = cornell_picture(24)
HISTORY = np.array([(1.0, 16384, 1e-6)], rw.rendering.image.HISTORY)
# An error that shows unless it is subtracted: the picture's own is a tenth of it.
ESTIMATE = rw.rendering.ErrorEstimate(1e-5, 5e-6, 2e-5)
REFERENCE = rw.Image(
    TRUTH.astype(np.float32), np.zeros_like(TRUTH, np.float32), ESTIMATE, HISTORY, 1.0, 16384
)
WAYS = {"path": {"sampler": rw.rendering.Independent()}, "adaptive": {"adaptive": True}}


@pytest.fixture(scope="module")
def made():
    """A report, and the pictures that it made, by whether they are adaptive, and by budget."""
    pictures = {}

    @functools.wraps(rw.render)
    def render(*scene, **how):
        image = rw.render(*scene, **how)
        pictures.setdefault(("adaptive" if how.get("adaptive") else "path", how["seconds"]), []).append(image)
        return image

    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(rw.report.convergence.__globals__, "render", render)
        return rw.report.convergence(SCENE, CAMERA, WAYS, 0.2, REFERENCE, seeds=2), pictures


@pytest.fixture(scope="module")
def report(made):
    return made[0]


def test_there_is_a_row_for_each_contender_and_budget(report):
    assert len(report.rows) == 2 * LEVELS
    for name in ("path", "adaptive"):
        mine = report.where(contender=name)
        assert mine.column("budget") == tuple(0.2 / 2**k for k in reversed(range(LEVELS)))
        samples = mine.column("samples")
        # More time gives more samples; between neighbors, other load on the machine decides.
        assert samples[0] < samples[-1]
        for seconds, error, product in zip(
            mine.column("seconds"), mine.column("relmse"), mine.column("error_seconds"), strict=True
        ):
            assert product == pytest.approx(seconds * error)


def relmse(image):
    truth = REFERENCE.rgb.astype(float)
    return np.mean(np.square(image.rgb - truth) / (np.square(truth) + 0.01)) - REFERENCE.error.estimate


def test_a_row_tells_of_its_pictures(made):
    # Errors are random, and the number of samples depends on the machine.
    report, pictures = made
    assert len(pictures) == len(report.rows)
    for name, budget, seconds, samples, error, ratio, _, trusted in report.rows:
        images = pictures[name, budget]
        assert len(images) == 2
        assert seconds == pytest.approx(np.mean([image.seconds for image in images]))
        assert samples == np.mean([image.samples for image in images])
        true = np.mean([relmse(image) for image in images])
        assert error == (pytest.approx(true) if true > 0 else None)
        told = np.mean([image.error.estimate for image in images])
        assert trusted == np.mean([image.error.trusted for image in images])
        assert ratio == (pytest.approx(told / true) if true > 0 and told > 0 else None)


def test_another_seed_is_another_picture(made):
    # The same integrator has the same bits, for any time.
    for images in made[1].values():
        assert not np.array_equal(images[0].rgb, images[1].rgb)
    longest = made[1]["path", 0.2][1]
    how = {"samples": longest.samples, "seed": 1, "progress": False}
    assert np.array_equal(
        rw.render(SCENE, CAMERA, sampler=rw.rendering.Independent(), **how).rgb, longest.rgb
    )


def test_slopes_are_fitted_by_least_squares():
    columns = [
        (f"{name}", s, s, 1, e * s**-p, None, e * s ** (1 - p), 1.0)
        for name, e, p in (("a", 0.5, 1.0), ("b", 0.1, 1.5))
        for s in (1.0, 2.0, 4.0)
    ]
    made = rw.report.convergence.__globals__["_report"](CAMERA, columns, ["a", "b"], 1, True, 0.0)
    (a, b) = made.fits
    assert (a.slope, a.level, a.gain) == pytest.approx((-1.0, 0.5, 1.0))
    # Products 0.5 each, and 0.1 / (1, 2, 4) ** 0.5, whose geometric mean is 0.1 / 2 ** 0.5.
    assert (b.slope, b.level, b.gain) == pytest.approx((-1.5, 0.1, 5 * 2**0.5))


def test_without_a_reference_errors_are_estimates():
    report = rw.report.convergence(SCENE, CAMERA, {"path": rw.Path()}, 0.1, seeds=[7])
    assert set(report.column("ratio")) == {None}
    assert report.notes[0] == "relMSE: as estimated by the renders themselves, the mean over one seed."


def test_a_reference_can_be_made_or_given_as_numbers():
    made = rw.report.convergence(SCENE, CAMERA, {"path": {}}, 0.05, 0.5, seeds=1)
    assert any("reference's own relMSE" in note for note in made.notes)
    way = {"sampler": rw.rendering.Independent()}
    given = rw.report.convergence(SCENE, CAMERA, {"path": way}, 0.05, np.zeros((24, 24, 3)), seeds=1)
    # Against black, relMSE is the mean square over 0.01.
    image = rw.render(SCENE, CAMERA, **way, samples=given.column("samples")[-1], seed=0, progress=False)
    assert given.column("relmse")[-1] == pytest.approx(np.mean(np.square(image.rgb.astype(float))) / 0.01)


def test_plot_has_a_line_for_each_fit(report):
    pytest.importorskip("matplotlib").use("Agg")
    ax = report.plot()
    dashed = [line for line in ax.get_lines() if line.get_linestyle() == "--"]
    assert len(dashed) == 2
    for fit, line in zip(report.fits, dashed, strict=True):
        seconds, errors = line.get_data()
        assert np.allclose(errors, fit.level * seconds**fit.slope)
    told = [text.get_text() for text in ax.get_legend().get_texts()]
    assert told[0] == f"path (slope {report.fits[0].slope:.2f})"


def test_a_plot_in_a_file_has_its_lines_too(report, tmp_path):
    pytest.importorskip("matplotlib")
    ax = report.plot(str(tmp_path / "plot.svg"))
    assert sum(line.get_linestyle() == "--" for line in ax.get_lines()) == 2
    plain = report.plot(tmp_path / "plain.svg", x="samples")
    assert not any("slope" in text.get_text() for text in plain.get_legend().get_texts())
    text = (tmp_path / "plot.svg").read_text(encoding="utf-8")
    # Each contender has its line of marks and its fit; only the fit has dashes.
    assert text.count("stroke-dasharray") >= 2


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"contenders": {}}, ValueError, "contenders must not be empty"),
        ({"contenders": [rw.Path()]}, TypeError, "contenders must be a dict, got list"),
        (
            {"contenders": {"a": {"samples": 3}}},
            ValueError,
            r"contenders\['a'\] has 'samples'; expected some of",
        ),
        ({"contenders": {"a": 3}}, TypeError, "integrator must be"),
        ({"seconds": 0}, ValueError, "seconds must be greater than 0"),
        ({"seeds": 0}, ValueError, "seeds must be between 1"),
        ({"seeds": []}, ValueError, "seeds must not be empty"),
        ({"reference": np.zeros((2, 2, 3))}, ValueError, r"reference must have shape \(24, 24, 3\)"),
        ({"reference": np.full((24, 24, 3), np.nan)}, ValueError, "reference must be finite"),
    ],
)
def test_bad_arguments_are_refused_in_one_line(arguments, error, message):
    with pytest.raises(error, match=message) as caught:
        rw.report.convergence(SCENE, CAMERA, **arguments)
    assert "\n" not in str(caught.value)


def test_the_shell_has_it(tmp_path):
    command = [sys.executable, "-m", "raywright", "report", "convergence", "cornell"]
    quick = ["--width", "16", "--height", "16", "--seconds", "0.05", "--seeds", "1"]
    done = subprocess.run([*command, *quick, "--csv"], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (0, "")
    rows = list(csv.DictReader(io.StringIO(done.stdout)))
    assert [row["contender"] for row in rows] == ["path"] * LEVELS + ["path, adaptive"] * LEVELS
    pytest.importorskip("matplotlib")
    plot = ["--plot", str(tmp_path / "plot.png")]
    done = subprocess.run([*command, *quick, *plot], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("Error against run time, 16 x 16 pixels\n")
    with Pillow.open(tmp_path / "plot.png") as picture:
        assert min(picture.size) > 300
    done = subprocess.run([*command[:-1], "gone.ply"], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (1, "raywright: error: gone.ply: no such file\n")
