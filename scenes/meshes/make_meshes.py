#!/usr/bin/env python3
"""Writes the meshes that glint's own scenes use. Run in this folder; the results are committed, so nobody has to.

knot.obj    (2,3) torus knot, 240 x 24 quads, vertex normals
gem.obj     icosahedron whose faces are raised to a point (a small stellated dodecahedron's cousin), flat
floor.obj   checkered floor of 24 x 24 quads in two materials (floor.mtl), from -12 to 12
panes.obj   four upright blocks side by side, a material of panes.mtl each
cube.obj    the unit cube from (0, 0, 0) to (1, 1, 1), 6 quads
"""
import math


def write(name, lines):
    with open(name, "w", encoding="ascii") as f:
        f.write("\n".join(lines) + "\n")


def sub(a, b):
    return [x - y for x, y in zip(a, b)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    n = math.sqrt(sum(x * x for x in a))
    return [x / n for x in a]


def knot_point(t):
    r = 2 + math.cos(3 * t)
    return [r * math.cos(2 * t), r * math.sin(2 * t), math.sin(3 * t)]


def knot(rings=240, sides=24, radius=0.42):
    lines = ["# (2,3) torus knot, tube radius %g" % radius]
    normals = []
    for i in range(rings):
        t = 2 * math.pi * i / rings
        p = knot_point(t)
        tangent = unit(sub(knot_point(t + 1e-4), knot_point(t - 1e-4)))
        # A frame that turns with the torus: continuous all the way round.
        out = [p[0] - 2 * math.cos(2 * t), p[1] - 2 * math.sin(2 * t), p[2]]
        b = unit(cross(tangent, out))
        n = cross(b, tangent)
        for j in range(sides):
            a = 2 * math.pi * j / sides
            d = [math.cos(a) * n[k] + math.sin(a) * b[k] for k in range(3)]
            lines.append("v %.6f %.6f %.6f" % tuple(p[k] + radius * d[k] for k in range(3)))
            normals.append("vn %.5f %.5f %.5f" % tuple(d))
    lines += normals
    for i in range(rings):
        for j in range(sides):
            q = [i * sides + j, ((i + 1) % rings) * sides + j, ((i + 1) % rings) * sides + (j + 1) % sides,
                 i * sides + (j + 1) % sides]
            lines.append("f " + " ".join("%d//%d" % (k + 1, k + 1) for k in q))
    write("knot.obj", lines)


def panes(names=("wall", "veil", "tinted", "glass"), width=0.8, height=1.4, depth=0.3, step=1.2):
    lines = ["# four blocks, see panes.mtl", "mtllib panes.mtl"]
    for i, name in enumerate(names):
        middle = (i - (len(names) - 1) / 2) * step
        for c in range(8):
            lines.append("v %g %g %g" % (middle + (width / 2 if c & 1 else -width / 2), height if c & 2 else 0,
                                         depth / 2 if c & 4 else -depth / 2))
        lines.append("usemtl " + name)
        for q in ((1, 3, 4, 2), (5, 6, 8, 7), (1, 2, 6, 5), (3, 7, 8, 4), (1, 5, 7, 3), (2, 4, 8, 6)):
            lines.append("f " + " ".join(str(8 * i + k) for k in q))
    write("panes.obj", lines)


def gem(height=1.7):
    g = (1 + math.sqrt(5)) / 2
    base = []
    for s in (-1, 1):
        for t in (-g, g):
            base += [[0, s, t], [s, t, 0], [t, 0, s]]
    base = [unit(v) for v in base]
    edge = min(math.dist(base[0], v) for v in base[1:])
    faces = []
    for i in range(12):
        for j in range(i + 1, 12):
            for k in range(j + 1, 12):
                if all(abs(math.dist(base[a], base[b]) - edge) < 1e-6 for a, b in ((i, j), (j, k), (i, k))):
                    n = cross(sub(base[j], base[i]), sub(base[k], base[i]))
                    outward = sum(x * y for x, y in zip(n, base[i])) > 0
                    faces.append((i, j, k) if outward else (i, k, j))
    lines = ["# icosahedron with a point on each face"]
    lines += ["v %.7f %.7f %.7f" % tuple(v) for v in base]
    lines += ["v %.7f %.7f %.7f" % tuple(height * x for x in unit([sum(base[v][k] for v in f) for k in range(3)]))
              for f in faces]
    for n, (a, b, c) in enumerate(faces):
        top = 13 + n
        lines += ["f %d %d %d" % (p + 1, q + 1, top) for p, q in ((a, b), (b, c), (c, a))]
    write("gem.obj", lines)


def floor(n=24, half=12.0):
    lines = ["# checkered floor", "mtllib floor.mtl"]
    for i in range(n + 1):
        for j in range(n + 1):
            lines.append("v %g 0 %g" % (-half + 2 * half * i / n, -half + 2 * half * j / n))
    for parity, material in ((0, "light"), (1, "dark")):
        lines.append("usemtl " + material)
        for i in range(n):
            for j in range(n):
                if (i + j) % 2 == parity:
                    a = i * (n + 1) + j + 1
                    lines.append("f %d %d %d %d" % (a, a + 1, a + n + 2, a + n + 1))
    write("floor.obj", lines)
    write("floor.mtl", ["newmtl light", "Kd 0.75 0.72 0.66", "Ka 0.75 0.72 0.66", "Ks 0.12 0.12 0.12", "Ns 80", "illum 3",
                        "newmtl dark", "Kd 0.10 0.12 0.16", "Ka 0.10 0.12 0.16", "Ks 0.22 0.22 0.22", "Ns 80", "illum 3"])


def cube():
    lines = ["# unit cube"]
    lines += ["v %d %d %d" % (i & 1, i >> 1 & 1, i >> 2) for i in range(8)]
    for k in range(3):  # the faces across axis k: a, b the other two in cyclic order
        a, b = 1 << (k + 1) % 3, 1 << (k + 2) % 3
        for side in (0, 1 << k):
            corners = [side, side + a, side + a + b, side + b]
            lines.append("f %d %d %d %d" % tuple(c + 1 for c in (corners if side else corners[::-1])))
    write("cube.obj", lines)


knot()
gem()
floor()
cube()
panes()
