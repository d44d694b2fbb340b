#!/usr/bin/env python3
"""What it brings that later bounces run over the paths that go on alone: `glint bench --compaction off` against `on` and `auto`.

    bench/compaction.py [--page docs/lab/compaction.md] [--rounds 5] [--device NAME] [--quick]

Processor time of a picture where the device is the processor, else the time of its submissions; the least of all rounds, in turns. About four
minutes on two idle cores. Pictures have to be the same to the bit.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

import measure

MODES = ["off", "on", "auto"]


def sphereflake(path):
    """Haines' sphereflake, its spheres mirrors."""
    made = subprocess.run([sys.executable, str(measure.ROOT / "bench/sphereflake.py"), "4"], capture_output=True, text=True, check=True)
    scene = json.loads(made.stdout)
    scene["materials"]["grey"]["mirror"] = 0.3
    scene["maxDepth"] = 5
    path.write_text(json.dumps(scene))


def ball(x, radius, material, height=None):
    return {"type": "sphere", "center": [x, height if height is not None else radius, 2], "radius": radius, "material": material}


def few_mirrors(path):
    """Two small mirror balls side by side on a matte floor: 2 % of the pixels go on, some of them eight times."""
    path.write_text(json.dumps({
        "image": {"width": 640, "height": 480}, "camera": {"eye": [0, 1.9, 8.5], "target": [0, 0.8, 0], "fovY": 40}, "background": [0.4, 0.55, 0.75],
        "ambient": 0.12, "maxDepth": 8, "lights": [{"type": "point", "position": [3, 6, 5], "intensity": 0.9}],
        "materials": {"red": {"diffuse": [0.8, 0.1, 0.08]}, "mirror": {"diffuse": 0.05, "mirror": 0.85}, "ground": {"diffuse": [0.55, 0.55, 0.5]}},
        "objects": [{"type": "plane", "point": [0, 0, 0], "normal": [0, 1, 0], "material": "ground"}, ball(-2.2, 1, "red"), ball(0, 0.3, "mirror"),
                    ball(0.65, 0.3, "mirror")]}))


def mirror_room(path):
    """A room of mirrors: every path goes on to the last bounce."""
    wall = lambda axis, side: {"type": "plane", "point": [side if i == axis else 0 for i in range(3)], "normal": [-side if i == axis else 0 for i in range(3)],
                               "material": "mirror"}
    path.write_text(json.dumps({
        "image": {"width": 640, "height": 480}, "camera": {"eye": [0.3, 0.2, 0.9], "target": [0, 0, -1], "fovY": 70}, "ambient": 0.12, "maxDepth": 8,
        "lights": [{"type": "point", "position": [0.1, 0.8, 0.2], "intensity": 0.9}], "materials": {"mirror": {"diffuse": 0.05, "mirror": 0.85}},
        "objects": [wall(axis, side) for axis in range(3) for side in (-1, 1)] + [{"type": "sphere", "center": [0, -0.5, 0], "radius": 0.4, "material": "mirror"}]}))


def scenes(folder, quick):
    made = {"room of mirrors": (mirror_room, "320x240"), "two small mirrors": (few_mirrors, "640x480"), "sphereflake, mirrors": (sphereflake, "512x512")}
    for i, (name, (make, size)) in enumerate(made.items()):
        path = folder / f"made{i}.json"
        make(path)
        yield name, [path, "--size", "64x48" if quick else size]
    for file, size in (("spheres", "640x480"), ("triangles", "640x480"), ("corridor", "320x240"), ("stiff/mirror_corridor", "160x120"), ("showcase", "160x120"),
                       ("glass", "160x100")):
        yield f"`{file}.json`", [measure.ROOT / f"scenes/{file}.json", "--size", "64x48" if quick else size, "--spp", "1"]


def main():
    parser = measure.arguments(__doc__)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--device", help="as of glint bench (default: the best)")
    options = parser.parse_args()
    rounds = 1 if options.quick else options.rounds
    more = ["--device", options.device] if options.device else []
    rows = []
    with tempfile.TemporaryDirectory() as name:
        for scene, arguments in scenes(pathlib.Path(name), options.quick):
            found = {mode: [] for mode in MODES}
            for _ in range(rounds):
                for mode in MODES:
                    found[mode].append(measure.bench(options.glint, *arguments, "--repeat", "3", "--compaction", mode, *more))
            last = found["auto"][-1]
            # Seconds of processors say nothing about a device of its own.
            key = "processors" if "llvmpipe" in last["driver"] else "trace"
            least = {mode: min(r["seconds"][key]["q1"] for r in found[mode]) for mode in MODES}
            same = len({r["picture"] for results in found.values() for r in results}) == 1
            full = lambda mode: f"{found[mode][-1]['paths']['live'] / found[mode][-1]['paths']['invocations'] * 100:.0f} %"
            rows.append([scene, last["maxDepth"], full("off"), full("auto"), measure.seconds(least["off"]), measure.seconds(least["on"]),
                         measure.seconds(least["auto"]), f"{least['auto'] / least['off']:.2f}", "same" if same else "**differs**"])
            print(f"{scene} done", file=sys.stderr)
    header = ["scene", "maxDepth", "lanes alive, off", "auto", f"{key}, off", "on", "auto", "auto / off", "picture"]
    measure.publish(options.page, "compaction", f"{measure.machine(last)}:\n\n" + measure.table(header, rows))


if __name__ == "__main__":
    main()
