"""Put pages beside those of other versions: ``python docs/versions.py PAGES SITE NAME``.

A site has a folder for each release ("0.2.0") and "dev" for the main branch. At its root, ``index.html``
leads to the newest release, as ``stable/`` does, and ``versions.json`` lists all: the side bar of each page
reads it, so that old pages know of new versions.
"""

import json
import re
import shutil
import sys
from pathlib import Path

DEV = "dev"
_RELEASE = re.compile(r"v?(\d+(?:\.\d+)*)$")
_REDIRECT = """<!doctype html>
<meta charset="utf-8">
<title>raywright</title>
<meta http-equiv="refresh" content="0; url={to}">
<link rel="canonical" href="{to}">
<a href="{to}">raywright</a>
"""


def folder_of(name: str) -> str:
    """Return the folder of a tag, "v0.2.0" or "0.2.0", or of a branch.

    Raises
    ------
    ValueError
        If the name is neither that of a release nor "main".
    """
    if found := _RELEASE.match(name):
        return found[1]
    if name == "main":
        return DEV
    raise ValueError(f"NAME is {name!r}, expected a release, such as v0.2.0, or main")


def versions(site: Path) -> list[str]:
    """Return the folders of a site that are versions: releases, the newest first, and then "dev"."""
    names = [path.name for path in site.iterdir() if path.is_dir()]
    releases = [name for name in names if _RELEASE.match(name)]
    releases.sort(key=lambda name: [int(part) for part in name.split(".")], reverse=True)
    return releases + [DEV] * (DEV in names)


def publish(pages: Path, site: Path, name: str) -> None:
    """Put built pages into a site as a version, in place of those of the same version."""
    folder = site / folder_of(name)
    if folder.exists():
        shutil.rmtree(folder)
    shutil.copytree(pages, folder, ignore=shutil.ignore_patterns(".doctrees", ".buildinfo"))
    # The host would leave out folders that begin with a line, such as _static.
    (site / ".nojekyll").touch()
    known = versions(site)
    (site / "versions.json").write_text(json.dumps(known) + "\n", encoding="utf-8")
    (site / "index.html").write_text(_REDIRECT.format(to=f"{known[0]}/"), encoding="utf-8")
    (site / "stable").mkdir(exist_ok=True)
    (site / "stable" / "index.html").write_text(_REDIRECT.format(to=f"../{known[0]}/"), encoding="utf-8")


if __name__ == "__main__":
    publish(Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3])
