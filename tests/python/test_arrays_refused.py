"""What is no array of numbers is refused with its cause, and with what helps."""

from decimal import Decimal

import numpy as np
import pytest

import raywright as rw


class Tensor:
    """As torch's tensors refuse to become arrays."""

    def __init__(self, device="cpu", requires_grad=False):
        self.device, self.requires_grad = device, requires_grad

    def detach(self):
        return self

    cpu = detach

    def __array__(self, dtype=None, copy=None):
        if self.device != "cpu":
            raise TypeError("can't convert cuda:0 device type tensor to numpy.")
        raise RuntimeError("Can't call numpy() on Tensor that requires grad.")


class Broken:
    def __init__(self, error):
        self.error = error

    def __array__(self, dtype=None, copy=None):
        raise self.error


class Frame:
    """As frames of nullable or arrow columns become arrays of objects."""

    def __init__(self, entries):
        self.entries = np.array(entries, object)

    def __array__(self, dtype=None, copy=None):
        return self.entries

    def to_numpy(self, dtype=None, na_value=None):
        return self.entries.astype(dtype)


READ = "must be an array of numbers"
CUDA, GRAD = Tensor("cuda:0"), Tensor(requires_grad=True)
BOTH = Tensor("cuda:1", requires_grad=True)


@pytest.mark.parametrize(
    ("value", "kind", "message"),
    [
        (
            CUDA,
            TypeError,
            f"{READ}, got Tensor, which numpy cannot read (can't convert cuda:0 device "
            "type tensor to numpy); pass its .cpu().numpy()",
        ),
        (
            GRAD,
            TypeError,
            f"{READ}, got Tensor, which numpy cannot read (Can't call numpy() on Tensor "
            "that requires grad); pass its .detach().numpy()",
        ),
        (
            [(1, 2, 3), (4, 5, BOTH)],
            TypeError,
            f"{READ}, got list of Tensor, which numpy cannot read (can't convert cuda:0 "
            "device type tensor to numpy); pass its .detach().cpu().numpy()",
        ),
        (
            Broken(ValueError("could not broadcast\nwhat is within")),
            ValueError,
            f"{READ}, got Broken, which numpy cannot read (could not broadcast what is within)",
        ),
        (
            [Broken(ValueError("inhomogeneous"))],
            ValueError,
            f"{READ}, got list of Broken, which numpy cannot read (inhomogeneous)",
        ),
        (
            Broken(OSError()),
            TypeError,
            f"{READ}, got Broken, which numpy cannot read (OSError)",
        ),
        ([(1, 2, 3), (1, 2)], ValueError, "must be a rectangular array, got ragged list"),
        ((np.zeros((2, 3)), np.zeros((2, 2))), ValueError, "must be a rectangular array, got ragged tuple"),
        (
            Frame([(0.0, None, 1.0)]),
            TypeError,
            "must be real numbers, got Frame of dtype object, with None at [0, 1]; pass its "
            ".to_numpy(dtype=float, na_value=float('nan')), or fill what is missing first",
        ),
        (
            Frame([(0.0, 1, 1.0)]),
            TypeError,
            "must be real numbers, got Frame of dtype object: numbers of a type that numpy has not; pass its "
            ".to_numpy(dtype=float, na_value=float('nan')), or fill what is missing first",
        ),
        (
            np.array([(1.0, Decimal(2), 3.0)]),
            TypeError,
            "must be real numbers, got dtype object, with Decimal('2') at [0, 1]",
        ),
        (
            np.array([(1.0, 2.0, 3.0)], object),
            TypeError,
            "must be real numbers, got dtype object: numbers of a type that numpy has not; "
            "pass its .astype(float)",
        ),
    ],
)
def test_the_cause_and_the_cure_are_named(value, kind, message):
    scene = rw.Scene(rw.Sphere((0, 0, 0), 1))
    for name, ask in (
        ("vertices", lambda: rw.Mesh(value, [(0, 0, 0)])),
        ("origins", lambda: scene.intersect(value, (0, 0, 1))),
        ("t_max", lambda: scene.occluded((0, 0, 0), (0, 0, 1), t_max=value)),
        ("points", lambda: scene.contains(value)),
    ):
        with pytest.raises(kind) as caught:
            ask()
        assert str(caught.value) == f"{name} {message}"


def test_memory_that_is_not_there_is_no_fault_of_the_array():
    with pytest.raises(MemoryError):
        rw.Mesh(Broken(MemoryError()), [(0, 0, 0)])
