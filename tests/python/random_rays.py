#!/usr/bin/env python3
"""Casts random rays at random scenes through the Python module, on the device and on the processor.

    GLINT_LIBRARY=build/lib/libglint.so.0 PYTHONPATH=python tests/python/random_rays.py [--seed 1] [--seconds 60]

Rays aim at corners, edges and centers, start there, or run along axes, and end at the hit. For all rays the test checks intervals, order,
names and lengths of lists, which hold however numbers are rounded. For rays with random targets the list begins with the nearest hit, and
both devices agree. For certified hits both devices name the same triangle. A changed scene answers like a new one. Each complaint is a
line; the exit code is then 1.
"""
import argparse
import json
import sys
import time

import numpy as np

import glint

CLOSE = 1e-6  # relative tolerance of t: fp32 on the device


def turned(random, size):
    """A rotation, or a reflection, with a scale and a shift."""
    transform = np.zeros((3, 4))
    transform[:, :3] = np.linalg.qr(random.normal(size=(3, 3)))[0] * 10 ** random.uniform(-1, 1) * random.choice([-1, 1])
    transform[:, 3] = random.normal(size=3) * size
    return transform


class Plan:
    """Contents of a scene, from which each device makes it, also after changes. Rays aim at `points`."""

    def __init__(self, random):
        self.random = random
        self.size = 10 ** random.uniform(-3, 3)
        self.offset = random.choice([0, 0, 1e2, 1e5]) * random.normal(size=3) * self.size
        self.meshes, self.places, self.spheres, self.texts, self.instances = [], {}, [], [], []
        self.points = []
        for _ in range(random.integers(1, 4)):
            random.choice([self.add_mesh, self.add_mesh, self.add_spheres, self.add_objects])()
        if self.meshes:
            for _ in range(random.integers(0, 3)):
                self.instances.append([random.integers(len(self.meshes)), turned(random, self.size)])

    def place(self, *shape):
        return self.random.normal(size=shape + (3,)) * self.size + self.offset

    def add_mesh(self):
        count = 3 * self.random.integers(1, 60)
        kind = self.random.integers(3)
        corners = self.place(count)
        if kind == 1:  # on a grid
            corners = self.random.integers(-2, 3, size=(count, 3)) * self.size + self.offset
        if kind == 2:  # in a plane perpendicular to an axis, each triangle twice
            axis = self.random.integers(3)
            corners[:, axis] = self.offset[axis]
            corners = np.concatenate([corners, corners])
        self.meshes.append(corners)
        self.points.append(corners)

    def add_spheres(self):
        centers = self.place(self.random.integers(1, 8))
        radii = np.abs(self.random.normal(size=len(centers))) * self.size * 10 ** self.random.uniform(-4, 1) + 1e-9 * self.size
        self.spheres.append((centers, radii))
        self.points += [centers, centers + np.eye(3)[self.random.integers(3)] * radii[:, None]]

    def add_objects(self):
        objects = []
        for _ in range(self.random.integers(1, 4)):
            at, extent = self.place(), float(self.size * self.random.uniform(0.1, 1))
            normal = self.random.normal(size=3).tolist()
            objects.append(self.random.choice([
                {"type": "box", "min": at.tolist(), "max": (at + extent).tolist()},
                {"type": "disc", "center": at.tolist(), "normal": normal, "radius": extent},
                {"type": "cylinder", "base": at.tolist(), "top": (at + extent).tolist(), "radius": extent, "capped": True},
                {"type": "plane", "point": at.tolist(), "normal": normal}]))
            self.points.append(np.array([at, at + extent]))
        self.texts.append(json.dumps({"objects": objects}))

    def make(self, device):
        scene = glint.Scene(device=device)
        self.numbers = [scene.add_triangles(corners) for corners in self.meshes]
        for centers, radii in self.spheres:
            scene.add_spheres(centers, radii)
        for text in self.texts:
            scene.add_json(text)
        self.instance_numbers = [scene.add_instance(self.numbers[mesh], place) for mesh, place in self.instances]
        for mesh, place in self.places.items():
            scene.set_transform(self.numbers[mesh], place)
        scene.commit()
        return scene

    def change(self, scenes):
        """Changes meshes and instances, equally in all scenes."""
        for mesh, corners in enumerate(self.meshes):
            if self.random.random() < 0.5:
                self.meshes[mesh] = corners + self.random.normal(size=corners.shape) * self.size * 10 ** self.random.uniform(-6, 0.5)
                for scene in scenes:
                    scene.set_vertices(self.numbers[mesh], self.meshes[mesh])
            elif self.random.random() < 0.3:
                self.places[mesh] = turned(self.random, self.size)
                for scene in scenes:
                    scene.set_transform(self.numbers[mesh], self.places[mesh])
        for number, instance in zip(self.instance_numbers, self.instances):
            instance[1] = turned(self.random, self.size)
            for scene in scenes:
                scene.set_transform(number, instance[1])
        for scene in scenes:
            scene.commit()

    def rays(self):
        """(origins, directions, t_min, t_max, True for rays with random targets)."""
        random, count = self.random, self.random.integers(1, 400)
        points = np.concatenate(self.points)

        def some(part):
            return random.random(count) < part
        plain, starts, axes = some(0.5), some(0.15), some(0.1)
        targets = points[random.integers(len(points), size=count)] + plain[:, None] * random.normal(size=(count, 3)) * self.size * 0.5
        origins = self.offset + random.normal(size=(count, 3)) * self.size * 3
        origins[starts] = points[random.integers(len(points), size=starts.sum())]
        directions = targets - origins
        directions[axes] = np.eye(3)[random.integers(3, size=axes.sum())] * random.choice([-1, 1], size=(axes.sum(), 1))
        strange = some(0.03)
        directions[strange] *= random.choice([0, 1e-30, 1e30, np.nan], size=(strange.sum(), 1))
        kind = random.choice([np.float32, np.float64])
        t_min = random.choice([0, 0, 0, 1e-3, -1, 0.5], size=count)
        t_max = random.choice([1, 1, 0.5, 2, np.inf, np.inf, np.inf], size=count)
        return origins.astype(kind), directions.astype(kind), t_min, t_max, plain & ~starts & ~axes & ~strange


