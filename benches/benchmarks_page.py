"""Measure what the page of benchmarks shows, and write the page: docs/benchmarks.md.

    python benches/benchmarks_page.py                              # all of it, some five minutes
    python benches/benchmarks_page.py --section rays               # some of it, the rest as it is
    python benches/benchmarks_page.py --resume                     # what was not measured today
    python benches/benchmarks_page.py --write                      # the page anew, from the figures
    python benches/benchmarks_page.py --tiny --out /tmp/sample     # a try, whose figures mean nothing

The machine is to do nothing else: a warning tells its load. Engines are used where they are installed, as
in `peers.py`: `pip install embreex open3d mitsuba libigl pyviewfactor rtree matplotlib`. Each section's
figures are kept as JSON beside the page as soon as they are there.
"""

import argparse
import datetime
import json
import os
import platform
from pathlib import Path

# Before numpy is loaded, as in `peers.py`.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from dataclasses import replace

from page_plots import PLOTS
from page_sections import SECTIONS, TINY, Sizes, timed
from page_text import page

import raywright as rw

DOCS = Path(__file__).parents[1] / "docs"
_BUSY = 0.3


def machine():
    """Return what figures depend on, and the load before they were taken."""
    return {
        "processor": _field("/proc/cpuinfo", "model name") or platform.processor() or platform.machine(),
        "cores": os.cpu_count(),
        "memory_gib": int((_field("/proc/meminfo", "MemTotal") or "0").split()[0]) / 2**20,
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "raywright": rw.__version__,
        "simd": rw.simd(),
        "load": os.getloadavg()[0] if hasattr(os, "getloadavg") else float("nan"),
    }


def _field(path, name):
    """Return what a file of Linux says of a name; None elsewhere."""
    if not Path(path).exists():
        return None
    lines = Path(path).read_text().splitlines()
    return next((line.split(":")[1].strip() for line in lines if line.startswith(name)), None)


def read(out):
    """Return by section what has been measured."""
    files = {name: out / "benchmarks" / f"{name}.json" for name in SECTIONS}
    return {name: json.loads(file.read_text("utf-8")) for name, file in files.items() if file.exists()}


def measure(name, sizes, out, state):
    """Measure a section on a machine in such a state, and keep its figures."""
    today = datetime.datetime.now(datetime.timezone.utc).date().isoformat()
    records, seconds = timed(name, sizes)
    print(f"{name}: {seconds:.0f} s", flush=True)
    found = {"date": today, "machine": state, "seconds": round(seconds, 1), "records": _short(records)}
    (out / "benchmarks").mkdir(parents=True, exist_ok=True)
    (out / "benchmarks" / f"{name}.json").write_text(json.dumps(found, indent=1) + "\n", "utf-8")
    return seconds


def _short(value):
    """Return records whose numbers have six digits."""
    if isinstance(value, dict):
        return {key: _short(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [_short(each) for each in value]
    if isinstance(value, float) or hasattr(value, "dtype"):
        return float(f"{float(value):.6g}")
    return value


def write(out):
    """Write the page and its plots from what has been measured."""
    found = read(out)
    (out / "benchmarks.md").write_text(page(found), "utf-8")
    for name, plot in PLOTS.items():
        if name in found:
            plot(found[name]["records"], out / "benchmarks" / f"{name}.svg")


def main():
    """Do what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add = parser.add_argument
    add("--section", action="append", choices=SECTIONS, help="which; may be given several times")
    add("--resume", action="store_true", help="leave out what was measured today")
    add("--write", action="store_true", help="measure nothing")
    add("--tiny", action="store_true", help="at sizes of which nothing can be said, with --out")
    add("--out", type=Path, default=DOCS, help="a folder for the page")
    options = parser.parse_args()
    if options.tiny and options.out == DOCS:
        parser.error("--tiny wants --out: its figures do not belong into the docs")
    cores = os.cpu_count() or 1
    sizes = replace(TINY if options.tiny else Sizes(), threads=tuple(sorted({1, cores})))
    today = datetime.datetime.now(datetime.timezone.utc).date().isoformat()
    done = {name for name, found in read(options.out).items() if options.resume and found["date"] == today}
    wanted = [] if options.write else [name for name in options.section or SECTIONS if name not in done]
    # Measured once, since sections load the machine themselves.
    state = machine()
    if wanted and state["load"] > _BUSY:
        print(f"The machine is busy, its load is {state['load']:.2f}: figures will be wrong", flush=True)
    seconds = sum(measure(name, sizes, options.out, state) for name in wanted)
    write(options.out)
    print(f"{options.out / 'benchmarks.md'}: {seconds:.0f} s in all")


if __name__ == "__main__":
    main()
