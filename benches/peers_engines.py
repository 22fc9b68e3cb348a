"""Every engine behind the same three lines: make it of a mesh, give it threads, trace numpy arrays."""

import inspect

import numpy as np

import raywright as rw


class Engine:
    """One engine. Making one raises ImportError where it is not installed.

    `build` makes a scene of one mesh, ready for rays. `trace` answers with numpy arrays: whether each ray
    hits and, for closest hits, t; beside it the engine finds the triangle, in whatever form it gives that.
    Where an engine wants rays in a layout of its own, making it is part of `trace`, as it is of its use.
    """

    name = ""
    package = ""
    #: Ways to ask the same question; the engine is given credit for the fastest.
    modes = ("",)
    #: None where it takes any number.
    most_threads = None

    def build(self, vertices, faces):
        """Make a scene of (V,3) float32 vertices and (F,3) faces that is ready for rays."""
        raise NotImplementedError

    def use(self, threads):
        """Take so many threads from now on, or as many of them as can be used."""
        self.threads = threads

    def trace(self, rays, mode):
        """Return whether each ray hits and, for closest hits, t (else None)."""
        raise NotImplementedError

    def ask(self, rays, mode):
        """Do what is timed: what `trace` does."""
        self.trace(rays, mode)


class Raywright(Engine):
    """raywright in single precision."""

    name = package = "raywright"

    def build(self, vertices, faces):
        """Make the scene; asking for the accelerator compiles it."""
        self.scene = rw.Scene(rw.Mesh(vertices, faces))
        self.accelerator = self.scene.accelerator_info

    def trace(self, rays, mode):
        """Ask for the closest hits, or for occlusion."""
        if rays.any_hit:
            return self.scene.occluded(*rays[:2], t_max=rays.t_max, threads=self.threads), None
        hits = self.scene.intersect(*rays[:2], threads=self.threads)
        return hits.hit, hits.t


class RaywrightDouble(Raywright):
    """raywright in double precision."""

    name = "raywright double"

    def __init__(self):
        if "precision" not in inspect.signature(rw.Scene).parameters:
            raise ImportError("rw.Scene takes no `precision`")

    def build(self, vertices, faces):
        """Make the scene in float64."""
        self.scene = rw.Scene(rw.Mesh(vertices.astype(np.float64), faces), precision="double")
        self.accelerator = self.scene.accelerator_info


class Embreex(Engine):
    """Embree through embreex, in the robust mode that trimesh uses."""

    name = package = "embreex"
    most_threads = 1
    robust = True

    def __init__(self):
        from embreex.mesh_construction import TriangleMesh
        from embreex.rtcore_scene import EmbreeScene

        self.new_mesh, self.new_scene = TriangleMesh, EmbreeScene

    def build(self, vertices, faces):
        """Make the scene; the first ray commits it."""
        self.scene = self.new_scene(robust=self.robust)
        self.new_mesh(self.scene, vertices, faces.astype(np.int32))
        self.scene.run(np.zeros((1, 3), np.float32), np.ones((1, 3), np.float32))

    def trace(self, rays, mode):
        """Ask for all that is known of the closest hits, or for occlusion."""
        origins, directions = rays.origins.reshape(-1, 3), rays.directions.reshape(-1, 3)
        if rays.any_hit:
            reach = None if np.isinf(rays.t_max) else rays.t_max
            return self.scene.run(origins, directions, dists=reach, query="OCCLUDED") >= 0, None
        found = self.scene.run(origins, directions, output=True)
        return found["primID"] >= 0, found["tfar"]


class EmbreexFast(Embreex):
    """Embree through embreex, in the mode that is not robust."""

    name = "embreex fast"
    robust = False


