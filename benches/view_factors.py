"""View factors of a box with a block in it: time and error, beside pyViewFactor where that is installed.

    python benches/view_factors.py [--cuts 13 18 26] [--rays 16] [--peer]

Each side of the box is cut into squares; ours are of two triangles each, pyViewFactor's are whole. Before
anything is timed, the empty box must have rows that add up to one, and sides as Howell's catalog has them.
"""

import argparse
import math
import time

import numpy as np

import raywright as rw


def side(corner, across, up, cuts):
    """Cut a parallelogram into squares of two triangles each, which stand one after the other."""
    at = [corner + across * i / cuts + up * j / cuts for i in range(cuts + 1) for j in range(cuts + 1)]
    faces = []
    for i in range(cuts):
        for j in range(cuts):
            a, b = i * (cuts + 1) + j, (i + 1) * (cuts + 1) + j
            faces += [[a, b, b + 1], [a, b + 1, a + 1]]
    return np.array(at), np.array(faces)


def room(cuts):
    """Cut up the inside of a unit box: six meshes."""
    x, y, z = np.eye(3)
    sides = [(0 * x, y, z), (x, z, y), (0 * x, z, x), (y, x, z), (0 * x, x, y), (z, y, x)]
    return [rw.Mesh(*side(*place, cuts)) for place in sides]


def block():
    """Stand in the middle of the box, and look outwards."""
    low, size = np.array([0.35, 0.3, 0.25]), np.diag([0.3, 0.35, 0.4])
    x, y, z = size
    far = low + x + y + z
    sides = [(low, z, y), (low, x, z), (low, y, x), (far, -y, -z), (far, -z, -x), (far, -x, -y)]
    return [rw.Mesh(*side(*place, 1)) for place in sides]


def validate():
    """Check the empty box against the catalog (C-11, C-14), and that rows add up."""
    sides = rw.view_factors(rw.Scene(room(4)), per="shape", progress=False)
    opposed = (
        2 / math.pi * (math.log(2 / math.sqrt(3)) + math.sqrt(8) * math.atan(math.sqrt(0.5)) - math.pi / 2)
    )
    for i in range(6):
        for j in range(6):
            truth = 0.0 if i == j else opposed if i // 2 == j // 2 else (1 - opposed) / 4
            assert abs(sides.matrix[i, j] - truth) < 1e-10, (i, j)
    assert np.abs(rw.view_factors(rw.Scene(room(4)), progress=False).to_surroundings).max() < 1e-9


def peer(cuts):
    """Return what pyViewFactor and raywright take on the squares of the empty box, and how they differ.

    Raises
    ------
    ImportError
        If pyViewFactor is not installed.
    """
    import pyvista
    from pyviewfactor import compute_viewfactor, get_visibility

    squares = []
    for mesh in room(cuts):
        for pair in mesh.faces.reshape(-1, 6):
            corners = mesh.vertices[pair[[0, 1, 2, 5]]]
            squares.append(pyvista.PolyData(corners, [4, 0, 1, 2, 3]))
    # A first call compiles the functions and does not count.
    get_visibility(squares[0], squares[-1]), compute_viewfactor(squares[0], squares[-1])
    start, count = time.perf_counter(), len(squares)
    matrix = np.zeros((count, count))
    for i, one in enumerate(squares):
        for j, other in enumerate(squares):
            if one is not other and get_visibility(other, one)[0]:
                matrix[i, j] = compute_viewfactor(other, one)
    seconds = time.perf_counter() - start
    start = time.perf_counter()
    ours = rw.view_factors(rw.Scene(room(cuts)), progress=False).matrix
    own_seconds = time.perf_counter() - start
    ours = ours.reshape(count, 2, count, 2).sum(axis=3).mean(axis=1)
    rows, own_rows = (float(np.abs(of.sum(axis=1) - 1).max()) for of in (matrix, ours))
    return {
        "squares": count,
        "peer_seconds": seconds,
        "raywright_seconds": own_seconds,
        "peer_rows_off": rows,
        "raywright_rows_off": own_rows,
        "greatest_difference": float(np.abs(matrix - ours).max()),
    }


def with_peer(cuts):
    """Tell in a line what `peer` returns."""
    try:
        r = peer(cuts)
    except ImportError as missing:
        return f"skipped: {missing}"
    return (
        f"{r['peer_seconds']:.1f} s, rows within {r['peer_rows_off']:.1e}; ours, of twice as many triangles: "
        f"{r['raywright_seconds']:.2f} s, rows within {r['raywright_rows_off']:.1e}; "
        f"apart by {r['greatest_difference']:.1e}"
    )


def alone(cuts, rays):
    """Return a record for the empty box and one for that with a block in it."""
    records = []
    for name, shapes in (("empty", room(cuts)), ("with a block", room(cuts) + block())):
        scene = rw.Scene(shapes)
        start = time.perf_counter()
        found = rw.view_factors(scene, rays=rays, progress=False)
        seconds = time.perf_counter() - start
        records.append(
            {
                "room": name,
                "triangles": len(found),
                "seconds": seconds,
                "closed": found.closed,
                "hidden": found.hidden,
                "sampled": found.sampled,
                "rays": found.rays,
                "rows_off": float(np.abs(found.to_surroundings).max()),
                "error_of_rows": float(np.sqrt((found.standard_error**2).sum(axis=1)).max()),
            }
        )
    return records


def main():
    """Validate, time, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cuts", type=int, nargs="+", default=[13, 18, 26], help="of each side")
    parser.add_argument(
        "--rays", type=int, default=16, help="between two faces that something may lie between"
    )
    parser.add_argument("--peer", action="store_true", help="pyViewFactor too, which takes minutes")
    arguments = parser.parse_args()
    validate()
    print("box and block are as the catalog has them, and rows add up", flush=True)
    for cuts in arguments.cuts:
        for r in alone(cuts, arguments.rays):
            print(
                f"{r['triangles']} triangles, {r['room']}: {r['seconds']:.2f} s; "
                f"pairs: {r['closed']} closed, {r['hidden']} hidden, {r['sampled']} sampled, "
                f"{r['rays']} rays; rows within {r['rows_off']:.1e}, "
                f"errors of rows up to {r['error_of_rows']:.1e}",
                flush=True,
            )
        if arguments.peer:
            print(f"{6 * cuts * cuts} squares, empty, pyViewFactor: {with_peer(cuts)}", flush=True)


if __name__ == "__main__":
    main()
