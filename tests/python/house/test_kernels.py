"""Kernels are compiled whole: what they call is rare, ends a batch or belongs to the allocator.

A function that is not inlined is compiled for the base level of the processor, and a call in a loop over
lanes keeps it from becoming vectors. The relocations of compiled crates name each function that is called.
"""

import os
import platform
import re
import shutil
import subprocess
from collections import defaultdict
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))

#: The functions that kernels are compiled in, by the level of the processor.
KERNELS = {"with_sse2", "with_avx2", "with_avx512", "at_base_level"}

#: What any function may call: panics, memory, the C library where a level has no instruction.
ANYWHERE = re.compile(
    r"panic|_Unwind_Resume|slice_index_fail|handle_error|handle_alloc_error|expect_failed|unwrap_failed"
    r"|__rust_(no_)?alloc|__rust_dealloc|grow_one|do_reserve_and_handle|drop_in_place"
    r"|^mem(cpy|set|move)$|^(fma|log|pow|expm1|exp|sin|cos|acos|atan2|asin|tan)f?$"
)

#: What kernels call by themselves, by the reason that makes it no loss.
CALLED = {
    # Exact fallbacks where f32 and f64 cannot decide.
    "EdgeRay::meet_closely", "refine_hits::alone", "looking::decide", "looking::decide_any", "Bests::decide",
    "parity::sign_of_t", "nearest::nearest_far_point", "SolidCone::nearest", "View::see",
    "Primitives::corners",
    # Once per batch, or once per full stack.
    "Stacks::new", "Stacks::spare", "Stacks::put_away", "Gate::new", "few_leaves::leaves",
    "coherence::is_coherent", "ConeBoxTest::new", "nearest::by_place",
    # Shapes other than triangles, rare queries, their answers.
    "Contents::meet_objects", "RareQuery::initial_state", "RareQuery::offer_hit", "RareQuery::write_answer",
    "Few::ask", "Touches::push", "QueryVisitor::finish",
    # Scalar table lookups by lane.
    "halton::coordinate", "beckmann::leaning", "Filmed::reflectance",
    "LayeredPrincipled::evaluate", "LayeredPrincipled::sample",
    "LayeredPrincipledThin::evaluate", "LayeredPrincipledThin::sample",
}  # fmt: skip

#: Data, which is no call.
DATA = {"x86::FRONT", "permutation::FIELDS"}


def parts(symbol):
    """Return the names that a mangled symbol is made of."""
    found, rest = [], symbol.partition("_ZN")[2]
    while match := re.match(r"\d+", rest):
        end = match.end() + int(match[0])
        found.append(rest[match.end() : end])
        rest = rest[end:]
    found = [name for name in found if not re.fullmatch(r"h[0-9a-f]{16}", name)]
    return found or [symbol]


def short(names):
    """Return the type or module, and the name, of a function."""
    if names[0].startswith("_$LT$"):
        # A method of a trait.
        owner = re.split(r"\.\.|\$", names[0].partition("$u20$as$u20$")[2 if "Primitives" in names[0] else 0])
        plain = [word for word in owner if word and word[0].isupper() and word not in ("LT", "GT", "RF", "C")]
        return f"{plain[0]}::{names[-1]}" if plain else names[-1]
    return "::".join(re.sub(r"\$.*", "", name) for name in names[-2:])


def calls(folder):
    """Return what kernels of the newest compiled crates call, each with the kernels that do."""
    found = defaultdict(set)
    crates = {}
    for path in sorted(TARGET.glob("release/deps/libraywright_*.rlib"), key=os.path.getmtime):
        crates[path.name.partition("-")[0]] = path
    for name, path in crates.items():
        unpacked = folder / name
        unpacked.mkdir()
        subprocess.run(["ar", "x", path], cwd=unpacked, check=True)
        objects = sorted(unpacked.glob("*.o"))
        if not objects:
            continue
        listed = subprocess.run(
            ["objdump", "-r", *objects], capture_output=True, text=True, check=True
        ).stdout
        kernel = None
        for line in listed.splitlines():
            if heading := re.match(r"RELOCATION RECORDS FOR \[(.*)\]", line):
                names = parts(heading[1])
                kernel = "::".join(names[-2:]) if names[-1] in KERNELS and ".text" in heading[1] else None
            elif kernel and (row := re.match(r"\S+ R_X86_64_(?:PLT32|\w*GOTPCREL\w*)\s+(\S+)", line)):
                found[re.sub(r"[-+]0x[0-9a-f]+$", "", row[1])].add(kernel)
    return found


@pytest.mark.skipif(
    platform.machine() != "x86_64" or not all(map(shutil.which, ("ar", "objdump"))),
    reason="only relocations of x86-64 are read, by binutils",
)
@pytest.mark.skipif(
    not list(TARGET.glob("release/deps/libraywright_accel-*.rlib")), reason="no crates are here"
)
def test_kernels_call_nothing_in_their_loops(tmp_path):
    found = calls(tmp_path)
    assert any("level::with_avx2" in kernels for kernels in found.values()), "no kernel was read"
    unknown = {}
    for symbol, kernels in found.items():
        name = short(parts(symbol))
        if not ANYWHERE.search(symbol) and name not in CALLED | DATA:
            unknown[name] = sorted(kernels)
    assert not unknown
