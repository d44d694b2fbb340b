#!/usr/bin/env python3
"""A lidar on a car that drives through a town: what it measures, and the points from above.

    lidar_scan.py [OUT.png] [--size N] [--device NAME]
"""
import argparse

import numpy as np

from town import HALF, colours, town, write_png

options = argparse.ArgumentParser(description="a lidar scan of a small town")
options.add_argument("out", nargs="?", default="lidar_scan.png")
options.add_argument("--size", type=int, default=480, help="image size in pixels")
options.add_argument("--device", help="part of a device's name; cpu: the reference")
given = options.parse_args()
scene = town(given.device)

# One turn: 64 beams, from 40 degrees above the horizon to 24 below it, at twice as many headings as the image has columns.
headings = np.linspace(np.pi, -np.pi, 2 * given.size, endpoint=False)
heading, slope = np.meshgrid(headings, np.radians(np.linspace(40, -24, 64)))
beams = np.stack([np.cos(slope) * np.cos(heading), np.cos(slope) * np.sin(heading), np.sin(slope)], axis=-1)

# The car goes north along a street, and the scanner turns every eight metres.
above = np.full((given.size, given.size), -1.0)
for y in np.arange(-84, 85, 8):
    hits = scene.cast([-23, y, 2], beams, t_max=90, want=("hit", "t", "point"), coherent=True)
    if y == -4:
        turn = hits
    x, y, z = hits.point[hits.hit].T
    column, row = ((np.stack([x, -y]) + HALF) / (2 * HALF) * given.size).clip(0, given.size - 1).astype(int)
    np.maximum.at(above, (row, column), z)

black = np.zeros(3, np.uint8)
distances = np.where(turn.hit[..., None], colours(-np.log(turn.t), -np.log(70), -np.log(3)), black)[:, ::2]
points = np.where(above[..., None] > -1, colours(above, -8, 25), black)
write_png(given.out, np.vstack([np.repeat(distances, 2, axis=0), points]))
print(f"{given.out}: {turn.hit.size} beams a turn, {turn.hit.mean():.0%} of them return")
