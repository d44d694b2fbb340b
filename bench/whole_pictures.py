#!/usr/bin/env python3
"""Compares the time of whole images by the shaders with the reference's, scene by scene.

    bench/whole_pictures.py [--rounds 5] [--shrink 1] [--device NAME] [--quick] [--before PROGRAM] [SCENE...]

Both tracers take turns; quartiles of the seconds of tracing, on all processors. `--before`: another build of glint, whose shaders take a turn too.
`--shrink 4`: divides width and height by 4. Three rounds of all scenes take three to ten minutes on two idle cores.
"""
import math
import pathlib
import re
import statistics
import sys
import tempfile

import measure


def scenes(names):
    if names:
        return [pathlib.Path(name) for name in names]
    return sorted(measure.ROOT.glob("scenes/*.json")) + sorted(measure.ROOT.glob("scenes/stiff/*.json"))


def is_scene(path):
    return path.name != "scene.schema.json"


def size_of(glint, scene, shrink):
    width, height = re.search(r"^  image +(\d+) x (\d+)", measure.run([glint, "info", scene])[2], re.MULTILINE).groups()
    return "%dx%d" % tuple(max(8, round(int(side) / shrink)) for side in (width, height))


def trace_seconds(glint, backend, scene, size, out, device):
    more = ["--device", device] if device and backend == "gpu" else []
    wall, processors, summary, errors = measure.run(
        [glint, "render", scene, "--backend", backend, "--size", size, "-o", out, "--progress", "none", *more])
    return measure.stages(summary + errors)["trace"], wall, processors


def quartiles(values):
    return statistics.quantiles(values, n=4) if len(values) > 1 else values * 3


def main():
    parser = measure.arguments(__doc__)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--shrink", type=float, default=1)
    parser.add_argument("--device")
    parser.add_argument("--before", help="another build of glint")
    parser.add_argument("scenes", nargs="*")
    options = parser.parse_args()
    rounds, shrink = (1, max(options.shrink, 8)) if options.quick else (options.rounds, options.shrink)
    contestants = {"shaders": (options.glint, "gpu"), "reference": (options.glint, "cpu")}
    if options.before:
        contestants["before"] = (options.before, "gpu")
    rows, ratios, gains = [], [], []
    with tempfile.TemporaryDirectory() as folder:
        for scene in filter(is_scene, scenes(options.scenes)):
            size = size_of(options.glint, scene, shrink)
            found = {name: [] for name in contestants}
            for turn in range(rounds + 1):
                for name, (program, backend) in contestants.items():
                    seconds = trace_seconds(program, backend, scene, size, f"{folder}/{name}.pfm", options.device)
                    if turn > 0 or rounds == 1:  # the first fills the shader cache
                        found[name].append(seconds)
            low, mid, high = quartiles([max(s[0], 5e-4) for s in found["shaders"]])  # glint prints whole milliseconds
            reference = quartiles([s[0] for s in found["reference"]])
            ratios.append(reference[1] / mid)
            row = [f"`{scene.stem}`", size, f"{measure.seconds(mid)} ({measure.seconds(low)} to {measure.seconds(high)})",
                   f"{measure.seconds(reference[1])} ({measure.seconds(reference[0])} to {measure.seconds(reference[2])})", f"{ratios[-1]:.2f}",
                   *(measure.seconds(statistics.median(s[1] for s in found[name])) for name in ("shaders", "reference"))]
            if options.before:
                gains.append(quartiles([s[0] for s in found["before"]])[1] / mid)
                row.append(f"{gains[-1]:.2f}")
            rows.append(row)
            print(" | ".join(row), file=sys.stderr, flush=True)
    header = ["scene", "pixels", "shaders trace (quartiles)", "reference", "ratio", "shaders, shell to file", "reference, shell to file"]
    mean = lambda values: math.exp(statistics.fmean(map(math.log, values)))
    text = measure.table(header + (["before / now"] if options.before else []), rows)
    text += f"\nGeometric mean of the ratios {mean(ratios):.2f}, least {min(ratios):.2f}."
    if options.before:
        text += f" Before over now: geometric mean {mean(gains):.2f}, least {min(gains):.2f}."
    print(text + "\n")


if __name__ == "__main__":
    main()
