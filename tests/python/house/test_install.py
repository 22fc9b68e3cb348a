"""Extras, the conda recipe, the page on an index, and the versions of the pages."""

import json
import re
import runpy
from pathlib import Path

import pytest

import raywright as rw

ROOT = Path(__file__).parents[3]
PROJECT = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
PLAIN = {"numpy", "trimesh", "Pillow", "tqdm"}


def of_the_repository(name):
    """Run a script that only the repository has, and return its names."""
    if not (ROOT / name).exists():
        pytest.skip("only the repository has it")
    return runpy.run_path(str(ROOT / name))


def requirements(text):
    """Return by package what is required, of lines such as "numpy>=1.24" and "numpy >=1.24"."""
    return dict(re.match(r"([\w-]+) ?(.*)", line).groups() for line in text)


def table_of_extras():
    table = PROJECT.split("[project.optional-dependencies]\n")[1].split("\n\n")[0]
    found = {
        name: re.findall('"(.+?)"', listed)
        for name, listed in re.findall(r"^(\w+) = (\[.*?\])", table, re.M | re.S)
    }
    assert len(found) == len(re.findall(r"^\w+ = ", table, re.M))
    return found


def test_a_plain_install_is_of_four_packages():
    listed = re.search(r"^dependencies = \[(.*)\]$", PROJECT, re.M)[1]
    assert set(requirements(re.findall('"(.+?)"', listed))) == PLAIN


def test_extras_that_are_named_to_users_are_there():
    """Messages, docstrings and pages that say ``raywright[...]`` name what pyproject.toml has."""
    named = set()
    for path in [*(ROOT / "python").rglob("*.py"), *(ROOT / "docs").glob("*.md"), ROOT / "README.md"]:
        for extras in re.findall(r"raywright\[([\w,]+)\]", path.read_text(encoding="utf-8")):
            named |= set(extras.split(","))
    assert {"gpu", "sparse", "vdb"} <= named <= set(table_of_extras())


def test_no_extra_is_for_exr_and_none_wants_a_package_that_nobody_maintains():
    extras = table_of_extras()
    assert not any(
        "OpenEXR" in requirement for name in extras.keys() - {"test"} for requirement in extras[name]
    )
    wanted = {name for listed in extras.values() for name in requirements(listed)}
    assert "blosc" not in wanted
    # A pin would exclude all environments with another version.
    assert not any("==" in requirement for listed in extras.values() for requirement in listed)


def test_the_conda_recipe_wants_what_the_package_wants():
    path = ROOT / "conda" / "recipe.yaml"
    if not path.exists():
        pytest.skip("only the repository has it")
    recipe = pytest.importorskip("yaml").safe_load(path.read_text(encoding="utf-8"))
    assert recipe["context"]["version"] == rw.__version__
    python = re.search('^requires-python = ">=(.*)"$', PROJECT, re.M)[1]
    assert recipe["context"]["python_min"] == python
    plain = requirements(re.findall('"(.+?)"', re.search(r"^dependencies = \[(.*)\]$", PROJECT, re.M)[1]))
    run = requirements(recipe["requirements"]["run"])
    assert run.pop("python") == ">=${{ python_min }}"
    assert run == {name.lower(): bound for name, bound in plain.items()}
    maturin = re.search('^requires = \\["maturin(.*)"\\]$', PROJECT, re.M)[1]
    assert f"maturin {maturin}" in recipe["requirements"]["host"]
    # Extras, by conda-forge's names of their packages.
    extras = requirements(one for listed in table_of_extras().values() for one in listed)
    for name, bound in requirements(recipe["requirements"]["run_constraints"]).items():
        assert extras[{"matplotlib-base": "matplotlib", "wgpu-py": "wgpu"}.get(name, name)] == bound


HOST, TAG = "https://host.example/owner/raywright", "v1.2.3"


