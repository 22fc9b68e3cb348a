"""Arrays of numpy from those of other libraries, and one clear line for those that cannot be converted."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

# Parts of numpy's messages for nested lists of unequal lengths.
_RAGGED = ("inhomogeneous", "could not broadcast", "setting an array element with a sequence")
# Types without a unit.
_SCALARS = frozenset({float, int, bool, str, type(None), np.float64, np.float32, np.int64})
_PLAIN = _SCALARS | {list, tuple, np.ndarray}
# Libraries with arrays that carry a unit.
_WITH_UNITS = ("astropy", "pint", "unyt")
# DLPack's device types with memory that the CPU reads: its own, and host memory pinned by CUDA or ROCm.
_HOST = (1, 3, 11)
_DEVICES = {2: "CUDA", 4: "OpenCL", 7: "Vulkan", 8: "Metal", 10: "ROCm", 13: "CUDA", 14: "oneAPI"}


def as_array(name: str, value: ArrayLike) -> NDArray[Any]:
    """Return `value` as an array of numpy, without a copy where possible.

    Besides numpy's own inputs, this takes objects that have DLPack alone, numbers of ml_dtypes such as
    bfloat16 (as float64), frames of pandas' nullable columns without a missing entry, and quantities without
    a unit.

    Raises
    ------
    TypeError
        If it has a unit, is not in the memory of the CPU, or numpy cannot read it: with the reason and a
        remedy.
    ValueError
        If nested sequences are ragged, or entries are masked.
    """
    if type(value) is np.ndarray:
        return value if value.dtype.kind != "V" else _readable(value)
    value = _without_unit(name, value)
    if not hasattr(type(value), "__array__") and hasattr(value, "__dlpack__"):
        array = _of_dlpack(name, value)
    else:
        array = _of_numpy(name, value)
    _unmasked(name, value)
    if array.dtype == object:
        return _of_nullable(value, array)
    return _readable(array)


def describe(value: object, array: NDArray[Any], short: bool = False) -> str:
    """Describe a value that is not a number; of objects, the first that is not a number, with a remedy."""
    if not array.ndim and not isinstance(value, np.ndarray):
        return f"{_short(value)}{cure(value)}"
    is_named = not (short and isinstance(value, np.ndarray))
    came = f"{type(value).__name__} of dtype {array.dtype}" if is_named else f"dtype {array.dtype}"
    if array.dtype.names:
        return f"{came}; pass numpy.lib.recfunctions.structured_to_unstructured of the columns that count"
    if array.dtype != object:
        return came
    first = _first_other(array)
    if first is None:
        return f"{came}: numbers of a type that numpy has not{cure(value) or '; pass its .astype(float)'}"
    at = ", ".join(map(str, first))
    return f"{came}, with {_short(array[first])} at [{at}]{cure(value)}"


def cure(value: object) -> str:
    """Return a remedy for a value that numpy cannot read or finds no numbers in."""
    module = type(value).__module__.partition(".")[0]
    if hasattr(value, "detach") and hasattr(value, "cpu"):
        return f"; pass its {''.join(_steps(value)) or '.detach().cpu()'}.numpy()"
    if hasattr(value, "__cuda_array_interface__"):
        return f"; pass its copy on the host, {'.get()' if hasattr(value, 'get') else 'as by .cpu()'}"
    if hasattr(value, "toarray"):
        return "; pass its .toarray()"
    if hasattr(value, "collect"):
        return "; pass its .collect()"
    if module == "polars":
        return "; pass its .to_list()" if hasattr(value, "to_list") else "; cast its columns to numbers"
    if module == "jax" and "Tracer" in type(value).__name__:
        return "; call it outside of what jax compiles, or by jax.pure_callback"
    if module == "xarray":
        return "; pass one of its variables, or its .to_array()"
    if hasattr(value, "to_numpy"):
        return "; pass its .to_numpy(dtype=float, na_value=float('nan')), or fill what is missing first"
    if hasattr(value, "to_pandas"):
        return "; pass its .to_pandas().to_numpy(dtype=float)"
    return "; pass a list of it" if hasattr(value, "__next__") else ""


def _steps(tensor: Any) -> list[str]:
    """Return the calls that make a tensor of torch one that numpy reads."""
    dtype, layout = (str(getattr(tensor, what, "")) for what in ("dtype", "layout"))
    steps = [".detach()"] if getattr(tensor, "requires_grad", False) else []
    steps += [".cpu()"] if _device(tensor) != "cpu" else []
    steps += [".to_dense()"] if "sparse" in layout else []
    steps += [".dequantize()"] if getattr(tensor, "is_quantized", False) else []
    steps += [f".resolve_{bit}()" for bit in ("conj", "neg") if getattr(tensor, f"is_{bit}", bool)()]
    steps += [".float()"] if "bfloat" in dtype or "float8" in dtype else []
    return steps


def _device(value: Any) -> str:
    return str(getattr(value, "device", "cpu")).partition(":")[0].lower()


def _short(value: object) -> str:
    """Return a short form of a value, or its type if that says more."""
    told = " ".join(repr(value).split())
    is_plain = len(told) <= 80 and " at 0x" not in told.lower()
    return told if is_plain or isinstance(value, str) else type(value).__name__


def _without_unit(name: str, value: Any) -> Any:
    """Return a quantity without a unit as plain numbers, and anything else as it is.

    Raises
    ------
    TypeError
        If it has a unit, or is a list of something that has.
    """
    kind = type(value)
    if kind in _SCALARS:
        return value
    if kind is list or kind is tuple:
        for other in set(map(type, value)) - _PLAIN:
            entry = next(entry for entry in value if type(entry) is other)
            if (unit := _unit(entry)) not in (None, "", "dimensionless"):
                raise TypeError(
                    f"{name} must be numbers without a unit, got {kind.__name__} of {_with(entry, unit)}"
                )
        # In nested lists, the first entry shows whether there are units.
        if value and type(value[0]) in (list, tuple):
            _without_unit(name, value[0])
        return value
    unit = _unit(value)
    if unit is None:
        return value
    if unit not in ("", "dimensionless"):
        raise TypeError(f"{name} must be numbers without a unit, got {_with(value, unit)}")
    return value.magnitude if hasattr(value, "magnitude") else value.value


def _unit(value: Any) -> str | None:
    """Return the unit of a quantity, "" or "dimensionless" if it has none, and None of other things."""
    if type(value).__module__.partition(".")[0] == "xarray":
        value = getattr(value, "data", value)
    for name in ("units", "unit"):
        unit = getattr(value, name, None)
        if type(unit).__module__.partition(".")[0] in _WITH_UNITS:
            return str(unit)
    return None


def _with(value: Any, unit: str) -> str:
    call = f".to_value({unit!r})" if hasattr(value, "to_value") else f".to({unit!r}).magnitude"
    return f"{type(value).__name__} in {unit}: convert it, and pass its {call}"


def _of_dlpack(name: str, value: Any) -> NDArray[Any]:
    code, number = value.__dlpack_device__()
    code = getattr(code, "value", code)
    if code not in _HOST:
        device = f"{_DEVICES.get(code, f'device {code}')}:{number}"
        call = ".get()" if hasattr(value, "get") and not hasattr(value, "cpu") else ".cpu()"
        raise TypeError(
            f"{name} must be an array of numbers in the memory of the CPU, got {type(value).__name__} "
            f"on {device}; pass its {call}"
        )
    try:
        return np.from_dlpack(value)
    except MemoryError:
        raise
    except Exception as error:
        raise _unreadable(name, value, value, error) from error


def _of_numpy(name: str, value: ArrayLike) -> NDArray[Any]:
    try:
        return np.asarray(value)
    except MemoryError:
        raise
    except Exception as error:
        # numpy's own error for a list has no Python frame below this one; errors from its entries may.
        is_own = isinstance(value, list | tuple) and error.__traceback__ and not error.__traceback__.tb_next
        if is_own and isinstance(error, ValueError) and any(words in str(error) for words in _RAGGED):
            raise ValueError(
                f"{name} must be a rectangular array, got ragged {type(value).__name__}"
            ) from None
        raise _unreadable(name, value, _culprit(value), error) from error


def _unreadable(name: str, value: object, culprit: object, error: Exception) -> Exception:
    within = "" if culprit is value else f" of {type(culprit).__name__}"
    told = " ".join(str(error).split()).rstrip(".") or type(error).__name__
    came = f"{type(value).__name__}{within}, which numpy cannot read ({told}){cure(culprit)}"
    kind = ValueError if isinstance(error, ValueError) else TypeError
    return kind(f"{name} must be an array of numbers, got {came}")


def _culprit(value: object) -> object:
    """Return the entry in nested lists that numpy cannot read."""
    while isinstance(value, list | tuple):
        for entry in value:
            try:
                np.asarray(entry)
            except Exception:
                value = entry
                break
        else:
            break
    return value


def _of_nullable(value: Any, array: NDArray[Any]) -> NDArray[Any]:
    """Return numbers of pandas' nullable columns, which come as objects, as an array of them."""
    if type(value).__module__.partition(".")[0] != "pandas" or not hasattr(value, "dtypes"):
        return array
    dtypes = value.dtypes
    kinds = {getattr(dtype, "kind", "O") for dtype in (dtypes if array.ndim == 2 else [dtypes])}
    if not kinds <= {"i", "u", "f"} or _first_other(array) is not None:
        return array
    return array.astype(np.int64 if "f" not in kinds else np.float64)


def _first_other(array: NDArray[Any]) -> tuple[int, ...] | None:
    """Return where the first entry is that is not a number."""
    others = (i for i, entry in np.ndenumerate(array) if not isinstance(entry, float | int | np.number))
    return next(others, None)


def _readable(array: NDArray[Any]) -> NDArray[Any]:
    """Return numbers that numpy knows of another package, such as bfloat16, as float64."""
    is_foreign = array.dtype.kind == "V" and array.dtype.type.__module__ == "ml_dtypes"
    return array.astype(np.float64) if is_foreign and "float" in array.dtype.name else array


def _unmasked(name: str, value: Any) -> None:
    """Refuse masked entries, which numpy would take for what lies below the mask."""
    # Arrays of numpy.ma have it, and astropy's Masked, which is none; without it, numpy.ma isn't imported.
    mask = getattr(value, "mask", None)
    if isinstance(mask, np.ndarray) and mask.dtype == np.bool_ and (count := int(mask.sum())):
        raise ValueError(f"{name} must have no masked entries, got {count}: fill them, as with NaN")
