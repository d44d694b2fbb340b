#!/usr/bin/env python3
"""Catalogue of coincident, nearly coincident, adjacent and nested surfaces: device against reference and exact arithmetic.

    catalogue.py GLINT [--count N] [--first N] [--grid N] [--exact N] [--keep FOLDER] [-v]

Each case is a scene of grid x grid stations in one plane. A station is a pair of flat surfaces (kinds, relation, windings,
materials), a glass body that stands on a flat surface, or a round body that is doubled (by the same or by other numbers), nested,
or touches a flat surface. The case draws the extent (1e-3 to 1e6), the plane's distance from the origin (0 to 10 extents), its tilt, the light and the order
of the objects. Both backends render it; a pixel counts as wrong if they differ by more than 1/100 where the reference is smooth
(its 3 x 3 neighbours agree), that is, away from outlines. In some of these pixels the object hit is also compared with the one
that rational arithmetic finds (exact.py).

Exit status 1 if any case has more than three wrong pixels, or a wrong object. A case is a function of its number and the grid.
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

import exact

FLATS = ["triangle", "polygon", "disc", "box", "mesh", "sheet", "ellipse", "plane"]
RELATIONS = ["same", "reversed", "rotated", "inside", "beside", "apart"]
EXTENTS = [1e-3, 1.0, 1.0, 1.0, 1e3, 1e6]
HEIGHTS = [0, 0, 0, 1e-3, 0.02, 0.05, 0.25, 1, 10]  # of the plane, in extents
BODIES = ["box", "cylinder", "cone"]
ROUNDS = ["sphere", "ellipsoid", "cylinder", "cone", "paraboloid"]
ROUND_RELATIONS = ["doubled", "restored", "nested", "resting", "sunk"]
SHEET_CELLS = 64  # along a side: with fewer triangles the host would not store the sheet once for all its instances


def frame_of(rng):
    """Rows: two directions in the plane and its normal."""
    kind = rng.choice(["x", "y", "z", "tilted", "slight"])
    if kind in "xyz":
        units, next_one = [(1, 0, 0), (0, 1, 0), (0, 0, 1)], "xyz".index(kind) + 1
        return units[next_one:] + units[:next_one]
    scale = 1.0 if kind == "tilted" else 1e-3
    a, b, c = (rng.uniform(-scale, scale) for _ in range(3))
    ca, sa, cb, sb, cc, sc = math.cos(a), math.sin(a), math.cos(b), math.sin(b), math.cos(c), math.sin(c)
    return [(cb * cc, cb * sc, -sb), (sa * sb * cc - ca * sc, sa * sb * sc + ca * cc, sa * cb),
            (ca * sb * cc + sa * sc, ca * sb * sc - sa * cc, ca * cb)]


class Case:
    def __init__(self, number, grid):
        self.number = number
        self.grid = grid
        self.width, self.height_in_pixels = 32 * grid, 24 * grid
        self.rng = rng = random.Random(number)
        self.extent = rng.choice(EXTENTS)
        self.height = rng.choice(HEIGHTS)
        self.axes = frame_of(rng)
        self.aligned = all(abs(c) in (0, 1) for row in self.axes for c in row)
        self.has_sheet = rng.random() < 0.2
        self.has_plane = False
        # 64 u of the greatest coordinate: well beyond the bound of the rule, and far below a pixel.
        self.gap = 64 * 2.0**-24 * (self.height + 4 + 3 * grid)
        self.objects = []
        self.names = []
        self.centers = []
        for i in range(grid * grid):
            self.station((i % grid - (grid - 1) / 2) * 3.0, (i // grid - (grid - 1) / 2) * 3.0)
        if rng.random() < 0.5:
            self.objects.reverse()
        self.scene = self.make_scene()

    def at(self, u, v, w=0.0):
        """A point of the plane's frame, in extents, as it is in the scene."""
        h = self.height + w
        return [self.extent * (u * a + v * b + h * c) for a, b, c in zip(*self.axes)]

    def vector(self, u, v, w):
        return [u * a + v * b + w * c for a, b, c in zip(*self.axes)]

    def matrix(self, place, scales):
        """From the frame's axes, scaled, to the scene."""
        rows = []
        for k in range(3):
            rows += [self.extent * s * axis[k] for s, axis in zip(scales, self.axes)] + [place[k]]
        return rows + [0, 0, 0, 1]

    def add(self, material, **properties):
        self.objects.append(dict(properties, material=material))

    def flat(self, kind, u, v, size, w, turn, flip, material):
        """A flat surface around (u, v): `size` to each side, its corners from number `turn` on, wound backwards for flip."""
        corners = [(u - size, v - size), (u + size, v - size), (u + size, v + size), (u - size, v + size)]
        corners = corners[turn:] + corners[:turn]
        if flip:
            corners.reverse()
        points = [self.at(x, y, w) for x, y in corners]
        if kind == "plane" and self.has_plane:
            kind = "polygon"
        if kind == "plane":
            self.has_plane = True
            self.add(material, type="plane", point=self.at(u, v, w), normal=self.vector(0, 0, 1))
        elif kind == "polygon":
            self.add(material, type="polygon", vertices=points)
        elif kind == "disc":
            self.add(material, type="disc", center=self.at(u, v, w), normal=self.vector(0, 0, -1 if flip else 1), radius=size * self.extent)
        elif kind == "ellipse":
            self.add(material, type="disc", center=[0, 0, 0], normal=[0, 0, -1 if flip else 1], radius=1,
                     transform=self.matrix(self.at(u, v, w), (size, 0.75 * size, 1)))
        elif kind == "box":
            self.box(u, v, size, w - 0.3, w, material)
        elif kind == "sheet" and self.has_sheet:
            self.add(material, type="mesh", mesh="sheet", transform=self.matrix(self.at(u, v, w), (size, -size if flip else size, 1)))
        else:
            for tri in ([0, 1, 2], [0, 2, 3])[:1 if kind == "triangle" else 2]:
                tri = tri[turn % 3:] + tri[:turn % 3]
                self.add(material, type="triangle", vertices=[points[i] for i in tri])

    def box(self, u, v, size, lower, upper, material):
        if self.aligned:
            a, b = self.at(u - size, v - size, lower), self.at(u + size, v + size, upper)
            self.add(material, type="box", min=[min(x, y) for x, y in zip(a, b)], max=[max(x, y) for x, y in zip(a, b)])
        else:
            self.add(material, type="box", min=[-1, -1, lower - upper], max=[1, 1, 0], transform=self.matrix(self.at(u, v, upper), (size, size, 1)))

    def body(self, kind, u, v, size, material):
        """A body that stands on the plane."""
        if kind == "box":
            self.box(u, v, size, 0, 1.2 * size, material)
        elif kind == "cylinder":
            self.add(material, type="cylinder", base=self.at(u, v), top=self.at(u, v, 1.2 * size), radius=size * self.extent, capped=True)
        else:
            self.add(material, type="cone", base=self.at(u, v), apex=self.at(u, v, 1.2 * size), radius=size * self.extent,
                     topRadius=0.5 * size * self.extent, capped=True)

    def round(self, kind, u, v, w, radius, material):
        """A round body whose middle is at the height w; cylinders and cones lie or stand as far as that touches the plane."""
        r = radius * self.extent
        if kind == "sphere":
            self.add(material, type="sphere", center=self.at(u, v, w), radius=r)
        elif kind == "ellipsoid":
            self.add(material, type="ellipsoid", center=self.at(u, v, w), radii=[0.8 * r, r, 0.9 * r])
        elif kind == "cylinder":
            self.add(material, type="cylinder", base=self.at(u - 0.8, v, w), top=self.at(u + 0.8, v, w), radius=r, capped=True)
        elif kind == "cone":
            self.add(material, type="cone", base=self.at(u, v, w - radius), apex=self.at(u, v, w + radius), radius=r, capped=True)
        else:
            self.add(material, type="paraboloid", vertex=self.at(u, v, w - radius), top=self.at(u, v, w + radius), radius=r)

    def quadric(self, center, radii, material):
        """An ellipsoid as an equation, measured from another point: the middle of its bounds."""
        squares = [1 / r**2 for r in radii]
        constant = sum(a * c * c for a, c in zip(squares, center)) - 1
        coefficients = squares + [0, 0, 0] + [-2 * a * c for a, c in zip(squares, center)] + [constant]
        bounds = [[c + side * r for c, r in zip(center, radii)] for side in (-1.3, 1.1)]
        self.add(material, type="quadric", coefficients=coefficients, bounds=bounds)

    def restored(self, kind, u, v, w, radius, material):
        """The surface of round(), or a part of it, from other numbers."""
        rng, r = self.rng, radius * self.extent
        center = self.at(u, v, w)
        if kind == "sphere":
            form = rng.choice(["sphere", "ellipsoid", "quadric", "transform"])
            if form == "sphere":  # as far as fp32 rounds
                center = [c * (1 + rng.uniform(-1, 1) * 2.0**-24) for c in center]
                self.add(material, type="sphere", center=center, radius=r * (1 + rng.uniform(-1, 1) * 2.0**-24))
            elif form == "ellipsoid":
                self.add(material, type="ellipsoid", center=center, radii=[r, r, r])
            elif form == "quadric":
                self.quadric(center, [r, r, r], material)
            else:
                self.add(material, type="ellipsoid", center=[0, 0, 0], radii=[2, 1, 0.5],
                         transform=self.matrix(center, (radius / 2, radius, 2 * radius)))
        elif kind == "ellipsoid":
            self.quadric(center, [0.8 * r, r, 0.9 * r], material)
        elif kind == "cylinder":
            self.add(material, type="cylinder", base=self.at(u + 0.8, v, w), top=self.at(u - rng.choice([0.3, 1.1]), v, w), radius=r, capped=True)
        elif kind == "cone":
            low, high = rng.choice([(0, 0.5), (0.1, 0.7), (0.5, 0.6)])
            self.add(material, type="cone", base=self.at(u, v, w + (2 * low - 1) * radius), apex=self.at(u, v, w + (2 * high - 1) * radius),
                     radius=(1 - low) * r, topRadius=(1 - high) * r, capped=True)
        else:
            part = rng.choice([0.25, 1.21])
            self.add(material, type="paraboloid", vertex=self.at(u, v, w - radius), top=self.at(u, v, w + (2 * part - 1) * radius),
                     radius=math.sqrt(part) * r)

    def station(self, u, v):
        rng = self.rng
        self.centers.append(self.at(u, v))
        choice = rng.random()
        material = rng.choice(["red", "red", "shiny", "mirror"])
        first = rng.choice(FLATS)
        ground = rng.choice(["white", "white", "green"])
        if choice < 0.25:
            self.flat(first, u, v, 1, 0, 0, False, ground)
            body = rng.choice(BODIES)
            self.body(body, u, v, 0.6, "glass")
            self.names.append((first, body, "glass on"))
            return
        if choice < 0.5:
            kind, relation = rng.choice(ROUNDS), rng.choice(ROUND_RELATIONS)
            material = rng.choice([material, "glass"])
            if relation in ("resting", "sunk"):
                self.flat(first, u, v, 1, 0, 0, False, ground)
                self.round(kind, u, v, 0 if relation == "sunk" else 0.7, 0.7, material)
            else:
                self.round(kind, u, v, 0.8, 0.7, ground)
                if relation == "restored":
                    self.restored(kind, u, v, 0.8, 0.7, material)
                else:
                    self.round(kind, u, v, 0.8, 0.7 if relation == "doubled" else 0.7 * (1 + 2.0**-10), material)
                first = "-"
            self.names.append((first, kind, relation))
            return
        second, relation = rng.choice(FLATS), rng.choice(RELATIONS)
        self.flat(first, u, v, 1, 0, 0, False, ground)
        size = 0.6 if relation in ("inside", "apart") else 1
        shift = 2.0 if relation == "beside" else 0
        turn = rng.randrange(1, 4) if relation == "rotated" else 0
        if second == "plane" and relation == "apart":
            second = "polygon"
        self.flat(second, u + shift, v, size, self.gap if relation == "apart" else 0, turn, relation == "reversed", material)
        self.names.append((first, second, relation))

    def make_scene(self):
        rng = self.rng
        toward = self.vector(rng.uniform(-0.6, 0.6), rng.uniform(-0.6, 0.6), 1)
        far = self.grid / 2 * self.extent
        base = self.at(0, 0)
        if rng.random() < 0.5:
            light = {"type": "directional", "direction": [-c for c in toward]}
        else:
            light = {"type": "point", "position": [b + 20 * far * c for b, c in zip(base, toward)]}
        eye = [b + far * c for b, c in zip(base, self.vector(rng.uniform(-5, 5), rng.uniform(-5, 5), rng.uniform(4, 9)))]
        scene = {
            "image": {"width": self.width, "height": self.height_in_pixels},
            "camera": {"eye": eye, "target": base, "up": self.vector(0, 1, 0), "fovY": 55},
            "ambient": 0.2, "background": [0.4, 0.5, 0.7], "maxDepth": 6, "lights": [light],
            "materials": {"white": {"diffuse": 0.75}, "red": {"diffuse": [0.8, 0.15, 0.1]}, "green": {"diffuse": [0.2, 0.6, 0.3]},
                          "shiny": {"diffuse": [0.2, 0.2, 0.7], "specular": 0.4, "shininess": 20},
                          "mirror": {"diffuse": 0.1, "mirror": 0.7}, "glass": {"transmission": 0.95, "ior": 1.5}},
            "objects": self.objects}
        if any(o["type"] == "mesh" for o in self.objects):
            scene["meshes"] = {"sheet": {"file": "sheet.obj"}}
        return scene

    def station_at(self, pixel):
        """The pair nearest to a pixel."""
        def distance(center):
            x, y = exact.pixel_of(self.scene, center)
            return math.hypot(x - pixel[0], y - pixel[1])
        return self.names[min(range(len(self.names)), key=lambda i: distance(self.centers[i]))]


