#!/usr/bin/env python3
"""Measures large scenes from the shell to the PNG: 10^7 triangles, 10^8 by instances, 10^6 spheres, 1,000 lights, and a tenth of each.

    bench/scale.py [--rounds 3] [--only triangles,instances,spheres,lights] [--quick]

Writes the scenes itself (300 MB in a temporary folder) and prints a table in Markdown: medians of the rounds, in which a scene and its tenth take
turns, and the exponent of the processor time's growth from one to the other. About four minutes on two idle cores and 4 GiB of memory.
"""
import json
import math
import os
import pathlib
import random
import statistics
import subprocess
import sys
import tempfile
import time

import measure
import scaling


def triangles(folder, count):
    """Hills of so many triangles."""
    mesh = folder / "triangles.ply"
    return scaling.terrain(mesh, count), scaling.terrain_scene(folder, "triangles", mesh)


def instances(folder, count):
    """The same hills of a million triangles (a thousandth of a few), side by side and turned."""
    mesh, of_each = folder / "hills.ply", min(10**6, count // 10)
    of_each = scaling.terrain(mesh, of_each)
    scene = json.loads(scaling.terrain_scene(folder, "instances", mesh).read_text())
    number = round(count / of_each)
    side = math.ceil(math.sqrt(number))
    scene["camera"] = {"eye": [1.3 * side, 1.5 * side, 1.8 * side], "target": [0, 0, 0], "fovY": 42}
    scene["objects"] = [{"type": "mesh", "mesh": "m", "material": "grey",
                         "transform": [{"rotate": [0, 1, 0, 90 * (i % 4)]}, {"translate": [2 * (i % side) - side + 1, 0, 2 * (i // side) - side + 1]}]}
                        for i in range(number)]
    path = folder / "instances.json"
    path.write_text(json.dumps(scene))
    return of_each * number, path


def spheres(folder, count):
    """Balls at random in a cube, in NFF."""
    dice = random.Random(3)
    path, radius = folder / "spheres.nff", 0.3 / round(count ** (1 / 3))
    with open(path, "w") as file:
        file.write("v\nfrom 1.9 1.6 2.4\nat 0.5 0.45 0.5\nup 0 1 0\nangle 40\nhither 0.01\nresolution 512 512\nl 3 5 4\nf 0.7 0.6 0.5 0.8 0.2 20 0 1\n")
        for _ in range(count):
            file.write(f"s {dice.random():.6f} {dice.random():.6f} {dice.random():.6f} {radius:.6f}\n")
    return count, path


def lights(folder, count):
    """So many lights over hills of 10,000 triangles."""
    mesh = folder / "lights.ply"
    scaling.terrain(mesh, 10**4)
    return count, scaling.terrain_scene(folder, "lights", mesh, count)


# Name: what makes it, the greatest number, the picture's size.
CASES = {"triangles": (triangles, 10**7, "512x512"), "instances": (instances, 10**8, "512x512"), "spheres": (spheres, 10**6, "512x512"),
         "lights": (lights, 1000, "128x128")}
NAMES = {"triangles": "triangles", "instances": "triangles by instances", "spheres": "spheres", "lights": "lights"}


def draw(glint, scene, size, out):
    """Seconds from the shell to the file, of all processors, stages, and the greatest memory in bytes."""
    start = time.perf_counter()
    child = subprocess.Popen([glint, "render", scene, "--size", size, "-o", out, "--progress", "none"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    said = child.stdout.read()
    _, status, usage = os.wait4(child.pid, 0)
    wall = time.perf_counter() - start
    if status != 0:
        sys.exit(f"{scene}: glint ended with {os.waitstatus_to_exitcode(status)}:\n{child.stderr.read()[-2000:]}")
    return {"wall": wall, "processors": usage.ru_utime + usage.ru_stime, "memory": usage.ru_maxrss * 1024, **measure.stages(said)}


def measure_case(glint, name, make, greatest, size, rounds):
    with tempfile.TemporaryDirectory() as small, tempfile.TemporaryDirectory() as great:
        made = [make(pathlib.Path(folder), count) for folder, count in ((small, greatest // 10), (great, greatest))]
        draw(glint, made[0][1], size, pathlib.Path(small) / "a.png")  # fills the shader cache
        found = [[], []]
        for _ in range(rounds):
            for i, (_, scene) in enumerate(made):
                found[i].append(draw(glint, scene, size, pathlib.Path(small) / "a.png"))
    middle = [{key: statistics.median(run[key] for run in runs) for key in runs[0]} for runs in found]
    grown = math.log(middle[1]["processors"] / middle[0]["processors"]) / math.log(made[1][0] / made[0][0])
    rows = []
    for (count, _), m, exponent in zip(made, middle, ("", f"{grown:.2f}")):
        rows.append([f"{measure.number(float(f'{count:.3g}'))} {NAMES[name]}", size, measure.seconds(m["wall"]), measure.seconds(m["processors"]), exponent,
                     *(measure.seconds(m.get(stage, 0)) for stage in ("load", "packing", "upload", "trace")), f"{m['memory'] / 2**30:.2f} GiB"])
        print(" | ".join(rows[-1]), file=sys.stderr, flush=True)
    return rows


def main():
    parser = measure.arguments(__doc__)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--only", type=lambda text: text.split(","), default=list(CASES))
    options = parser.parse_args()
    rows, load = [], os.getloadavg()[0]
    for name in options.only:
        make, greatest, size = CASES[name]
        rows += measure_case(options.glint, name, make, max(20, greatest // 1000) if options.quick else greatest, size, 1 if options.quick else options.rounds)
    header = ["scene", "pixels", "shell to PNG", "processors", "exponent", "load", "pack and build", "upload", "trace", "memory"]
    print(f"Load of the machine {load:.1f}.\n\n" + measure.table(header, rows))


if __name__ == "__main__":
    main()
