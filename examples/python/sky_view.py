#!/usr/bin/env python3
"""How much of the sky each place of a town sees: a map of the sky-view factor.

    sky_view.py [OUT.png] [--size N] [--device NAME]
"""
import argparse

import numpy as np

from town import colours, surface, town, write_png

options = argparse.ArgumentParser(description="the sky-view factor in a small town")
options.add_argument("out", nargs="?", default="sky_view.png")
options.add_argument("--size", type=int, default=480, help="image size in pixels")
options.add_argument("--device", help="part of a device's name; cpu: the reference")
given = options.parse_args()
scene = town(given.device)
points, normals = surface(scene, given.size)

# Directions above the horizon, as many for equal parts of the disc below them: each counts by the cosine of its angle to the zenith.
count = 96
radius = np.sqrt((np.arange(count) + 0.5) / count)
turn = np.arange(count) * np.pi * (3 - np.sqrt(5))
sky = np.stack([radius * np.cos(turn), radius * np.sin(turn), np.sqrt(1 - radius**2)], axis=-1)

seen = np.zeros(points.shape[:2])
for direction in sky:
    seen += (normals @ direction > 0) & ~scene.occluded(points, direction, coherent=True, leave=True)
factor = seen / count

write_png(given.out, colours(factor, 0, 1))
street = points[..., 2] < 0.1
print(f"{given.out}: {factor[street].mean():.2f} on average in the streets, {factor[street].min():.2f} at least")
