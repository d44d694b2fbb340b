#!/usr/bin/env python3
"""Measures how time grows with triangles, pixels, lights, depth and threads, and fits an exponent to each.

    bench/scaling.py [--images FOLDER] [--quick]

Runs `glint bench` on scenes it makes itself and prints a table in Markdown. With --images FOLDER it writes a
diagram scaling-NAME.svg for each curve. It takes about five minutes on two idle cores; --quick takes one.
"""
import array
import json
import math
import os
import pathlib
import random
import sys
import tempfile

import measure

REPEAT = "3"


def terrain(path, triangles):
    """Hills on a square grid, as a binary PLY: x and z from -1 to 1, y up."""
    n = max(2, round(math.sqrt(triangles / 2)))
    side = [2 * i / n - 1 for i in range(n + 1)]
    dice = random.Random(7)
    waves = [(0.25 / f, f, dice.random() * 6, dice.random() * 6) for f in (2.1, 4.7, 9.3, 19, 41)]
    tables = [[math.sin(math.pi * f * s + p) for s in side] for _, f, p, _ in waves]
    vertices = array.array("f", bytes(12 * (n + 1) ** 2))
    row = 3 * (n + 1)
    for j, z in enumerate(side):
        weights = [a * math.cos(math.pi * f * z + q) for a, f, _, q in waves]
        heights = [sum(w * s for w, s in zip(weights, column)) for column in zip(*tables)] if n < 400 else fast_row(weights, tables)
        vertices[j * row : (j + 1) * row : 3] = array.array("f", side)
        vertices[j * row + 1 : (j + 1) * row : 3] = array.array("f", heights)
        vertices[j * row + 2 : (j + 1) * row : 3] = array.array("f", [z]) * (n + 1)
    faces = 2 * n * n
    with open(path, "wb") as file:
        file.write((f"ply\nformat binary_little_endian 1.0\nelement vertex {(n + 1) ** 2}\nproperty float x\nproperty float y\nproperty float z\n"
                    f"element face {faces}\nproperty list int int vertex_indices\nend_header\n").encode())
        vertices.tofile(file)
        strip = array.array("i", bytes(32 * n))
        for j in range(n):
            at = lambda first: array.array("i", range(first, first + n))
            upper, lower = j * (n + 1), (j + 1) * (n + 1)
            for k, column in enumerate([None, at(upper), at(lower), at(upper + 1), None, at(upper + 1), at(lower), at(lower + 1)]):
                strip[k::8] = column if column else array.array("i", [3]) * n
            strip.tofile(file)
    return faces


def fast_row(weights, tables):
    a, b, c, d, e = weights
    return [a * p + b * q + c * r + d * s + e * t for p, q, r, s, t in zip(*tables)]


def terrain_scene(folder, name, mesh, lights=1):
    """One mesh in grey, seen from above its rim; lights on a ring."""
    ring = [[3 * math.cos(2.4 * i + 0.6), 3, 3 * math.sin(2.4 * i + 0.6)] for i in range(lights)]
    path = folder / f"{name}.json"
    path.write_text(json.dumps({
        "image": {"width": 512, "height": 512}, "camera": {"eye": [1.6, 1.7, 2.1], "target": [0, -0.1, 0], "fovY": 42},
        "background": [0.3, 0.45, 0.7], "ambient": 0.15, "maxDepth": 0,
        "lights": [{"type": "point", "position": p, "intensity": 0.8 / lights} for p in ring],
        "materials": {"grey": {"diffuse": [0.6, 0.55, 0.45]}}, "meshes": {"m": {"file": mesh.name}},
        "objects": [{"type": "mesh", "mesh": "m", "material": "grey"}]}))
    return path


