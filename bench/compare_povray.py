#!/usr/bin/env python3
"""Whole pictures beside POV-Ray 3.7: the same mesh, camera, light and shadows, no antialiasing, from the shell's point of view.

    bench/compare_povray.py [--assets FOLDER] [--repeat N] [--keep FOLDER] [--page docs/lab/povray.md] [--quick]

Each program reads its own file (POV-Ray a mesh2 that this script writes, glint the mesh's own file) and writes a PNG; runs take turns, and the
median of N (default 5) counts. `cold`: the driver's shader cache switched off. Needs povray (Debian package) and the meshes of --assets
(default ../shared/assets/meshes); those that are not there are left out. --keep: the pictures and scenes, to look at. About four minutes on
two idle cores.
"""
import json
import math
import os
import pathlib
import re
import shutil
import statistics
import struct
import sys
import tempfile

import measure

SIZE = 1024
COLD = {"MESA_SHADER_CACHE_DISABLE": "true"}
AMBIENT, DIFFUSE, GREY, SKY = 0.15, 0.85, [0.7, 0.65, 0.55], [0.3, 0.45, 0.7]
# file, eye, target, up, fovY, light
MESHES = {
    "bunny": ("bun_zipper.ply", [0.0, 0.16, 0.28], [-0.017, 0.105, 0.0], [0, 1, 0], 38, [0.3, 0.6, 0.5]),
    "dragon": ("dragon_vrip_res2.ply", [0.05, 0.2, 0.3], [-0.006, 0.12, 0.0], [0, 1, 0], 38, [0.3, 0.6, 0.5]),
    "mountain": ("spd_mount_sf9.ply", [-1.6, -1.6, 1.7], [0, 0, -0.2], [0, 0, 1], 45, [-0.5, -4, 4]),
}


def read_ply(path):
    """Vertices and triangles of a PLY file, ascii or little-endian, whose vertices start with float x y z."""
    with open(path, "rb") as file:
        counts, widths, element, binary = {}, {"vertex": 0}, None, False
        while (line := file.readline().decode("ascii", "replace").split()) != ["end_header"]:
            if line[:1] == ["format"]:
                binary = line[1] == "binary_little_endian"
            elif line[:1] == ["element"]:
                element = line[1]
                counts[element] = int(line[2])
            elif line[:1] == ["property"] and element == "vertex":
                widths["vertex"] += 1
        if binary:
            vertices = list(struct.iter_unpack("<3f", file.read(12 * counts["vertex"])))
            faces = [f[1:] for f in struct.iter_unpack("<B3i", file.read(13 * counts["face"]))]
        else:
            vertices = [tuple(map(float, file.readline().split()[:3])) for _ in range(counts["vertex"])]
            faces = [tuple(map(int, file.readline().split()[1:4])) for _ in range(counts["face"])]
    return vertices, faces


def vector(v):
    return "<" + ",".join(f"{x:.9g}" for x in v) + ">"


def povray_scene(path, eye, target, up, fov, light, objects):
    finish = f"texture {{ pigment {{ rgb {vector(GREY)} }} finish {{ ambient {AMBIENT} diffuse {DIFFUSE} specular 0 }} }}"
    with open(path, "w") as file:
        # right -x: a right-handed world. The angle is the horizontal one, the same as fovY in a square picture.
        file.write(f"#version 3.7;\nglobal_settings {{ assumed_gamma 1 max_trace_level 1 }}\nbackground {{ rgb {vector(SKY)} }}\n"
                   f"camera {{ location {vector(eye)} sky {vector(up)} up y right -x angle {fov} look_at {vector(target)} }}\n"
                   f"light_source {{ {vector(light)} rgb 1 }}\n")
        objects(file, finish)


def mesh2(vertices, faces):
    def write(file, finish):
        file.write(f"mesh2 {{ vertex_vectors {{ {len(vertices)},\n" + ",\n".join(map(vector, vertices)) + "}\n")
        file.write(f"face_indices {{ {len(faces)},\n" + ",\n".join(f"<{a},{b},{c}>" for a, b, c in faces) + "}\n" + finish + "}\n")
    return write


def spheres(list_of):
    def write(file, finish):
        for center, radius in list_of:
            file.write(f"sphere {{ {vector(center)}, {radius} {finish} }}\n")
    return write


def glint_scene(path, eye, target, up, fov, light, objects, meshes):
    colour = [DIFFUSE * c for c in GREY]
    path.write_text(json.dumps({
        "image": {"width": SIZE, "height": SIZE}, "camera": {"eye": eye, "target": target, "up": up, "fovY": fov}, "background": SKY, "ambient": 1,
        "maxDepth": 0, "lights": [{"type": "point", "position": light, "intensity": 1}],
        "materials": {"m": {"diffuse": colour, "ambient": [AMBIENT * c for c in GREY]}}, "meshes": meshes, "objects": objects}))


