#!/usr/bin/env python3
"""Compares rays from Python: glint, Open3D's RaycastingScene and trimesh's ray_triangle, from numpy arrays to numpy arrays.

    bench/python_peers.py [--repeat N] [--size N] [--assets FOLDER] [--only answers|rates] [--quick]

Rates: million rays a second of wall clock and of all processors' time, runs in turns, medians and quartiles over N (default 9), and of each
turn's ratio. Answers: rays aimed at vertices and edges of closed meshes, from inside, where every one must hit and cross an odd number of
triangles, and from outside, where it must cross an even number.

GLINT_LIBRARY and PYTHONPATH say which glint. Open3D is Debian's python3-open3d, whose rays have the mask 0 while Debian's Embree is built with
masks, so that every ray misses: a library that sets the mask is compiled here (gcc) and put in between. trimesh is not in Debian; from
elsewhere by PYTHONPATH, with Debian's python3-rtree. A missing package is named and left out.
"""
import argparse
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np

import compare_povray
import measure

SHIM = r"""
#include <dlfcn.h>
#include <stddef.h>
/* RTCRay of Embree 3: the mask is the tenth word. */
static void unmask(char* rays, unsigned count, size_t stride) {
    for (unsigned i = 0; i < count; ++i) ((unsigned*)(rays + i * stride))[9] = ~0u;
}
/* Python loads it for Open3D alone, so that RTLD_NEXT would not find it. */
static void* embree(void) { return dlopen("libembree3.so.3", RTLD_LAZY | RTLD_NOLOAD); }
#define WRAP(NAME)                                                                                         \
    void NAME(void* scene, void* context, void* rays, unsigned count, size_t stride) {                     \
        static void (*real)(void*, void*, void*, unsigned, size_t);                                        \
        if (real == NULL) real = (void (*)(void*, void*, void*, unsigned, size_t))dlsym(embree(), #NAME);  \
        unmask(rays, count, stride);                                                                       \
        real(scene, context, rays, count, stride);                                                         \
    }
WRAP(rtcIntersect1M)
WRAP(rtcOccluded1M)
"""
MARK = "GLINT_PEERS_UNMASKED"


def unmasked():
    """Starts this script again with the shim before Embree."""
    if MARK in os.environ:
        return
    with tempfile.TemporaryDirectory() as folder:
        source, library = pathlib.Path(folder, "shim.c"), pathlib.Path(folder, "shim.so")
        source.write_text(SHIM)
        subprocess.run(["gcc", "-O2", "-shared", "-fPIC", source, "-o", library, "-ldl"], check=True)
        sys.exit(subprocess.run([sys.executable, *sys.argv], env={**os.environ, "LD_PRELOAD": str(library), MARK: "1"}).returncode)


class Glint:
    def __init__(self, vertices, faces):
        self.name = "glint"
        self.scene = glint.Scene(vertices, faces)

    def first(self, rays, coherent=False):
        return self.scene.cast(rays, coherent=coherent, dtype=np.float32)

    def first_t(self, rays, coherent=False):
        return self.scene.cast(rays, coherent=coherent, dtype=np.float32, want=("t",)).t

    def any(self, rays, coherent=False):
        return self.scene.occluded(rays, coherent=coherent)

    def count(self, rays, coherent=False):
        return self.scene.count(rays)

    def misses(self, rays):
        return ~np.isfinite(self.first_t(rays))

    def contains(self, points):
        return self.scene.contains(points)


