"""Make the package's page on an index work: the links of the README, and the project's own addresses.

    python .ci/index_page.py https://host/owner/raywright v0.2.0

An index shows README.md without the files beside it: pictures are missing, and links lead nowhere. This
gives links the addresses of their files at a tag or commit, and pyproject.toml the table [project.urls]. The
workflow runs it before it builds; the repository itself keeps links that hold in every copy of it.
"""

import re
import sys
from pathlib import Path
from urllib.parse import quote

#: A link or a picture in Markdown whose target is neither an address nor a place on the page.
_LINK = re.compile(
    r"(?P<picture>!?)\[(?P<text>[^\]]*)\]\((?!#|[a-z][a-z0-9+.-]*:)(?P<path>[^)#\s]+)(?P<place>#[^)\s]*)?\)"
)
_FENCE = re.compile(r"^(?:```|~~~)")


def with_addresses(text: str, repository: str, ref: str, root: Path) -> str:
    """Return Markdown whose links to files of a folder lead to the same files of a repository.

    Parameters
    ----------
    text : str
        Of a page in the folder itself.
    repository : str
        Address, without a slash at the end.
    ref : str
        Tag or commit.
    root : Path
        The folder.

    Raises
    ------
    FileNotFoundError
        If a link leads to no file.
    """

    def absolute(found: re.Match[str]) -> str:
        path = found["path"]
        if not (root / path).exists():
            raise FileNotFoundError(f"README.md links to {path}, and there is no such file")
        # A page of the repository's host is no picture; its raw file is.
        kind = "raw" if found["picture"] else "tree" if (root / path).is_dir() else "blob"
        target = f"{repository}/{kind}/{quote(ref)}/{quote(path.removesuffix('/'))}{found['place'] or ''}"
        return f"{found['picture']}[{found['text']}]({target})"

    lines, is_code = [], False
    for line in text.splitlines(keepends=True):
        if _FENCE.match(line):
            is_code = not is_code
        lines.append(line if is_code else _LINK.sub(absolute, line))
    return "".join(lines)


def with_urls(project: str, repository: str, ref: str) -> str:
    """Return the text of a pyproject.toml with the table [project.urls], which it must not have yet."""
    if "[project.urls]" in project:
        raise ValueError("pyproject.toml has [project.urls] already")
    owner, name = repository.rsplit("/", 2)[-2:]
    urls = {
        "Documentation": f"https://{owner.lower()}.github.io/{name}/",
        "Source": repository,
        "Changelog": f"{repository}/blob/{quote(ref)}/CHANGELOG.md",
        "Issues": f"{repository}/issues",
    }
    table = "\n".join(f'{what} = "{address}"' for what, address in urls.items())
    return project.replace("[project.scripts]", f"[project.urls]\n{table}\n\n[project.scripts]", 1)


def main() -> None:
    """Change both files in place."""
    repository, ref = sys.argv[1].rstrip("/"), sys.argv[2]
    root = Path(__file__).parents[1]
    readme, project = root / "README.md", root / "pyproject.toml"
    text = with_addresses(readme.read_text(encoding="utf-8"), repository, ref, root)
    urls = with_urls(project.read_text(encoding="utf-8"), repository, ref)
    readme.write_text(text, encoding="utf-8", newline="\n")
    project.write_text(urls, encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main()
