"""Files that mesh files name, found in their folder."""

from __future__ import annotations

from pathlib import Path


def beside(folder: Path, name: str) -> Path | None:
    """Return a file of a folder, or of a folder within it; None if there is none of that name.

    Names may come from another machine. Upper and lower case differ only between files that are both there;
    of a path that leads nowhere, or out of the folder, only the last part is used.
    """
    plain = name.strip().strip('"').replace("\\", "/")
    root = folder.resolve()
    for candidate in (plain, plain.rsplit("/", 1)[-1]):
        try:
            found = cased(root, candidate).resolve()
            if candidate and found.is_relative_to(root) and found.is_file():
                return found
        except (OSError, ValueError, RuntimeError):
            # Not a valid file name: too long, or with a forbidden character.
            continue
    return None


def cased(root: Path, name: str) -> Path:
    """Return a path under a folder as the file system writes it, whatever the case of its letters.

    Where that leads nowhere it is returned as it is. Letters of other cases count only in names that are not
    there as they are.
    """
    whole = root / name
    if whole.exists() or Path(name).is_absolute() or ".." in Path(name).parts:
        return whole
    at = root
    for part in Path(name).parts:
        exact = at / part
        if exact.exists():
            at = exact
            continue
        alike = [one for one in at.iterdir() if one.name.lower() == part.lower()] if at.is_dir() else []
        at = min(alike) if alike else exact
    return at