class Open3d:
    def __init__(self, vertices, faces):
        self.name = "Open3D"
        self.scene = open3d.t.geometry.RaycastingScene()
        self.scene.add_triangles(open3d.core.Tensor(np.asarray(vertices, np.float32)), open3d.core.Tensor(np.asarray(faces, np.uint32)))

    def first(self, rays, coherent=False):
        return {key: value.numpy() for key, value in self.scene.cast_rays(open3d.core.Tensor.from_numpy(rays)).items()}

    first_t = first

    def any(self, rays, coherent=False):
        return self.scene.test_occlusions(open3d.core.Tensor.from_numpy(rays)).numpy()

    def count(self, rays, coherent=False):
        return self.scene.count_intersections(open3d.core.Tensor.from_numpy(rays)).numpy()

    def misses(self, rays):
        return ~np.isfinite(self.first(rays)["t_hit"])

    def contains(self, points):
        return self.scene.compute_occupancy(open3d.core.Tensor(np.asarray(points, np.float32))).numpy() > 0


class Trimesh:
    def __init__(self, vertices, faces):
        self.name = "trimesh"
        self.rays = trimesh.ray.ray_triangle.RayMeshIntersector(trimesh.Trimesh(vertices, faces, process=False))

    def _both(self, rays):
        rays = rays.reshape(-1, 6)
        return rays[:, :3], rays[:, 3:]

    def first(self, rays, coherent=False):
        return self.rays.intersects_first(*self._both(rays))

    first_t = first

    def any(self, rays, coherent=False):
        return self.rays.intersects_any(*self._both(rays))

    def count(self, rays, coherent=False):
        _, index_ray, _ = self.rays.intersects_location(*self._both(rays))
        return np.bincount(index_ray, minlength=len(rays.reshape(-1, 6)))

    def misses(self, rays):
        return self.first(rays) < 0

    def contains(self, points):
        return self.rays.contains_points(points)


# ---- rays ----

def camera_rays(eye, target, up, fov, size):
    eye, target, up = (np.array(v, float) for v in (eye, target, up))
    forward = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(forward, up)
    right /= np.linalg.norm(right)
    side = (np.arange(size) + 0.5) / size * 2 - 1
    x, y = np.meshgrid(side, -side)
    scale = np.tan(np.radians(fov) / 2)
    ways = forward + scale * (x[..., None] * right + y[..., None] * np.cross(right, forward))
    return np.concatenate([np.broadcast_to(eye, ways.shape), ways], axis=-1).astype(np.float32)


def random_rays(vertices, count):
    """From one point of the mesh's sphere to another."""
    random = np.random.default_rng(5)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    ends = random.normal(size=(2, count, 3))
    ends *= np.linalg.norm(high - low) / 2 / np.linalg.norm(ends, axis=-1, keepdims=True)
    return np.concatenate([(low + high) / 2 + ends[0], ends[1] - ends[0]], axis=-1).astype(np.float32)


# ---- rates ----

def once(call):
    wall, cpu = time.perf_counter(), time.process_time()
    call()
    return time.perf_counter() - wall, time.process_time() - cpu


def spread(values, form="{:.2f}"):
    """"median (lower to upper quartile)"."""
    low, middle, high = statistics.quantiles(values, n=4, method="inclusive") if len(values) > 1 else values * 3
    return f"{form.format(middle)} ({form.format(low)} to {form.format(high)})"


def compare(scene, kind, question, contenders, rays, coherent, repeat):
    count = rays.size // 6
    calls = [(c, lambda c=c: getattr(c, question)(rays, coherent)) for c in contenders]
    for _, call in calls:
        call()
    times = {c.name: [] for c in contenders}
    for turn in range(repeat):
        for c, call in calls if turn % 2 == 0 else calls[::-1]:
            times[c.name].append(once(call))
    rates = {name: [[count / t[i] / 1e6 for t in turns] for i in (0, 1)] for name, turns in times.items()}
    row = [scene, f"{kind}, {QUESTIONS[question]}"]
    for c in contenders:
        row += [spread(rates[c.name][0]), spread(rates[c.name][1])]
    if len(contenders) > 1:
        row += [spread([a / b for a, b in zip(rates[contenders[0].name][i], rates[contenders[1].name][i])]) for i in (0, 1)]
    return row


