#!/usr/bin/env python3
"""Catalogue of coincident, nearly coincident, adjacent and nested surfaces: device against reference.

    catalogue.py GLINT [--count N] [--first N] [--keep FOLDER] [-v]

Each case is a scene of four stations in one plane. A station is a pair of surfaces: kinds, relation, windings, materials and,
for glass, a body that stands on the other surface. The case draws the extent (1e-3 to 1e6), the plane's distance from the
origin (0 to 10 extents), its tilt, the light and the order of the objects. Both backends render it; a pixel counts as wrong if
they differ by more than 1/100 where the reference is smooth (its 3 x 3 neighbours agree), that is, away from outlines.

Exit status 1 if any case has more than one wrong pixel in 1,000. A case is a function of its number alone.
"""
import argparse
import collections
import json
import math
import os
import random
import struct
import subprocess
import sys
import tempfile

WIDTH, HEIGHT = 64, 48
FLATS = ["triangle", "polygon", "disc", "box", "mesh", "instance", "plane"]
RELATIONS = ["same", "reversed", "rotated", "inside", "beside", "apart"]
EXTENTS = [1e-3, 1.0, 1.0, 1.0, 1e3, 1e6]
HEIGHTS = [0, 0, 0, 1e-3, 0.02, 0.05, 0.25, 1, 10]  # of the plane, in extents
BODIES = ["box", "cylinder"]


def frame_of(rng):
    """Rows: two directions in the plane and its normal."""
    kind = rng.choice(["x", "y", "z", "tilted", "slight"])
    if kind == "x":
        return [(0, 1, 0), (0, 0, 1), (1, 0, 0)]
    if kind == "y":
        return [(0, 0, 1), (1, 0, 0), (0, 1, 0)]
    if kind == "z":
        return [(1, 0, 0), (0, 1, 0), (0, 0, 1)]
    scale = 1.0 if kind == "tilted" else 1e-3
    a, b, c = (rng.uniform(-scale, scale) for _ in range(3))
    ca, sa, cb, sb, cc, sc = math.cos(a), math.sin(a), math.cos(b), math.sin(b), math.cos(c), math.sin(c)
    return [(cb * cc, cb * sc, -sb), (sa * sb * cc - ca * sc, sa * sb * sc + ca * cc, sa * cb),
            (ca * sb * cc + sa * sc, ca * sb * sc - sa * cc, ca * cb)]