def write_sheet(folder):
    """A square of -1 to 1 in the plane z = 0."""
    n = SHEET_CELLS
    with open(os.path.join(folder, "sheet.obj"), "w") as file:
        for j in range(n + 1):
            for i in range(n + 1):
                file.write("v %.9g %.9g 0\n" % (2 * i / n - 1, 2 * j / n - 1))
        for j in range(n):
            for i in range(n):
                a = j * (n + 1) + i + 1
                file.write("f %d %d %d\nf %d %d %d\n" % (a, a + 1, a + n + 2, a, a + n + 2, a + n + 1))


def read_pfm(path):
    """Rows from the bottom to the top; a pixel is a tuple, or a number in grey files."""
    with open(path, "rb") as file:
        channels = 3 if file.readline().strip() == b"PF" else 1
        width, height = map(int, file.readline().split())
        file.readline()
        values = struct.unpack("<%df" % (channels * width * height), file.read())
    return [values[channels * i:channels * (i + 1)] for i in range(width * height)]


def differs(a, b):
    return any(not abs(x - y) <= 0.01 for x, y in zip(a, b))


def is_smooth(case, truth, i):
    """True if the neighbours of pixel i have its colour."""
    y, x = divmod(i, case.width)
    if not (0 < x < case.width - 1 and 0 < y < case.height_in_pixels - 1):
        return False
    around = [truth[i + dy * case.width + dx] for dy in (-1, 0, 1) for dx in (-1, 0, 1)]
    return not any(differs(truth[i], other) for other in around)


