"""Files that must be refused: by one line, within a second of the processor, and in less than a gigabyte."""

import json
import select
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

READ = """
import json, resource, sys, time
import raywright as rw
from raywright.scene_files.gltf import read_gltf
from raywright.io.pictures import read
import trimesh, PIL.Image, numpy
from PIL import PngImagePlugin, JpegImagePlugin
PIL.Image.init()

readers = {"gltf": read_gltf, "mesh": rw.Scene, "picture": read}
with open("/proc/self/statm") as file:
    pages = int(file.read().split()[0])
most = pages * resource.getpagesize() + 2**30
resource.setrlimit(resource.RLIMIT_AS, (most, most))

def peak():
    # What `getrusage` gives is no less than the process had that started this one.
    with open("/proc/self/status") as file:
        return next(int(line.split()[1]) for line in file if line.startswith("VmHWM")) * 1024

for line in sys.stdin:
    kind, path = json.loads(line)
    began = time.process_time()
    try:
        readers[kind](path)
        told = ["nothing", ""]
    except BaseException as error:
        told = [type(error).__name__, str(error)]
    took = time.process_time() - began
    print(json.dumps([*told, took, peak()]), flush=True)
"""


# Seconds, on a machine that may have other load. CPU seconds are counted, too, and must be few.
PATIENCE = 60


class Refusal(NamedTuple):
    """What came of reading a file."""

    kind: str
    message: str
    seconds: float
    bytes: int


class Reader:
    """A process that reads files, and may take one gigabyte more than it has when nothing is read."""

    def __init__(self) -> None:
        command = [sys.executable, "-W", "error", "-c", READ]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def read(self, kind: str, path: Path) -> Refusal:
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write(json.dumps([kind, str(path)]) + "\n")
        self._process.stdin.flush()
        if not select.select([self._process.stdout], [], [], PATIENCE)[0]:
            self._process.kill()
            raise TimeoutError(f"{path.name} was read for {PATIENCE} seconds")
        return Refusal(*json.loads(self._process.stdout.readline()))

    def refuse(self, kind: str, path: Path) -> str:
        """Return what a file is refused by, having checked all that is promised of refusals."""
        came = self.read(kind, path)
        assert came.kind == "ValueError", came
        assert path.name in came.message
        assert "\n" not in came.message
        assert "Error" not in came.message.replace(str(path), ""), came.message
        assert len(came.message) < 250 + 2 * len(str(path))
        assert came.seconds < 1
        assert came.bytes < 10**9
        return came.message

    def close(self) -> None:
        self._process.communicate(timeout=30)
