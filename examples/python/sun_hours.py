#!/usr/bin/env python3
"""How many hours of sun each place of a town gets on a day: a map.

    sun_hours.py [OUT.png] [--size N] [--device NAME]
"""
import argparse

import numpy as np

from town import colours, surface, town, write_png

options = argparse.ArgumentParser(description="hours of sun in a small town")
options.add_argument("out", nargs="?", default="sun_hours.png")
options.add_argument("--size", type=int, default=480, help="image size in pixels")
options.add_argument("--device", help="part of a device's name; cpu: the reference")
given = options.parse_args()
scene = town(given.device)
points, normals = surface(scene, given.size)

# Where the sun stands at latitude 48 degrees on a day of March, every quarter of an hour: to the east, to the north, upwards.
latitude, declination = np.radians(48), np.radians(0)
angle = np.radians(15 * (np.arange(5, 19, 0.25) - 12))
suns = np.stack([-np.cos(declination) * np.sin(angle),
                 np.sin(declination) * np.cos(latitude) - np.cos(declination) * np.cos(angle) * np.sin(latitude),
                 np.sin(declination) * np.sin(latitude) + np.cos(declination) * np.cos(angle) * np.cos(latitude)], axis=-1)

hours = np.zeros(points.shape[:2])
for sun in suns[suns[:, 2] > 0.01]:
    lit = (normals @ sun > 0) & ~scene.occluded(points, sun, coherent=True, leave=True)
    hours += 0.25 * lit

write_png(given.out, colours(hours, 0, 12))
print(f"{given.out}: {hours.mean():.1f} hours on average, {hours.max():.1f} at most, {np.mean(hours < 2):.0%} of the town less than 2")
