"""All accelerators, and their names."""

from __future__ import annotations

from dataclasses import fields
from types import UnionType
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

from .brute import BruteForce
from .bvh import BVH
from .grid import Grid, NestedGrid
from .space import BSP, KdTree, Octree

Accelerator = BVH | KdTree | Octree | BSP | Grid | NestedGrid | BruteForce
_WIDEST = BVH(traversal="wide8")


def every() -> dict[str, Accelerator]:
    """Return one accelerator of each kind, and of each way to build or to walk one, by their names.

    Each option among words is varied alone, with all others at their defaults, or as it requires them. Trees
    that are 8 wide by name are left out: any wide one is, wherever the processor can.
    """
    found: dict[str, Accelerator] = {}
    for kind in get_args(Accelerator):
        found[name_of(kind())] = kind()
        for option, words in _choices(kind).items():
            others: dict[str, Any] = getattr(kind, "needs", {}).get(option, {})
            for word in words:
                one = kind(**{option: word}, **others)
                if one != _WIDEST:
                    found.setdefault(name_of(one), one)
    return found


def name_of(accelerator: Accelerator) -> str:
    """Return a short name: the kind, its builder or first option, and options other than the default.

    ``BVH()`` is "BVH binned", ``BVH(bins=8)`` is "BVH binned bins=8".
    """
    kind = type(accelerator)
    parts = [kind.__name__]
    first = next(iter(_choices(kind)), None)
    for field in fields(accelerator):
        value = getattr(accelerator, field.name)
        # Without the brackets and commas that lists of names would have.
        told = "+".join(map(str, value)) or "none" if isinstance(value, tuple) else str(value)
        if field.name == first and value is not None:
            parts.append(told)
        elif value != field.default:
            parts.append(f"{field.name}={told}")
    return " ".join(parts)


def _choices(kind: type[Any]) -> dict[str, tuple[str, ...]]:
    """Return the options of a kind that are choices among words."""
    found = {name: _words(hint) for name, hint in get_type_hints(kind).items()}
    return {name: words for name, words in found.items() if words}


def _words(hint: Any) -> tuple[str, ...]:
    """Return the words of a Literal, also of one that other types may stand for."""
    if get_origin(hint) is Literal:
        return tuple(word for word in get_args(hint) if isinstance(word, str))
    if get_origin(hint) in (Union, UnionType):
        return tuple(word for part in get_args(hint) for word in _words(part))
    return ()
