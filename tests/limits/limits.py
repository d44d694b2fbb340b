#!/usr/bin/env python3
"""What large scenes take: time and memory, against the bounds that docs/reference/faults.md states, and growth.

    limits.py GLINT [--only NAME...] [--table]

Each case is a scene of n things and one of n / 10, read, packed and drawn in 64 x 48 pixels (lights: 8 x 8) on the first device and by the
reference. Fails if one takes longer or more memory than its bound, or if reading and packing of the ten times larger one takes more than
three times what n log n allows, which only measures for cases of a second and more. --table prints the rows for the docs.
"""
import argparse
import json
import math
import os
import pathlib
import random
import struct
import subprocess
import sys
import tempfile

CAMERA = {"eye": [0, 0, 30], "target": [0, 0, 0], "fovY": 45}
LIGHT = {"type": "directional", "direction": [-0.3, -1, -0.6], "intensity": 0.8}


def scene(**more):
    return {"camera": CAMERA, "ambient": 0.2, "lights": [LIGHT], **more}


def lights(folder, n):
    chance = random.Random(1)
    some = [{"type": "point", "position": [chance.uniform(-20, 20), chance.uniform(-20, 20), chance.uniform(10, 30)], "intensity": 1 / n}
            for _ in range(n)]
    balls = [{"type": "sphere", "center": [4 * x, 4 * y, 0], "radius": 1.9} for x in range(-2, 3) for y in range(-2, 3)]
    return write(folder, scene(lights=some, objects=balls))


def spheres(folder, n):
    chance = random.Random(2)
    path = folder / "spheres.nff"
    with open(path, "w") as file:
        file.write("v\nfrom 0 0 30\nat 0 0 0\nup 0 1 0\nangle 45\nhither 1\nresolution 64 48\nl 5 20 20\nf 0.8 0.4 0.2 0.8 0.2 20 0 1\n")
        for _ in range(n):
            file.write(f"s {chance.uniform(-10, 10):.6f} {chance.uniform(-10, 10):.6f} {chance.uniform(-10, 10):.6f} 0.02\n")
    return path


def triangles(folder, n):
    """A hilly sheet as a binary PLY."""
    side = int(math.sqrt(n / 2))
    with open(folder / "sheet.ply", "wb") as file:
        file.write(f"ply\nformat binary_little_endian 1.0\nelement vertex {(side + 1) ** 2}\nproperty float x\nproperty float y\nproperty "
                   f"float z\nelement face {2 * side * side}\nproperty list uchar int vertex_indices\nend_header\n".encode())
        for i in range(side + 1):
            y = 20 * i / side - 10
            file.write(b"".join(struct.pack("<3f", 20 * j / side - 10, y, math.sin(3 * y) * math.cos(60 * j / side))
                                for j in range(side + 1)))
        for i in range(side):
            row, above = i * (side + 1), (i + 1) * (side + 1)
            file.write(b"".join(struct.pack("<B3iB3i", 3, row + j, row + j + 1, above + j, 3, row + j + 1, above + j + 1, above + j)
                                for j in range(side)))
    return write(folder, scene(meshes={"sheet": {"file": "sheet.ply"}}, objects=[{"type": "mesh", "mesh": "sheet"}]))


