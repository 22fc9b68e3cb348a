"""Hashes of answers, by which a change is seen to keep every bit of them.

    python benches/answers.py --mesh bunny.npz --write before.json
    python benches/answers.py --mesh bunny.npz --compare after.json     # 1 if an answer differs

The rays are those of `peers.py`, float32 and float64, at each mesh as it is, turned, and turned with all
digits of float64. Each row is asked with several numbers of threads, which must agree; a hash is of all bytes
of `t`, `shape_id`, `primitive_id` and `uv`, or of what is occluded.
"""

import argparse
import hashlib
import json
from pathlib import Path

import numpy as np
from peers_meshes import MADE, given, turned
from peers_rays import NAMES, ray_sets

import raywright as rw

#: How meshes stand.
PLACES = ("straight", "turned", "turned double")


def placed(subject, place):
    """Return a subject as it stands at one of `PLACES`."""
    if place == "straight":
        return subject
    return turned(subject, np.float64 if "double" in place else np.float32)


def hashed(scene, rays, digits, threads):
    """Return the hash of a scene's answers to rays of so many digits."""
    origins, directions = rays.origins, rays.directions
    if digits == np.float64:
        # Digits beyond float32.
        noise = np.random.default_rng(5).normal(size=directions.shape)
        origins, directions = origins.astype(digits), directions * (1 + 1e-9 * noise)
    if rays.any_hit:
        parts = [scene.occluded(origins, directions, t_max=rays.t_max, threads=threads)]
    else:
        hits = scene.intersect(origins, directions, t_max=rays.t_max, threads=threads)
        parts = [hits.t, hits.shape_id, hits.primitive_id, hits.uv]
    sums = hashlib.sha256()
    for part in parts:
        sums.update(np.ascontiguousarray(part).tobytes())
    return sums.hexdigest()


def answers(meshes, side, threads):
    """Return the hashes by mesh, place, row and type of rays."""
    found = {}
    for mesh in meshes:
        subject = MADE[mesh](70_000, np.random.default_rng(0)) if mesh in MADE else given(mesh)
        for place in PLACES:
            here = placed(subject, place)
            precision = "double" if "double" in place else "single"
            scene = rw.Scene(rw.Mesh(here.vertices, here.faces), precision=precision)
            sets = ray_sets(scene, here, side, np.random.default_rng(1))
            for name in NAMES:
                for digits in (np.float32, np.float64):
                    key = f"{Path(mesh).stem}, {place}: {name}, {np.dtype(digits).name}"
                    each = {n: hashed(scene, sets[name], digits, n) for n in threads}
                    if len(set(each.values())) != 1:
                        raise SystemExit(f"{key}: threads disagree: {each}")
                    found[key] = each[threads[0]]
                    print(f"{key}: {found[key][:16]}", flush=True)
    return found


def main():
    """Find the hashes that the command line asks for, and write or compare them."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add = parser.add_argument
    add("--mesh", action="append", help=f"{', '.join(MADE)} or a file; may be given several times")
    add("--side", type=int, default=1024, help="square root of the number of rays of a row")
    add("--threads", default="1,2,3", help="numbers of threads that must agree")
    add("--write", type=Path, help="a file for the hashes")
    add("--compare", type=Path, help="a file of hashes that must be the same")
    options = parser.parse_args()
    print(f"at {rw.simd()}")
    found = answers(options.mesh or list(MADE), options.side, [int(n) for n in options.threads.split(",")])
    if options.write:
        options.write.write_text(json.dumps(found, indent=1))
    if options.compare:
        wanted = json.loads(options.compare.read_text())
        common = found.keys() & wanted.keys()
        differing = sorted(key for key in common if found[key] != wanted[key])
        for key in differing:
            print(f"differs: {key}")
        print(f"{len(common) - len(differing)} of {len(common)} answers are the same")
        raise SystemExit(1 if differing or not common else 0)


if __name__ == "__main__":
    main()