def test_all_links_of_the_readme_work_on_an_index():
    with_addresses = of_the_repository(".ci/index_page.py")["with_addresses"]
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    changed = with_addresses(text, HOST, TAG, ROOT)
    links = re.findall(r"(!?)\[[^\]]*\]\(([^)\s]+)\)", changed)
    assert len(links) > 10
    assert any(picture for picture, _ in links)
    for picture, target in links:
        assert target.startswith("https://")
        if target.startswith(HOST):
            kind, tag, path = target.removeprefix(HOST + "/").split("/", 2)
            assert (kind, tag) == ("raw" if picture else "blob", TAG)
            assert (ROOT / path.split("#")[0]).is_file()
    # Nothing else is changed.
    prefix = re.compile(re.escape(HOST) + "/(raw|blob)/" + re.escape(TAG) + "/")
    assert prefix.sub("", changed) == text


def test_links_are_made_absolute_and_nothing_else(tmp_path):
    with_addresses = of_the_repository(".ci/index_page.py")["with_addresses"]
    (tmp_path / "a b").mkdir()
    (tmp_path / "docs").mkdir()
    (tmp_path / "docs" / "x.md").touch()
    (tmp_path / "x.png").touch()
    text = (
        "![p](x.png) [d](docs/) [x](docs/x.md#there) [here](#here) [out](https://a.example/docs/x.md) "
        "[mail](mailto:a@a.example)\n```md\n[code](docs/x.md)\n```\n[again](docs/x.md)\n"
    )
    expected = text.replace("(x.png)", f"({HOST}/raw/{TAG}/x.png)").replace(
        "(docs/)", f"({HOST}/tree/{TAG}/docs)"
    )
    expected = expected.replace("(docs/x.md#there)", f"({HOST}/blob/{TAG}/docs/x.md#there)")
    expected = expected.replace("[again](docs/x.md)", f"[again]({HOST}/blob/{TAG}/docs/x.md)")
    assert with_addresses(text, HOST, TAG, tmp_path) == expected
    with pytest.raises(FileNotFoundError, match=r"links to gone\.md"):
        with_addresses("[g](gone.md)", HOST, TAG, tmp_path)


def test_the_project_gets_its_addresses_once():
    with_urls = of_the_repository(".ci/index_page.py")["with_urls"]
    changed = with_urls(PROJECT, HOST, TAG)
    tomllib = pytest.importorskip("tomllib")
    before, after = tomllib.loads(PROJECT), tomllib.loads(changed)
    urls = after["project"].pop("urls")
    assert after == before
    assert urls["Source"] == HOST
    assert urls["Changelog"] == f"{HOST}/blob/{TAG}/CHANGELOG.md"
    with pytest.raises(ValueError, match="already"):
        with_urls(changed, HOST, TAG)


def test_pages_of_versions_stand_beside_each_other(tmp_path):
    publish = of_the_repository("docs/versions.py")["publish"]
    pages, site = tmp_path / "pages", tmp_path / "site"
    (pages / "_static").mkdir(parents=True)
    (pages / ".doctrees").mkdir()
    site.mkdir()
    (site / ".git").touch()
    for name in ("main", "v0.2.0", "0.10.0", "v0.9"):
        (pages / "index.html").write_text(name)
        publish(pages, site, name)
    assert json.loads((site / "versions.json").read_text()) == ["0.10.0", "0.9", "0.2.0", "dev"]
    assert {folder: (site / folder / "index.html").read_text() for folder in ("dev", "0.2.0", "0.10.0")} == {
        "dev": "main",
        "0.2.0": "v0.2.0",
        "0.10.0": "0.10.0",
    }
    assert not (site / "dev" / ".doctrees").exists()
    assert 'url=0.10.0/"' in (site / "index.html").read_text()
    assert 'url=../0.10.0/"' in (site / "stable" / "index.html").read_text()
    # The same version again replaces the old one, with files no longer in it.
    (site / "dev" / "old.html").touch()
    publish(pages, site, "main")
    assert not (site / "dev" / "old.html").exists()
    assert (site / ".git").exists()
    with pytest.raises(ValueError, match="expected a release, such as"):
        publish(pages, site, "../elsewhere")