QUESTIONS = {"first": "nearest hit", "first_t": "t alone", "any": "any hit", "count": "count"}


def rates(options, kinds):
    rows, slow = [], []
    kinds = [k for k in kinds if k is not Trimesh]
    for name, (file, eye, target, up, fov, _) in compare_povray.MESHES.items():
        path = options.assets / "meshes" / file
        if not path.exists():
            print(f"{name}: {path} is missing, left out", file=sys.stderr)
            continue
        mesh = compare_povray.meshes.read(path)
        vertices, faces = np.array(mesh.vertices), np.array([face[0] for face in mesh.faces])
        contenders = [kind(vertices, faces) for kind in kinds]
        pictures, scattered = camera_rays(eye, target, up, fov, options.size), random_rays(vertices, options.size**2)
        for kind, rays in (("camera", pictures), ("random", scattered)):
            for question in QUESTIONS:
                rows.append(compare(name, kind, question, contenders, rays, kind == "camera", options.repeat))
                print(*rows[-1], sep=" | ", file=sys.stderr)
        if "trimesh" in globals() and name == "bunny":
            few = scattered[:200]
            turns = [len(few) / once(lambda: contender.first(few))[0] for contender in [Trimesh(vertices, faces)] for _ in range(options.repeat)]
            slow.append(f"trimesh, {name}, random, nearest hit (200 rays): {spread(turns, '{:.0f}')} rays a second\n")
    header = ["scene", "rays"]
    for kind in kinds:
        header += [f"{kind.__name__.lower()}, M/s", "a processor"]
    if len(kinds) > 1:
        header += [f"{kinds[0].__name__.lower()} / {kinds[1].__name__.lower()}", "a processor"]
    return measure.table(header, rows) + "\n" + "\n".join(slow)


# ---- answers ----

def bumpy_sphere(rings=16):
    """Closed, 2 (rings - 1) * 2 rings triangles, radii between 0.8 and 1.2."""
    turns = 2 * rings
    ring, turn = np.meshgrid(np.arange(1, rings), np.arange(turns), indexing="ij")
    polar, around = ring * np.pi / rings, turn * 2 * np.pi / turns
    radius = 1 + 0.2 * np.sin(5 * polar) * np.cos(3 * around)
    middle = radius[..., None] * np.stack([np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar)], axis=-1)
    vertices = np.vstack([middle.reshape(-1, 3), [[0, 0, 1], [0, 0, -1]]])
    at = lambda r, t: (r - 1) * turns + t % turns
    north, south = len(vertices) - 2, len(vertices) - 1
    faces = [[north, at(1, t), at(1, t + 1)] for t in range(turns)] + [[south, at(rings - 1, t + 1), at(rings - 1, t)] for t in range(turns)]
    for r in range(1, rings - 1):
        for t in range(turns):
            faces += [[at(r, t), at(r + 1, t), at(r + 1, t + 1)], [at(r, t), at(r + 1, t + 1), at(r, t + 1)]]
    return vertices.astype(np.float32), np.array(faces)


def grid_cube(n=16):
    """A cube from -1 to 1 of 12 n^2 triangles; binary fractions, so that rays along the axes meet vertices and edges exactly."""
    sides, faces, numbers = np.linspace(-1, 1, n + 1), [], {}
    number = lambda p: numbers.setdefault(p, len(numbers))
    for axis in range(3):
        for end in (-1.0, 1.0):
            for i in range(n):
                for j in range(n):
                    corners = []
                    for u, v in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)):
                        p = [0.0, 0.0, 0.0]
                        p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3] = end, sides[u], sides[v]
                        corners.append(number(tuple(p)))
                    a, b, c, d = corners if end > 0 else corners[::-1]
                    faces += [[a, b, c], [a, c, d]]
    return np.array(list(numbers), np.float32), np.array(faces)