def instances(folder, n):
    (folder / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
    chance = random.Random(3)
    some = [{"type": "mesh", "mesh": "a", "transform": [{"scale": chance.uniform(0.1, 0.3)},
                                                       {"translate": [chance.uniform(-10, 10) for _ in range(3)]}]} for _ in range(n)]
    return write(folder, scene(meshes={"a": {"file": "a.obj"}}, objects=some))


def one_place(folder, n):
    return write(folder, scene(objects=[{"type": "sphere", "center": [0, 0, 0], "radius": 3}] * n))


def depth(folder, n):
    """n reflections in a row between two mirrors that face each other."""
    mirrors = [{"type": "plane", "point": [x, 0, 0], "normal": [-x, 0, 0], "material": "mirror"} for x in (-4, 4)]
    return write(folder, scene(camera={"eye": [3, 0.5, 2], "target": [-4, 0.2, -1], "fovY": 60}, maxDepth=n,
                               materials={"mirror": {"diffuse": 0.01, "mirror": 0.99}}, objects=mirrors +
                               [{"type": "sphere", "center": [0, 0, -1], "radius": 1}]))


def write(folder, document):
    path = folder / "scene.json"
    path.write_text(json.dumps(document))
    return path


# Name: what makes it, n, and the bounds: seconds in all and MiB, on the device and by the reference. Bounds are about five times what a
# machine of two cores took.
CASES = {
    "lights 10,000": (lights, 10_000, (20, 1000), (10, 500)),
    "lights 300,000": (lights, 300_000, (100, 2500), (60, 2500)),
    "spheres 1,000,000": (spheres, 1_000_000, (60, 3000), (60, 3000)),
    "triangles 1,000,000": (triangles, 1_000_000, (60, 3000), (60, 3000)),
    "triangles 10,000,000": (triangles, 10_000_000, (300, 6000), (300, 9000)),
    "instances 100,000": (instances, 100_000, (60, 2500), (60, 2500)),
    "objects at one place 100,000": (one_place, 100_000, (60, 2500), (60, 2500)),
    "depth 64": (depth, 64, (20, 1000), (20, 500)),
}


def render(glint, path, size, backend):
    """(statistics, MiB) of one process."""
    child = subprocess.Popen([glint, "render", path, "--size", size, "-o", "out.pfm", "--backend", backend, "--stats", "json"],
                             cwd=path.parent, stdout=subprocess.PIPE, text=True)
    text = child.stdout.read()
    _, status, usage = os.wait4(child.pid, 0)
    if status != 0:
        sys.exit(f"limits.py: {path}: glint ended with status {os.waitstatus_to_exitcode(status)}")
    stats = json.loads(text)
    stats["processor"] = usage.ru_utime + usage.ru_stime
    return stats, usage.ru_maxrss / 1024


def preparing(stats):
    return stats["seconds"]["load"] + stats["seconds"]["pack"]


def check(glint, name, table):
    make, n, on_device, on_host = CASES[name]
    size = "8x8" if make is lights else "64x48"
    faults = []
    with tempfile.TemporaryDirectory() as folder:
        small, _ = render(glint, make(pathlib.Path(folder), max(n // 10, 1)), size, "cpu")
    with tempfile.TemporaryDirectory() as folder:
        path = make(pathlib.Path(folder), n)
        for backend, (seconds, most) in (("gpu", on_device), ("cpu", on_host)):
            stats, peak = render(glint, path, size, backend)
            took = stats["seconds"]
            row = (name, "device" if backend == "gpu" else "reference", f"{preparing(stats):.2f}", f"{took['trace']:.2f}",
                   f"{took['total']:.1f}", f"{peak:.0f}", f"{seconds} s, {most} MiB")
            print("| " + " | ".join(row) + " |" if table else "  ".join(f"{cell:>14}" for cell in row), flush=True)
            if took["total"] > seconds:
                faults.append(f"{name}, {backend}: {took['total']:.1f} s, the bound is {seconds} s")
            if peak > most:
                faults.append(f"{name}, {backend}: {peak:.0f} MiB, the bound is {most} MiB")
    allowed = 3 * 10 * math.log(n) / math.log(max(n // 10, 2)) * max(preparing(small), 0.03)
    if preparing(stats) > 1 and preparing(stats) > allowed:
        faults.append(f"{name}: {preparing(small):.2f} s for a tenth, but {preparing(stats):.2f} s: that is more than n log n")
    return faults


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("glint")
    parser.add_argument("--only", nargs="+", choices=list(CASES), default=list(CASES))
    parser.add_argument("--table", action="store_true")
    given = parser.parse_args()
    faults = []
    for name in given.only:
        faults += check(os.path.abspath(given.glint), name, given.table)
    for fault in faults:
        print("limits.py: " + fault, file=sys.stderr)
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