class Outcome:
    def __init__(self, case, device, truth, objects, exact_count):
        def place(i):  # column and row from the top
            return i % case.width, case.height_in_pixels - 1 - i // case.width
        self.wrong = [place(i) for i, (a, b) in enumerate(zip(device, truth)) if differs(a, b) and is_smooth(case, truth, i)]
        self.checked, self.wrong_objects = 0, []
        for i in random.Random(case.number).sample(range(len(truth)), exact_count):
            expected = exact.object_at(case.scene, place(i), case.gap * case.extent / 4) if is_smooth(case, truth, i) else exact.UNDECIDED
            if expected is exact.UNDECIDED:
                continue
            self.checked += 1
            seen = int(objects[i][0])
            if seen != expected:
                self.wrong_objects.append((place(i), seen, expected))


def run(glint, case, folder, options, exact_count):
    path = os.path.join(folder, "case%d.json" % case.number)
    with open(path, "w") as file:
        json.dump(case.scene, file)
    images = []
    for backend in ("gpu", "cpu"):
        out = os.path.join(folder, "case%d.%s.pfm" % (case.number, backend))
        extra = list(options) if backend == "gpu" else []
        if backend == "gpu" and exact_count > 0:
            extra += ["--aov", "color,object"]
        done = subprocess.run([glint, "render", path, "-q", "--backend", backend, "-o", out] + extra, capture_output=True, text=True)
        if done.returncode != 0:
            raise RuntimeError("case %d: %s" % (case.number, done.stderr))
        images.append(read_pfm(out))
    objects = read_pfm(os.path.join(folder, "case%d.gpu.object.pfm" % case.number)) if exact_count > 0 else None
    return Outcome(case, *images, objects, exact_count)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("glint")
    parser.add_argument("--count", type=int, default=25, help="cases (default 25)")
    parser.add_argument("--first", type=int, default=0, help="number of the first case (default 0)")
    parser.add_argument("--grid", type=int, default=2, help="stations along a side (default 2)")
    parser.add_argument("--exact", type=int, default=0, help="pixels of a case whose object is computed exactly (default 0)")
    parser.add_argument("--keep", help="folder for scenes and images")
    parser.add_argument("--traversal", help="as glint render's option")
    parser.add_argument("-v", action="store_true", help="print each wrong case")
    arguments = parser.parse_args()
    options = ["--traversal", arguments.traversal] if arguments.traversal else []
    failed, checked, by_pair, pairs = 0, 0, collections.Counter(), collections.Counter()
    with tempfile.TemporaryDirectory() as temporary:
        folder = arguments.keep or temporary
        os.makedirs(folder, exist_ok=True)
        write_sheet(folder)
        for number in range(arguments.first, arguments.first + arguments.count):
            case = Case(number, arguments.grid)
            outcome = run(arguments.glint, case, folder, options, arguments.exact)
            checked += outcome.checked
            pairs.update(name[2] for name in case.names)
            if len(outcome.wrong) <= 3 and not outcome.wrong_objects:
                continue
            failed += 1
            stations = collections.Counter(map(case.station_at, outcome.wrong + [w[0] for w in outcome.wrong_objects]))
            by_pair.update(name[2] for name in stations)
            if arguments.v:
                print("case %d: %d wrong pixels, first %s; wrong objects %s; extent %g, height %g, %s" %
                      (number, len(outcome.wrong), outcome.wrong[:1], outcome.wrong_objects[:2], case.extent, case.height, dict(stations)), flush=True)
    for relation, count in sorted(pairs.items()):
        print("%-10s %6d pairs, %d wrong" % (relation, count, by_pair[relation]))
    print("%d cases of %d pairs: %d wrong; %d pixels checked exactly" % (arguments.count, arguments.grid**2, failed, checked))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