class Trimesh(Engine):
    """trimesh's own queries, which go through embreex, and give no t but the places of hits."""

    name = package = "trimesh"
    most_threads = 1

    def __init__(self):
        # Without embreex, trimesh would use a ray tracer written in Python.
        import embreex  # noqa: F401
        import trimesh

        self.new_mesh = trimesh.Trimesh

    def build(self, vertices, faces):
        """Make the scene; the first ray commits it."""
        self.mesh = self.new_mesh(vertices, faces, process=False)
        self.mesh.ray.intersects_any(np.zeros((1, 3)), np.ones((1, 3)))

    def trace(self, rays, mode):
        """Ask for the places of the closest hits, or for any hit where rays have no end."""
        origins, directions = rays.origins.reshape(-1, 3), rays.directions.reshape(-1, 3)
        if rays.any_hit and np.isinf(rays.t_max):
            return self.mesh.ray.intersects_any(origins, directions), None
        _, index, place = self.mesh.ray.intersects_id(
            origins, directions, multiple_hits=False, return_locations=True
        )
        t = np.full(len(origins), np.inf)
        along = directions[index]
        t[index] = np.sum((place - origins[index]) * along, axis=1) / np.sum(along * along, axis=1)
        return t <= min(rays.t_max, np.finfo(t.dtype).max), None if rays.any_hit else t


class Open3D(Engine):
    """Embree through Open3D's RaycastingScene."""

    name = package = "open3d"

    def __init__(self):
        import open3d

        self.tensor, self.new_scene = open3d.core.Tensor, open3d.t.geometry.RaycastingScene

    def build(self, vertices, faces):
        """Make the scene; the first ray commits it."""
        self.scene = self.new_scene()
        self.scene.add_triangles(self.tensor(vertices), self.tensor(faces.astype(np.uint32)))
        self.scene.cast_rays(self.tensor(np.ones((1, 6), np.float32)))

    def trace(self, rays, mode):
        """Ask for the closest hits, or for occlusion; a ray is one row of six numbers."""
        packed = self.tensor.from_numpy(np.concatenate([rays.origins, rays.directions], axis=-1))
        if rays.any_hit:
            found = self.scene.test_occlusions(packed, tfar=float(rays.t_max), nthreads=self.threads)
            return found.numpy(), None
        t = self.scene.cast_rays(packed, nthreads=self.threads)["t_hit"].numpy()
        return np.isfinite(t), t


class Mitsuba(Engine):
    """Embree through Mitsuba 3 and LLVM, told that rays are coherent or not."""

    name = package = "mitsuba"
    modes = ("coherent", "incoherent")

    def __init__(self):
        import drjit
        import mitsuba

        mitsuba.set_variant("llvm_ad_rgb")
        self.dr, self.mi = drjit, mitsuba

    def build(self, vertices, faces):
        """Make the scene."""
        mi = self.mi
        mesh = mi.Mesh("mesh", len(vertices), len(faces))
        parts = mi.traverse(mesh)
        parts["vertex_positions"] = mi.Float(vertices.reshape(-1))
        parts["faces"] = mi.UInt(faces.astype(np.uint32).reshape(-1))
        parts.update()
        self.scene = mi.load_dict({"type": "scene", "mesh": mesh})
        self.dr.sync_thread()

    def use(self, threads):
        """Set the size of the one pool that all of Mitsuba has."""
        if self.dr.thread_count() != threads:
            self.dr.set_thread_count(threads)

    def trace(self, rays, mode):
        """Ask for the closest hits with their triangles, or for occlusion.

        A tensor shares numpy's memory, and unravelling it is compiled into the kernel that traces: the
        cheapest of five ways that were measured.
        """
        mi, dr = self.mi, self.dr
        ray = mi.Ray3f(
            dr.unravel(mi.Point3f, mi.TensorXf(rays.origins).array),
            dr.unravel(mi.Vector3f, mi.TensorXf(rays.directions).array),
        )
        if not np.isinf(rays.t_max):
            ray.maxt = rays.t_max
        coherent = mode == "coherent"
        if rays.any_hit:
            return self.scene.ray_test(ray, coherent=coherent).numpy(), None
        found = self.scene.ray_intersect_preliminary(ray, coherent=coherent)
        dr.eval(found.t, found.prim_index)  # in one kernel
        t, _ = found.t.numpy(), found.prim_index.numpy()
        return np.isfinite(t), t
