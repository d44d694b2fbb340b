#!/usr/bin/env python3
"""Writes arcade.obj: two storeys of a hall with columns, arches, slanting beams, railings and a flight of stairs, turned by 0.6
radians about y so that hardly a wall stands along an axis. Parts overlap a little, so that no two faces coincide. Long thin triangles askew are what bounding boxes fit worst.
Run in this folder; the result is committed."""
import math

vertices = []
faces = []


def quad(a, b, c, d):
    n = len(vertices)
    vertices.extend([a, b, c, d])
    faces.extend([(n, n + 1, n + 2), (n, n + 2, n + 3)])


def turned(p, angle, axis):
    c, s = math.cos(angle), math.sin(angle)
    if axis == "y":
        return (c * p[0] + s * p[2], p[1], -s * p[0] + c * p[2])
    if axis == "z":
        return (c * p[0] - s * p[1], s * p[0] + c * p[1], p[2])
    return (p[0], c * p[1] - s * p[2], s * p[1] + c * p[2])


def box(center, half, turns=()):
    corners = []
    for z in (-1, 1):
        for y in (-1, 1):
            for x in (-1, 1):
                p = (x * half[0], y * half[1], z * half[2])
                for angle, axis in turns:
                    p = turned(p, angle, axis)
                corners.append(tuple(p[i] + center[i] for i in range(3)))
    for side in ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)):
        quad(*[corners[i] for i in side])


def column(x, z, y0, y1, radius, sides):
    def at(i, y):
        angle = 2 * math.pi * i / sides
        return (x + radius * math.cos(angle), y, z + radius * math.sin(angle))

    for i in range(sides):
        quad(at(i, y0), at(i, y1), at(i + 1, y1), at(i + 1, y0))


def arch(p, q, y, width, depth, steps):
    """Half a ring from p to q (x, z), springing at y."""
    dx, dz = q[0] - p[0], q[1] - p[1]
    span = math.hypot(dx, dz)
    r, ux, uz = span / 2, dx / span, dz / span
    nx, nz = -uz * depth / 2, ux * depth / 2

    def at(i, radius, side):
        angle = math.pi * i / steps
        along = r - radius * math.cos(angle)
        return (p[0] + ux * along + side * nx, y + radius * math.sin(angle), p[1] + uz * along + side * nz)

    for i in range(steps):
        quad(at(i, r, -1), at(i + 1, r, -1), at(i + 1, r, 1), at(i, r, 1))
        quad(at(i, r + width, 1), at(i + 1, r + width, 1), at(i + 1, r + width, -1), at(i, r + width, -1))
        quad(at(i, r, 1), at(i + 1, r, 1), at(i + 1, r + width, 1), at(i, r + width, 1))
        quad(at(i, r + width, -1), at(i + 1, r + width, -1), at(i + 1, r, -1), at(i, r, -1))


def storey(y, columns=8):
    box((0, y - 0.1, 0), (20.05, 0.1, 9.05))
    for i in range(columns):
        x = -17.5 + 5 * i
        for z in (-4, 4):
            column(x, z, y - 0.05, y + 3.05, 0.3, 24)
            box((x, y + 3.1, z), (0.45, 0.1, 0.45))
            box((x, y + 0.09, z), (0.45, 0.1, 0.45))
            if i + 1 < columns:
                arch((x + 0.3, z), (x + 4.7, z), y + 3.19, 0.4, 0.5, 16)
        box((x, y + 4.7, 0), (0.12, 0.15, 8.5))
        for side in (-1, 1):
            box((x + 1.2 * side, y + 4.2, 0), (0.06, 0.06, 9.2), ((0.25 * side, "x"),))
        for k in range(6):
            for angle, length, half in ((0.5, 0.55, 0.02), (-0.8, 0.75, 0.016)):
                box((x + 0.4 * k, y + 0.55, -7.6), (half, length, half), ((angle, "z"),))
    box((0, y + 1.2, -7.6), (20, 0.025, 0.028))


def main():
    storey(0)
    storey(5)
    box((0, 5, -8.9), (20.02, 5.04, 0.1))
    box((0, 10.1, 0), (20.07, 0.1, 9.07))
    for side in (-1, 1):
        box((20 * side, 5, 0), (0.1, 5.03, 9.02))
    for k in range(24):
        box((-10 + 0.3 * k, 0.1 + 0.2 * k, 6.5), (0.16, 0.11, 1.2))
    for side in (-1, 1):
        box((-6.4, 3.2, 6.5 + 1.1 * side), (4.4, 0.03, 0.03), ((math.atan(0.2 / 0.3), "z"),))

    numbers = {}
    lines = ["# a hall, %d triangles (make_arcade.py)" % len(faces)]
    for v in vertices:
        text = "v %.5g %.5g %.5g" % turned(v, 0.6, "y")
        if text not in numbers:
            numbers[text] = len(numbers) + 1
            lines.append(text)
    for face in faces:
        lines.append("f %d %d %d" % tuple(numbers["v %.5g %.5g %.5g" % turned(vertices[i], 0.6, "y")] for i in face))
    with open("arcade.obj", "w", encoding="ascii") as f:
        f.write("\n".join(lines) + "\n")


main()
