#!/usr/bin/env python3
"""Writes the sphereflake of the Standard Procedural Databases as a glint scene without a floor, which Embree has no shape for.

    bench/sphereflake.py LEVELS > sphereflake.json

Every sphere carries nine of a third of its radius, six around its equator and three above (E. Haines, "A Proposal for Standard Graphics
Environments", IEEE CG&A 7(11), 1987). LEVELS 4 gives 7381 spheres.
"""
import json
import math
import sys


def normalized(v):
    length = math.sqrt(sum(x * x for x in v))
    return [x / length for x in v]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def flake(levels, center, radius, axis, spheres):
    spheres.append({"type": "sphere", "center": center, "radius": radius, "material": "grey"})
    if levels == 0:
        return
    side = normalized(cross(axis, [1, 0, 0] if abs(axis[0]) < 0.7 else [0, 1, 0]))
    other = cross(axis, side)
    for ring, (count, height) in enumerate([(6, 0.0), (3, 0.8)]):
        for i in range(count):
            angle = 2 * math.pi * i / count + ring * math.pi / 6
            flat = math.sqrt(1 - height * height)
            way = [flat * (math.cos(angle) * s + math.sin(angle) * o) + height * a for s, o, a in zip(side, other, axis)]
            flake(levels - 1, [c + w * radius * 4 / 3 for c, w in zip(center, way)], radius / 3, way, spheres)


def main():
    spheres = []
    flake(int(sys.argv[1]), [0, 0, 0], 0.5, [0, 0, 1], spheres)
    print(json.dumps({
        "image": {"width": 1024, "height": 1024},
        "camera": {"eye": [2.1, 1.3, 1.7], "target": [0, 0, 0], "up": [0, 0, 1], "fovY": 45},
        "background": [0.08, 0.36, 0.7], "ambient": 0.2,
        "lights": [{"type": "point", "position": [4, 3, 2], "intensity": 0.6}],
        "materials": {"grey": {"diffuse": [0.6, 0.55, 0.5]}},
        "objects": spheres}))


if __name__ == "__main__":
    main()