def aimed(vertices, faces, count, inside):
    """Rays at vertices and at points of edges."""
    random = np.random.default_rng(11)
    face = faces[random.integers(0, len(faces), count)]
    a, b = vertices[face[:, 0]].astype(float), vertices[face[:, 1]].astype(float)
    share = random.choice([0, 0.5, 0.25, random.uniform()], count)[:, None]
    targets = a + share * (b - a)
    origins = random.normal(size=(count, 3))
    origins *= (random.uniform(0, 0.4, (count, 1)) if inside else 3) / np.linalg.norm(origins, axis=1)[:, None]
    return np.concatenate([origins, targets - origins], axis=1).astype(np.float32)


def answers(options, kinds):
    rows = []
    count = 2000 if options.quick else 200_000
    for name, (vertices, faces) in {"bumpy sphere": bumpy_sphere(), "cube": grid_cube()}.items():
        edges = np.sort(np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
        assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all(), "the mesh is not closed"
        inner, outer = aimed(vertices, faces, count, True), aimed(vertices, faces, count, False)
        grid = np.arange(-15, 16) / 16
        points = np.stack(np.meshgrid(grid, grid, grid), axis=-1).reshape(-1, 3)
        truth = np.ones(len(points), bool)
        if name == "bumpy sphere":  # surely in, or surely out
            distance = np.linalg.norm(points, axis=1)
            points = points[(distance < 0.75) | (distance > 1.25)]
            truth = np.linalg.norm(points, axis=1) < 1
        for kind in kinds:
            tracer = kind(vertices, faces)
            share = 100 if kind is Trimesh else 1
            part_in, part_out = inner[:: share], outer[:: share]
            missed = np.count_nonzero(tracer.misses(part_in))
            odd = np.count_nonzero(np.asarray(tracer.count(part_in)).ravel() % 2 != 1)
            even = np.count_nonzero(np.asarray(tracer.count(part_out)).ravel() % 2 != 0)
            wrong = np.count_nonzero(np.asarray(tracer.contains(points)).ravel() != truth)
            of = lambda bad, all_of: f"{bad:,} of {all_of:,}" if bad == 0 else f"**{bad:,}** of {all_of:,}"
            rows.append([name, tracer.name, of(missed, len(part_in)), of(odd, len(part_in)), of(even, len(part_out)), of(wrong, len(points))])
            print(f"{name}, {tracer.name}: done", file=sys.stderr)
    return measure.table(["mesh", "", "missed from inside", "count from inside is even", "count from outside is odd", "points told wrong"], rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--repeat", type=int, default=9)
    parser.add_argument("--size", type=int, default=1024, help="of the camera's picture; as many random rays")
    parser.add_argument("--assets", type=pathlib.Path, default=measure.ROOT / "../shared/assets")
    parser.add_argument("--only", choices=["answers", "rates"])
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    if options.quick:
        options.repeat, options.size = 2, 64
    kinds = [Glint] + [kind for kind, module in ((Open3d, "open3d"), (Trimesh, "trimesh")) if module in globals()]
    load = os.getloadavg()
    text = f"{glint.Device().info['name']}, {len(os.sched_getaffinity(0))} processors, load average {load[0]:.1f} at the beginning and "
    results = {}
    if options.only != "rates":
        results["python_peers_answers"] = answers(options, kinds)
    if options.only != "answers":
        results["python_peers"] = rates(options, kinds)
    text += f"{os.getloadavg()[0]:.1f} at the end" + "".join(
        f"; {m.__name__} {m.__version__}" for m in map(globals().get, ("open3d", "trimesh")) if getattr(m, "__version__", None))
    for name, result in results.items():
        print(result + "\n" + text + ".\n")


if __name__ == "__main__":
    unmasked()
    import glint
    try:
        import open3d
    except ImportError:
        print("Open3D is left out: Debian package python3-open3d", file=sys.stderr)
    try:
        import trimesh
    except ImportError:
        print("trimesh is left out: not found", file=sys.stderr)
    main()