def wrong(mask):
    return f"{mask.sum()} of {len(mask)}, the first {np.flatnonzero(mask)[0]}"


def same_t(one, other, rays):
    """True where t is equal within the rounding of coordinates to fp32."""
    origins, directions = (np.abs(part.astype(float)).max(axis=1) for part in rays[:2])
    met = np.isfinite(one) & np.isfinite(other)
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        room = 1e-3 * np.abs(one) + CLOSE + 1e-5 * origins / directions
        return (np.isfinite(one) == np.isfinite(other)) & (~met | (np.abs(one - other) <= room))


def must_hold(scene, rays):
    """Yields the name of each property that rounding cannot break, and a mask of the rays that break it."""
    origins, directions, t_min, t_max, plain = rays
    ends = {"t_min": t_min, "t_max": t_max}
    found = scene.cast(origins, directions, want=("hit", "t", "geometry", "uv", "normal"), **ends)
    offsets, listed = scene.all_hits(origins, directions, want=("t", "geometry", "uv", "normal"), **ends)
    lengths = np.diff(offsets).astype(int)
    ray = np.repeat(np.arange(len(lengths)), lengths)
    for name, part, which in (("hit", found, np.arange(len(lengths))), ("list", listed, ray)):
        met = found.hit if part is found else np.ones(len(which), bool)
        low, high = np.maximum(t_min, 0)[which], t_max[which]
        yield f"{name}: interval", met & ~((part.t >= low * (1 - CLOSE)) & (part.t <= high * (1 + CLOSE)))
        yield f"{name}: geometry", met != (part.geometry != glint.NONE)
        yield f"{name}: uv", met & ((part.uv < -1e-5).any(1) | (part.uv.sum(1) > 1 + 1e-5))
        yield f"{name}: normal", met & (np.abs(np.linalg.norm(part.normal, axis=1) - 1) > 1e-4)
    yield "order", (np.diff(listed.t) < 0) & (np.diff(ray) == 0)
    yield "count", scene.count(origins, directions, **ends) != lengths
    yield "occluded", scene.occluded(origins, directions, **ends) != found.hit
    nearest = np.full(len(lengths), np.inf)
    np.minimum.at(nearest, ray, listed.t)
    yield "list begins with the nearest", plain & ~same_t(nearest, found.t, rays)


def as_made_anew(scene, anew, rays):
    """Yields names and masks of rays for which a changed scene and a new one differ: nearest hits in any bit, lists of rays with random
    targets in their names. For other rays rounding may decide whether a surface lies before the origin, and another tree may skip it."""
    origins, directions, t_min, t_max, plain = rays
    asked = [one.cast(origins, directions, t_min=t_min, t_max=t_max) for one in (scene, anew)]
    for name in asked[0]._fields:
        one, other = (np.reshape(getattr(found, name), (len(plain), -1)) for found in asked)
        yield f"{name} after a change", (one != other).any(1)
    lists = [one.all_hits(origins[plain], directions[plain], t_min=t_min[plain], t_max=t_max[plain]) for one in (scene, anew)]
    yield "lengths of lists after a change", lists[0][0] != lists[1][0]
    if len(lists[0][1].t) == len(lists[1][1].t):
        yield "lists after a change", np.any([getattr(lists[0][1], name) != getattr(lists[1][1], name) for name in ("geometry", "primitive")], axis=0)


def complaints(seed, devices):
    """Yields a line for each wrong answer in the scenes of a seed."""
    plan = Plan(np.random.default_rng(seed))
    try:
        scenes = [plan.make(device) for device in devices]
    except glint.Error as error:
        if error.status == "scene":  # a refused shape
            return
        raise
    for turn in range(3):
        if turn > 0:
            plan.change(scenes)
        rays = plan.rays()
        origins, directions, t_min, t_max, plain = rays
        for device, scene in zip(devices, scenes):
            for name, mask in [*must_hold(scene, rays), *as_made_anew(scene, plan.make(device), rays)]:
                if mask.any():
                    yield f"seed {seed}, turn {turn}, {device.info['name']}: {name}: {wrong(mask)}"
        one, other = (scene.cast(origins, directions, t_min=t_min, t_max=t_max, want=("hit", "t", "geometry", "primitive", "sure"))
                      for scene in scenes)
        for name, mask in (("plain rays on both devices", plain & ~same_t(one.t, other.t, rays)),
                           ("certified on both devices", one.sure & other.sure & ((one.geometry != other.geometry) | (one.primitive != other.primitive)))):
            if mask.any():
                yield f"seed {seed}, turn {turn}: {name}: {wrong(mask)}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=60)
    options = parser.parse_args()
    devices = [glint.Device("cpu"), glint.Device()]
    begin, seed, bad = time.time(), options.seed, 0
    while time.time() - begin < options.seconds:
        for line in complaints(seed, devices):
            bad += 1
            print(line, flush=True)
        seed += 1
    print(f"random_rays: seeds {options.seed} to {seed - 1}, {bad} complaints")
    sys.exit(1 if bad else 0)


if __name__ == "__main__":
    main()
