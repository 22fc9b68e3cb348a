"""raywright at lower levels of vector instructions: each in a process of its own, which has one level."""

import multiprocessing
import os

from peers_engines import Engine, Raywright

import raywright as rw


class AtLevel(Engine):
    """raywright in single precision at a level, asked from outside; rays go there once, answers on demand."""

    package = "raywright"
    #: As RAYWRIGHT_SIMD calls it.
    level = ""

    def __init__(self):
        context = multiprocessing.get_context("spawn")
        self.pipe, end = context.Pipe()
        before = os.environ.get("RAYWRIGHT_SIMD")
        os.environ["RAYWRIGHT_SIMD"] = self.level
        try:
            self.process = context.Process(target=_serve, args=(end,), daemon=True)
            self.process.start()
        finally:
            if before is None:
                del os.environ["RAYWRIGHT_SIMD"]
            else:
                os.environ["RAYWRIGHT_SIMD"] = before
        try:
            level = self.pipe.recv()
        except EOFError:
            level = "none"
        if level != self.level:
            raise ImportError(f"this processor has no {self.level}")
        self.rays = None

    def __del__(self):
        if getattr(self, "process", None) is not None:
            self.process.terminate()

    def build(self, vertices, faces):
        """Make the scene."""
        self._send("build", vertices, faces)
        self.rays = None

    def ask(self, rays, mode):
        """Ask, and leave the answers where they are."""
        if self.rays is not rays:
            self._send("take", rays)
            self.rays = rays
        self._send("ask", self.threads)

    def trace(self, rays, mode):
        """Ask, and fetch the answers."""
        self.ask(rays, mode)
        return self._send("answers")

    def _send(self, *message):
        self.pipe.send(message)
        return self.pipe.recv()


class AtAvx2(AtLevel):
    """raywright at AVX2."""

    name, level = "raywright avx2", "avx2"


class AtSse2(AtLevel):
    """raywright at SSE2."""

    name, level = "raywright sse2", "sse2"


def _serve(pipe):
    pipe.send(rw.simd())
    engine, rays, answers = Raywright(), None, None
    while True:
        what, *given = pipe.recv()
        if what == "build":
            pipe.send(engine.build(*given))
        elif what == "take":
            (rays,) = given
            pipe.send(None)
        elif what == "ask":
            engine.use(*given)
            answers = engine.trace(rays, "")
            pipe.send(None)
        else:
            pipe.send(answers)
