"""Threads beside forked processes and signals."""

import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import raywright as rw

TETRAHEDRON = rw.Mesh(
    [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
)


def rays(count):
    rng = np.random.default_rng(1)
    return rng.uniform(-1, 2, (count, 3)), rng.normal(size=(count, 3))


def hit_count(_):
    return int(rw.Scene(TETRAHEDRON).intersect(*rays(5000)).hit.sum())


MANY = """
import numpy as np
import raywright as rw

scene = rw.Scene(rw.Sphere((0, 0, 0), 1))
for threads in (10**9, 2**70):
    assert scene.intersect(np.zeros((1000, 3)), (0, 0, 1), threads=threads).hit.all()
"""


def test_a_limit_beyond_all_machines_starts_no_more_threads_than_are_of_use():
    # Thousands of threads took minutes to start, without a way to interrupt.
    subprocess.run([sys.executable, "-c", MANY], check=True, timeout=20)


@pytest.mark.skipif(sys.platform == "win32", reason="no fork there")
@pytest.mark.filterwarnings("ignore:.*multi-threaded, use of fork.*:DeprecationWarning")
def test_a_forked_process_has_threads_of_its_own():
    here = hit_count(None)  # the parent's threads are running when it forks
    with multiprocessing.get_context("fork").Pool(1) as pool:
        assert pool.map_async(hit_count, [None]).get(timeout=60) == [here]


FORKS = """
import os
import sys
import threading
import warnings

import numpy as np
import raywright as rw
from raywright.io.quiet import quiet, warn_caller
from raywright.rendering.worker import _lock as jobs
from raywright.scene.unpickle_cache import _lock as arrivals

box = rw.Scene(rw.Box((0, 0, 0), (1, 1, 1)))
within, done = threading.Event(), threading.Event()


def watch(share):
    within.set()
    done.wait(20)


def build():
    with quiet(), jobs, arrivals:
        box.build(progress=watch)


builder = threading.Thread(target=build)
builder.start()
assert within.wait(20)
child = os.fork()
if child == 0:
    hit = box.intersect((0.5, 0.5, 3), (0, 0, -1)).hit  # the very scene that is being built
    with quiet(), jobs, arrivals:
        pass
    with warnings.catch_warnings(record=True) as caught:
        warn_caller("heard again")
    os._exit(0 if hit and len(caught) == 1 else 7 + 2 * hit + len(caught))
for _ in range(200):
    ended, status = os.waitpid(child, os.WNOHANG)
    if ended:
        break
    threading.Event().wait(0.05)
else:
    os.kill(child, 9)
done.set()
builder.join()
assert ended and os.waitstatus_to_exitcode(status) == 0, (ended, ended and os.waitstatus_to_exitcode(status))
assert box.intersect((0.5, 0.5, 3), (0, 0, -1)).hit
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork")
def test_a_process_forked_while_a_thread_builds_builds_by_itself():
    ended = subprocess.run(
        [sys.executable, "-W", "ignore::DeprecationWarning", "-c", FORKS],
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert ended.returncode == 0, ended.stderr


FORK_WITHIN = """
import os
from raywright.locks import Lock

lock, undone = Lock(lambda: undone.append(1)), []
with lock:
    child = os.fork()
    if child == 0:
        with lock:  # the thread that forked holds it still
            pass
    else:
        assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
assert not undone
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork")
def test_a_lock_of_the_thread_that_forks_stays_its_own():
    subprocess.run([sys.executable, "-c", FORK_WITHIN], check=True, timeout=60)


@pytest.mark.skipif(sys.platform == "win32", reason="signals differ there")
def test_ctrl_c_ends_a_query_at_once():
    # Brute force over ten thousand triangles: some minutes of work without interruption.
    rng = np.random.default_rng(2)
    vertices = rng.normal(size=(30_000, 3))
    soup = rw.Mesh(vertices, np.arange(30_000).reshape(-1, 3))
    scene = rw.Scene(soup, accelerator=rw.BruteForce())
    origins, directions = rng.normal(size=(2, 2_000_000, 3))
    scene.intersect(origins[:10], directions[:10])
    timer = threading.Timer(0.3, signal.raise_signal, (signal.SIGINT,))
    start = time.monotonic()
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        scene.intersect(origins, directions)
    # The documented limit is a tenth of a second on an idle machine; tests run beside other work.
    assert time.monotonic() - start < 2.0


# Says how many threads a call without a number of them is shared out among, and how many are told.
COUNTED = """
import os
{before}
import numpy as np
import raywright as rw
from raywright import _core

scene = rw.Scene([rw.Sphere((0, 0, 0), 1)])
scene.intersect(np.zeros((10**5, 3)), (0, 0, 1))
names = [open(f"/proc/self/task/{{task}}/comm").read() for task in os.listdir("/proc/self/task")]
print(_core.cores(), sum(name.startswith("raywright-") for name in names))
"""


def threads_after(before, **environment):
    found = subprocess.run(
        [sys.executable, "-c", COUNTED.format(before=before)],
        check=True,
        timeout=60,
        capture_output=True,
        text=True,
        env={**{k: v for k, v in os.environ.items() if k != "RAYON_NUM_THREADS"}, **environment},
    )
    return [int(count) for count in found.stdout.split()]


@pytest.mark.skipif(not hasattr(os, "sched_getaffinity"), reason="no affinity there")
def test_threads_are_as_many_as_cores_that_the_process_may_use():
    own = sorted(os.sched_getaffinity(0))
    # A control group may allow fewer.
    assert threads_after("")[0] == threads_after("")[1] <= len(own)
    for count in {1, min(2, len(own))}:
        told, started = threads_after(f"os.sched_setaffinity(0, {own[:count]})")
        assert told == started <= count
    # What `-X cpu_count` and PYTHON_CPU_COUNT say from Python 3.13 on; more than there are is of no use.
    assert threads_after("os.process_cpu_count = lambda: 1") == [1, 1]
    assert threads_after("os.process_cpu_count = lambda: None") == threads_after("")
    assert threads_after("os.process_cpu_count = lambda: 4096") == threads_after("")
    assert threads_after("", RAYON_NUM_THREADS="3") == [3, 3]
    if sys.version_info >= (3, 13):
        assert threads_after("", PYTHON_CPU_COUNT="1") == [1, 1]
