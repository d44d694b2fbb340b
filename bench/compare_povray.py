#!/usr/bin/env python3
"""Compares whole images with POV-Ray 3.7: the same mesh, camera, light and shadows, no antialiasing; time from start to exit.

    bench/compare_povray.py [--assets FOLDER] [--repeat N] [--keep FOLDER] [--quick]

Each program reads its own file (POV-Ray a translation, tests/povray/translate.py, glint the mesh's own file) and writes a PNG; runs take turns, and the
median of N (default 5) counts. `cold`: the driver's shader cache switched off. Needs povray (Debian package) and the meshes of --assets
(default ../shared/assets/meshes); missing meshes are left out. --keep: keeps the images and scenes. About four minutes on
two idle cores.
"""
import json
import math
import os
import pathlib
import re
import shutil
import statistics
import sys
import tempfile

import measure

sys.path.insert(0, str(measure.ROOT / "tests/povray"))
import meshes  # noqa: E402

SIZE = 1024
COLD = {"MESA_SHADER_CACHE_DISABLE": "true"}
AMBIENT, DIFFUSE, GREY, SKY = 0.15, 0.85, [0.7, 0.65, 0.55], [0.3, 0.45, 0.7]
# file, eye, target, up, fovY, light
MESHES = {
    "bunny": ("bun_zipper.ply", [0.0, 0.16, 0.28], [-0.017, 0.105, 0.0], [0, 1, 0], 38, [0.3, 0.6, 0.5]),
    "dragon": ("dragon_vrip_res2.ply", [0.05, 0.2, 0.3], [-0.006, 0.12, 0.0], [0, 1, 0], 38, [0.3, 0.6, 0.5]),
    "mountain": ("spd_mount_sf9.ply", [-1.6, -1.6, 1.7], [0, 0, -0.2], [0, 0, 1], 45, [-0.5, -4, 4]),
}


def scene_of(view, objects, names):
    eye, target, up, fov, light = view
    colour = [DIFFUSE * c for c in GREY]
    return {
        "image": {"width": SIZE, "height": SIZE}, "camera": {"eye": eye, "target": target, "up": up, "fovY": fov}, "background": SKY, "ambient": 1,
        "maxDepth": 0, "lights": [{"type": "point", "position": light, "intensity": 1}],
        "materials": {"m": {"diffuse": colour, "ambient": [AMBIENT * c for c in GREY]}}, "meshes": names, "objects": objects}


def scene_file(name, folder, assets):
    """glint's scene file of a case, the scene and its number of primitives; None where the mesh is not there."""
    if name == "spheres":
        balls = [([2 * math.cos(0.628 * i), 0.5 * math.sin(1.885 * i), 2 * math.sin(0.628 * i)], 0.5) for i in range(10)]
        objects = [{"type": "sphere", "center": c, "radius": r, "material": "m"} for c, r in balls]
        count, scene = len(balls), scene_of(([0, 2, 7], [0, 0, 0], [0, 1, 0], 40, [2, 5, 3]), objects, {})
    else:
        file, *view = MESHES[name]
        if not (assets / file).exists():
            return None
        count = len(meshes.read(assets / file).faces)
        scene = scene_of(view, [{"type": "mesh", "mesh": "m", "material": "m"}], {"m": {"file": os.path.relpath(assets / file, folder)}})
    ours = folder / f"{name}.json"
    ours.write_text(json.dumps(scene))
    return ours, scene, count


def prepare(name, folder, assets):
    """The two scene files of a case and its number of primitives; None where the mesh is not there."""
    import translate  # which needs numpy, as cold_start.py does not

    found = scene_file(name, folder, assets)
    if not found:
        return None
    ours, scene, count = found
    theirs = folder / f"{name}.pov"
    theirs.write_text(translate.translate(scene, folder, (SIZE, SIZE)))
    return ours, theirs, count


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
    draw = lambda out, *more: [options.glint, "render", ours, "--size", f"{size}x{size}", "-o", folder / f"{name}.{out}.png", "--progress", "none",
                               "--allow-outside", *more]
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
    print(text)


if __name__ == "__main__":
    main()