class Curves:
    def __init__(self, images):
        self.images, self.rows, self.last = images, [], None

    def add(self, name, title, x_name, points, series, y_name="seconds"):
        """points: (x, what bench says); series: (curve's name, value from it)."""
        curves = []
        for label, value in series:
            spots = [(x, value(r)) for x, r in points if value(r) > 0]
            k, _ = measure.fit(spots)
            curves.append((label, spots, k))
            first, last = spots[0], spots[-1]
            # Rates per second are told as such in the table.
            self.rows.append([x_name, label, f"{measure.number(first[0])} .. {measure.number(last[0])}", measure.seconds(first[1]) if y_name == "seconds" else
                              measure.number(first[1]), measure.seconds(last[1]) if y_name == "seconds" else measure.number(last[1]), f"{k:.2f}"])
        if self.images:
            measure.diagram(self.images / f"scaling-{name}.svg", title, x_name, y_name, curves)
        self.last = points[-1][1]
        print(f"{name} done", file=sys.stderr)


def per_ray(kind):
    return lambda r: r["rays"][kind]["seconds"]["median"] / r["rays"][kind]["number"] * 1e9


def median(*keys):
    def value(r):
        for key in keys:
            r = r[key]
        return r["median"] if isinstance(r, dict) else r
    return value


def main():
    parser = measure.arguments(__doc__)
    parser.add_argument("--images", type=pathlib.Path, help="folder for the diagrams")
    options = parser.parse_args()
    bench = lambda *more, **how: measure.bench(options.glint, "--repeat", REPEAT, *map(str, more), **how)
    curves = Curves(options.images)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        points = []
        for power in range(3, 6 if options.quick else 8):
            mesh = folder / "terrain.ply"
            count = terrain(mesh, 10**power)
            points.append((count, bench(terrain_scene(folder, "terrain", mesh))))
        curves.add("triangles", "Time against triangles, 512 x 512", "triangles", points,
                   [("load the file", median("seconds", "load")), ("build the tree", median("seconds", "build")),
                    ("pack", median("seconds", "pack")), ("upload", median("seconds", "upload")), ("trace", median("seconds", "trace"))])
        curves.add("tests", "A ray against triangles", "triangles", points,
                   [("tests a primary ray", median("rays", "primary", "testsPerRay")),
                    ("tests a shadow ray", median("rays", "shadow", "testsPerRay")),
                    ("ns a primary ray", per_ray("primary")), ("ns a shadow ray", per_ray("shadow"))], "tests, nanoseconds")
        mesh = folder / "hills.ply"
        terrain(mesh, 10**4 if options.quick else 10**5)
        scene = terrain_scene(folder, "hills", mesh)
        sides = [64, 128, 256] if options.quick else [64, 128, 256, 512, 1024, 2048]
        parts = [("primary rays", median("rays", "primary", "seconds")), ("shadow rays", median("rays", "shadow", "seconds")),
                 ("trace, all", median("seconds", "trace"))]
        curves.add("resolution", "Time against pixels, 100 k triangles", "pixels", [(s * s, bench(scene, "--size", f"{s}x{s}")) for s in sides], parts)
        lights = [1, 2, 4] if options.quick else [1, 2, 4, 8, 16, 32]
        curves.add("lights", "Time against lights, 256 x 256", "lights",
                   [(n, bench(terrain_scene(folder, f"lights{n}", mesh, n), "--size", "256x256")) for n in lights], parts[1:])
        corridor = measure.ROOT / "scenes/corridor.json"
        depths = [1, 2, 4] if options.quick else [1, 2, 4, 8, 16, 32, 64]
        curves.add("depth", "Time against depth between two mirrors, 320 x 240", "depth",
                   [(d, bench(corridor, "--size", "320x240", "--max-depth", d)) for d in depths],
                   [("mirrored rays", median("rays", "mirrored", "seconds")), ("shadow rays", median("rays", "shadow", "seconds")),
                    ("trace, all", median("seconds", "trace"))])
        threads = [n for n in (1, 2, 4, 8, 16, 32) if n <= (os.cpu_count() or 1)]
        curves.add("threads", "Time against threads (LP_NUM_THREADS)", "threads",
                   [(n, bench(scene, "--size", "512x512", environment={"LP_NUM_THREADS": str(n)})) for n in threads], parts)
    text = measure.table(["against", "time of", "from .. to", "first", "last", "exponent"], curves.rows)
    print(measure.machine(curves.last) + ":\n\n" + text)


if __name__ == "__main__":
    main()