def prepare(name, folder, assets):
    """The two scene files of a case and its number of primitives; None where the mesh is not there."""
    ours, theirs = folder / f"{name}.json", folder / f"{name}.pov"
    if name == "spheres":
        balls = [([2 * math.cos(0.628 * i), 0.5 * math.sin(1.885 * i), 2 * math.sin(0.628 * i)], 0.5) for i in range(10)]
        view = ([0, 2, 7], [0, 0, 0], [0, 1, 0], 40, [2, 5, 3])
        glint_scene(ours, *view, [{"type": "sphere", "center": c, "radius": r, "material": "m"} for c, r in balls], {})
        povray_scene(theirs, *view, spheres(balls))
        return ours, theirs, 10
    file, *view = MESHES[name]
    if not (assets / file).exists():
        return None
    vertices, faces = read_ply(assets / file)
    glint_scene(ours, *view, [{"type": "mesh", "mesh": "m", "material": "m"}], {"m": {"file": os.path.relpath(assets / file, folder)}})
    povray_scene(theirs, *view, mesh2(vertices, faces))
    return ours, theirs, len(faces)


class Contestant:
    def __init__(self, name, command, environment=None):
        self.name, self.command, self.environment = name, command, environment
        self.wall, self.cpu, self.trace = [], [], []

    def once(self):
        wall, cpu, out, said = measure.run(self.command, self.environment)
        self.wall.append(wall)
        self.cpu.append(cpu)
        if self.command[0] == "povray":
            found = re.search(r"Trace Time:.*\(([0-9.]+) seconds\)", said)
            self.trace.append(float(found[1]))
        else:
            self.trace.append(measure.stages(out)["trace"])


def compare(name, files, options, folder, threads):
    ours, theirs, primitives = files
    size = options.size
    draw = lambda out, *more: [options.glint, "render", ours, "--size", f"{size}x{size}", "-o", folder / f"{name}.{out}.png", "--progress", "none", *more]
    pov = ["povray", f"+I{theirs}", f"+O{folder / name}.povray.png", f"+W{size}", f"+H{size}", f"+WT{threads}", "-D", "-V", "-A"]
    contestants = [Contestant("POV-Ray", pov), Contestant("glint", draw("glint")), Contestant("glint, cold", draw("glint"), COLD),
                   Contestant("glint --backend cpu", draw("reference", "--backend", "cpu"))]
    contestants[1].once()  # fills the shader cache
    contestants[1].__init__(contestants[1].name, contestants[1].command)
    for _ in range(options.repeat):
        for contestant in contestants:
            contestant.once()
    rows, base = [], statistics.median(contestants[0].wall)
    base_trace = statistics.median(contestants[0].trace)
    for c in contestants:
        wall, trace = statistics.median(c.wall), statistics.median(c.trace)
        rows.append([f"{name}, {primitives}", c.name, measure.seconds(wall), measure.seconds(statistics.median(c.cpu)), measure.seconds(trace),
                     f"{base / wall:.2f}", f"{base_trace / trace:.2f}", ""])
    for row, other in ((1, "glint"), (3, "reference")):
        out = measure.run([options.glint, "diff", f"{folder / name}.povray.png", f"{folder / name}.{other}.png"], check=False)[2]
        share, rmse, mean = (re.search(p, out)[1] for p in (r"\(([0-9.e-]+) %\) differ", r"RMSE ([0-9.e-]+)", r"mean ([0-9.e-]+)"))
        rows[row][-1] = f"{float(share):.2g} %, RMSE {float(rmse):.2g}, mean {float(mean):.1g}"
    return rows


def main():
    parser = measure.arguments(__doc__)
    parser.add_argument("--assets", type=pathlib.Path, default=measure.ROOT.parent / "shared/assets/meshes")
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--size", type=int, default=SIZE)
    parser.add_argument("--keep", type=pathlib.Path)
    parser.add_argument("--only", action="append", help="spheres, bunny, dragon, mountain")
    options = parser.parse_args()
    if shutil.which("povray") is None:
        sys.exit("povray is not installed (Debian package povray)")
    names = options.only or (["spheres", "bunny"] if options.quick else ["spheres", "bunny", "dragon", "mountain"])
    if options.quick:
        options.repeat = 1
    threads = len(os.sched_getaffinity(0))
    rows = []
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.keep or pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        for name in names:
            files = prepare(name, folder, options.assets.resolve())
            if files is None:
                print(f"{name}: {options.assets} has no {MESHES[name][0]}, left out", file=sys.stderr)
                continue
            rows += compare(name, files, options, folder, threads)
            print(f"{name} done", file=sys.stderr)
    text = measure.table(["scene, primitives", "program", "wall", "processors", "trace", "wall, POV-Ray = 1", "trace, POV-Ray = 1", "pixels unlike POV-Ray's"], rows)
    measure.publish(options.page, "compare_povray", text)


if __name__ == "__main__":
    main()
