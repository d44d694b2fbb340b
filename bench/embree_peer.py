#!/usr/bin/env python3
"""Compares whole images with a plain Whitted tracer over Embree's single rays, and secondary rays with Embree's.

    bench/embree_peer.py [--programs build/bin] [--only pictures|secondary] [--shrink 1] [--seconds 3]
                         [--assets ../shared/assets/meshes] [--quick] [--same] [SCENE...]

The programs embree_peer and secondary_rays (-DGLINT_BENCH=ON, Debian package libembree-dev) let both contestants take turns within one process; this
prints tables with quartiles. Ratios are of processor time, which a busy machine spoils least, and of the
clock. Without SCENE, every scene of scenes/. About four minutes on two idle cores.
"""
import json
import math
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

import measure

MODELS = ["armadillo.obj", "stanford-bunny.obj", "dragon_vrip_res2.ply", "spd_mount_sf9.ply"]
# A picture that is farther from glint's than this is not the same picture: the share of pixels that are more than 1/255 apart, and RMSE.
MOST_DIFFERENT, MOST_RMSE = 0.02, 0.01


def lines(command):
    """What a program says, an object for each line, as it comes."""
    with subprocess.Popen([str(c) for c in command], stdout=subprocess.PIPE, text=True) as child:
        for line in child.stdout:
            yield json.loads(line)
        if child.wait() != 0:
            sys.exit(f"{command[0]}: ended with {child.returncode}")


def quartiles(values):
    return statistics.quantiles(values, n=4, method="inclusive")


def spread(values):
    low, mid, high = quartiles(values)
    return f"{measure.seconds(mid)} ({measure.seconds(low)} to {measure.seconds(high)})"


def mean(values):
    return math.exp(statistics.fmean(map(math.log, values)))


def ratio(theirs, ours, clock):
    return statistics.median(theirs[clock]) / statistics.median(ours[clock])


def summary(name, ratios):
    least = min(ratios)
    reached = sum(r >= 1 for r in ratios)
    return f"{name}: geometric mean {mean(ratios):.2f}, least {least:.2f}, {reached} of {len(ratios)} reach 1.0"


def pictures(options, scenes):
    rows, by_processor, by_clock, left_out, different = [], [], [], [], []
    for said in lines([options.programs / "embree_peer", "--shrink", options.shrink, "--rounds", options.rounds, "--seconds", options.seconds, *scenes]):
        name = f"`{said['scene']}`"
        if "leftOut" in said:
            left_out.append(f"{name} {said['leftOut']}")
            continue
        ours, theirs = said["glint"], said["peer"]
        r = ratio(theirs, ours, "processors"), ratio(theirs, ours, "wall")
        same = said["differ"] <= MOST_DIFFERENT and said["rmse"] <= MOST_RMSE
        if same:
            by_processor.append(r[0])
            by_clock.append(r[1])
        else:
            different.append(name)
        samples = "" if said["samples"] == 1 else f"x{said['samples']}"
        rows.append([name, f"{said['width']}x{said['height']}{samples}", spread(ours["processors"]), spread(theirs["processors"]),
                     *(f"{x:.2f}" if same else f"({x:.2f})" for x in r), f"{100 * said['differ']:.3f} %", f"{said['rmse']:.1g}"])
        print(" | ".join(rows[-1]), file=sys.stderr, flush=True)
    text = measure.table(["scene", "pixels", "glint, processors (quartiles)", "peer, processors (quartiles)", "peer / glint", "by the clock",
                          "pixels apart", "RMSE"], rows)
    if by_processor:
        text += f"\n{summary('By processors', by_processor)}. {summary('By the clock', by_clock)}."
    if different:
        text += f" Not counted, as the peer's picture is another one: {', '.join(different)}."
        if options.same:
            sys.exit(f"the peer draws another picture of {', '.join(different)}\n{text}")
    if left_out:
        text += f" Left out: {'; '.join(left_out)}."
    return text + "\n"


def secondary(options):
    with tempfile.TemporaryDirectory() as folder:
        flake = pathlib.Path(folder) / "sphereflake.json"
        flake.write_text(measure.run([sys.executable, measure.ROOT / "bench/sphereflake.py", "4"])[2])
        models = [options.assets / name for name in MODELS if (options.assets / name).exists()]
        for name in MODELS:
            if options.assets / name not in models:
                print(f"{name}: not in {options.assets}, left out", file=sys.stderr)
        size = "64x64" if options.quick else "512x512"
        rows, ratios, kind = [], {"lane": [], "best": []}, ""
        for said in lines([options.programs / "secondary_rays", "--size", size, "--rounds", 2 if options.quick else 5,
                           *models, measure.ROOT / "scenes/showcase.json", flake]):
            kind = said["class"] if said["class"] != "their shadows" else f"{kind.removesuffix(', their shadows')}, their shadows"
            embree = statistics.median(said["embree"]["processors"])
            ours = {way: embree / statistics.median(said[way]["processors"]) for way in ("lane", "packet") if way in said}
            ratios["lane"].append(ours["lane"])
            ratios["best"].append(max(ours.values()))
            low, mid, high = (2 * said["number"] / t for t in reversed(quartiles(said["embree"]["processors"])))
            rows.append([said["scene"], kind, measure.number(said["number"]), f"{mid * 1e-6:.3g} ({low * 1e-6:.3g} to {high * 1e-6:.3g})",
                         f"{ours['lane']:.2f}", f"{ours['packet']:.2f}" if "packet" in ours else "",
                         f"{ratio(said['embree'], said['lane'], 'wall'):.2f}", said["lane"]["differ"]])
            print(" | ".join(map(str, rows[-1])), file=sys.stderr, flush=True)
    text = measure.table(["scene", "rays", "number", "`rtcIntersect1`, `rtcOccluded1`, M/s (quartiles)", "single", "packets", "single, by the clock",
                          "hits that differ"], rows)
    return text + f"\n{summary('Single rays', ratios['lane'])}. {summary('The best of all', ratios['best'])}.\n"


def main():
    parser = measure.arguments(__doc__)
    parser.add_argument("--programs", type=pathlib.Path, default=measure.ROOT / "build/bin", help="folder of embree_peer and secondary_rays")
    parser.add_argument("--assets", type=pathlib.Path, default=measure.ROOT.parent / "shared/assets/meshes")
    parser.add_argument("--only", choices=["pictures", "secondary"])
    parser.add_argument("--shrink", type=float, default=1, help="divides width and height of pictures")
    parser.add_argument("--seconds", type=float, default=3, help="of a scene, after which no further round begins; two are drawn in any case")
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--same", action="store_true", help="fail if the peer draws another picture than glint")
    parser.add_argument("scenes", nargs="*")
    options = parser.parse_args()
    if options.quick:
        options.shrink, options.rounds, options.seconds = max(options.shrink, 8), 2, 0
    for program in ("embree_peer", "secondary_rays"):
        if not (options.programs / program).exists():
            sys.exit(f"{options.programs / program}: not there; configure with -DGLINT_BENCH=ON, and install libembree-dev")
    scenes = options.scenes or [s for s in sorted(measure.ROOT.glob("scenes/*.json")) + sorted(measure.ROOT.glob("scenes/stiff/*.json"))
                                if s.name != "scene.schema.json"]
    load = os.getloadavg()[0]
    if options.only != "secondary":
        print(f"Load of the machine {load:.1f}.\n\n" + pictures(options, scenes))
    if options.only != "pictures":
        print(secondary(options))


if __name__ == "__main__":
    main()