class Case:
    def __init__(self, number):
        self.number = number
        self.rng = rng = random.Random(number)
        self.extent = rng.choice(EXTENTS)
        self.height = rng.choice(HEIGHTS)
        self.axes = frame_of(rng)
        self.aligned = all(abs(c) in (0, 1) for row in self.axes for c in row)
        self.objects = []
        self.names = []
        self.has_plane = False
        for station in range(4):
            self.station(station % 2 * 3.0 - 1.5, station // 2 * 3.0 - 1.5)
        if rng.random() < 0.5:
            self.objects.reverse()

    def at(self, u, v, w=0.0):
        """A point of the plane's frame, in extents, as it is in the scene."""
        h = self.height + w
        return [self.extent * (u * a + v * b + h * c) for a, b, c in zip(*self.axes)]

    def vector(self, u, v, w):
        return [u * a + v * b + w * c for a, b, c in zip(*self.axes)]

    def flat(self, kind, u, v, size, w, turn, flip, material):
        """A flat surface around (u, v): `size` to each side, its corners from number `turn` on, wound backwards for flip."""
        corners = [(u - size, v - size), (u + size, v - size), (u + size, v + size), (u - size, v + size)]
        corners = corners[turn:] + corners[:turn]
        if flip:
            corners.reverse()
        points = [self.at(x, y, w) for x, y in corners]
        if kind == "plane":
            if self.has_plane:
                kind = "polygon"
            self.has_plane = True
        if kind == "box" and not self.aligned:
            kind = "polygon"
        if kind == "plane":
            self.objects.append({"type": "plane", "point": self.at(u, v, w), "normal": self.vector(0, 0, 1), "material": material})
        elif kind == "polygon":
            self.objects.append({"type": "polygon", "vertices": points, "material": material})
        elif kind == "disc":
            self.objects.append({"type": "disc", "center": self.at(u, v, w), "normal": self.vector(0, 0, -1 if flip else 1), "radius": size * self.extent, "material": material})
        elif kind == "box":
            self.box(u, v, size, w - 0.3, w, material)
        else:
            for tri in ([0, 1, 2], [0, 2, 3]):
                tri = tri[turn % 3:] + tri[:turn % 3]
                t = {"type": "triangle", "vertices": [points[i] for i in tri], "material": material}
                if kind == "instance":
                    # A shape of its own size at the origin, moved to where it belongs.
                    place = self.at(u, v, w)
                    t["vertices"] = [[(points[i][k] - place[k]) / self.extent for k in range(3)] for i in tri]
                    t["transform"] = [{"scale": self.extent}, {"translate": place}]
                self.objects.append(t)

    def box(self, u, v, size, lower, upper, material):
        a, b = self.at(u - size, v - size, lower), self.at(u + size, v + size, upper)
        self.objects.append({"type": "box", "min": [min(x, y) for x, y in zip(a, b)], "max": [max(x, y) for x, y in zip(a, b)], "material": material})

    def body(self, kind, u, v, size, material):
        """A body that stands on the plane."""
        if kind == "box" and self.aligned:
            self.box(u, v, size, 0, 1.2 * size, material)
        else:
            self.objects.append({"type": "cylinder", "base": self.at(u, v), "top": self.at(u, v, 1.2 * size), "radius": size * self.extent, "capped": True, "material": material})

    def station(self, u, v):
        rng = self.rng
        first, second = rng.choice(FLATS), rng.choice(FLATS)
        relation = rng.choice(RELATIONS)
        material = rng.choice(["red", "red", "shiny", "mirror"])
        glass = rng.random() < 0.3
        self.flat(first, u, v, 1, 0, 0, False, rng.choice(["white", "white", "checker"]))
        if glass:
            body = rng.choice(BODIES)
            self.body(body, u, v, 0.6, "glass")
            self.names.append((first, body, "glass on"))
            return
        size = 0.6 if relation in ("inside", "apart") else 1
        shift = 2.0 if relation == "beside" else 0
        gap = 0
        if relation == "apart":
            # 64 u of the greatest coordinate: well beyond the bound, and far below a pixel.
            gap = 64 * 2.0**-24 * max(10 * 1.0, self.height + 4)
        turn = rng.randrange(1, 4) if relation == "rotated" else 0
        flip = relation == "reversed"
        if second == "plane" and relation == "apart":
            second = "polygon"
        self.flat(second, u + shift, v, size, gap, turn, flip, material)
        self.names.append((first, second, relation))

    def scene(self):
        rng = self.rng
        toward = self.vector(rng.uniform(-0.6, 0.6), rng.uniform(-0.6, 0.6), 1)
        if rng.random() < 0.5:
            light = {"type": "directional", "direction": [-c for c in toward]}
        else:
            # The target's plane is at height 0 of the frame.
            base = self.at(0, 0)
            light = {"type": "point", "position": [b + 20 * self.extent * c for b, c in zip(base, toward)]}
        eye = [b + self.extent * c for b, c in zip(self.at(0, 0), self.vector(rng.uniform(-5, 5), rng.uniform(-5, 5), rng.uniform(4, 9)))]
        return {
            "image": {"width": WIDTH, "height": HEIGHT},
            "camera": {"eye": eye, "target": self.at(0, 0), "up": self.vector(0, 1, 0), "fovY": 55},
            "ambient": 0.2, "background": [0.4, 0.5, 0.7], "maxDepth": 6, "lights": [light],
            "materials": {"white": {"diffuse": 0.75}, "red": {"diffuse": [0.8, 0.15, 0.1]}, "checker": {"diffuse": [0.2, 0.6, 0.3]},
                          "shiny": {"diffuse": [0.2, 0.2, 0.7], "specular": 0.4, "shininess": 20},
                          "mirror": {"diffuse": 0.1, "mirror": 0.7}, "glass": {"transmission": 0.95, "ior": 1.5}},
            "objects": self.objects}


def read_pfm(path):
    with open(path, "rb") as file:
        assert file.readline().strip() == b"PF"
        width, height = map(int, file.readline().split())
        file.readline()
        values = struct.unpack("<%df" % (3 * width * height), file.read())
    return [values[3 * i:3 * i + 3] for i in range(width * height)]


def differs(a, b):
    return any(not abs(x - y) <= 0.01 for x, y in zip(a, b))


def wrong_pixels(device, truth):
    wrong = []
    for y in range(1, HEIGHT - 1):
        for x in range(1, WIDTH - 1):
            i = y * WIDTH + x
            if not differs(device[i], truth[i]):
                continue
            around = [truth[i + dy * WIDTH + dx] for dy in (-1, 0, 1) for dx in (-1, 0, 1)]
            if not any(differs(truth[i], other) for other in around):
                wrong.append((x, y))
    return wrong


def run(glint, case, folder, options=()):
    path = os.path.join(folder, "case%d.json" % case.number)
    with open(path, "w") as file:
        json.dump(case.scene(), file)
    images = []
    for backend in ("gpu", "cpu"):
        out = os.path.join(folder, "case%d.%s.pfm" % (case.number, backend))
        extra = list(options) if backend == "gpu" else []
        done = subprocess.run([glint, "render", path, "-q", "--backend", backend, "-o", out] + extra, capture_output=True, text=True)
        if done.returncode != 0:
            raise RuntimeError("case %d: %s" % (case.number, done.stderr))
        images.append(read_pfm(out))
    return wrong_pixels(*images)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("glint")
    parser.add_argument("--count", type=int, default=25, help="cases, each of four pairs (default 25)")
    parser.add_argument("--first", type=int, default=0, help="number of the first case (default 0)")
    parser.add_argument("--keep", help="folder for scenes and images")
    parser.add_argument("--traversal", help="as glint render's option")
    parser.add_argument("-v", action="store_true", help="print each wrong case")
    arguments = parser.parse_args()
    options = ["--traversal", arguments.traversal] if arguments.traversal else []
    failed, total, pixels = [], 0, collections.Counter()
    with tempfile.TemporaryDirectory() as temporary:
        folder = arguments.keep or temporary
        os.makedirs(folder, exist_ok=True)
        for number in range(arguments.first, arguments.first + arguments.count):
            case = Case(number)
            wrong = run(arguments.glint, case, folder, options)
            total += 1
            if len(wrong) > WIDTH * HEIGHT // 1000:
                failed.append(number)
                pixels[number] = len(wrong)
                if arguments.v:
                    print("case %d: %d wrong pixels, extent %g, height %g, %s; first %s" % (number, len(wrong), case.extent, case.height, case.names, wrong[0]), flush=True)
    print("%d cases of 4 pairs: %d wrong, %d wrong pixels" % (total, len(failed), sum(pixels.values())))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
