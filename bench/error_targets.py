#!/usr/bin/env python3
"""What `glint render --error` asks for and gets: realised error over asked error, for scenes, errors and seeds.

    bench/error_targets.py [--page docs/lab/error-targets.md] [--scenes a,b] [--errors 0.01,0.003] [--seeds N] [--size WxH] [--quick]

The truth of each scene is drawn by --error too, to a sixth of the least error asked for, with another seed, and its own bound is part of the table.
All with --within-depth: what is judged is sampling. "Fewest samples": of --spp N with the same sampler, the least N of a ladder in steps of
about 1.2 whose realised error is at most what was asked for, known afterwards; the ratio to it is what the promise costs. Exact bounds of the
share of runs that kept the promise are Clopper and Pearson's (1934).
"""
import array
import json
import math
import pathlib
import statistics
import tempfile

import measure

SCENES = "arcade,boxes,cabinet,checker,corridor,discs,environment,far_away,groups,horizon,instances,knot,lens,lights,polygons,quadrics,sampling,spheres,spots,triangles"


def pixels(path):
    """The floats of a colour PFM, in the file's order."""
    data = path.read_bytes()
    header, size, scale, rest = data.split(b"\n", 3)
    assert header == b"PF" and float(scale) < 0
    values = array.array("f")
    values.frombytes(rest)
    return values


def rmse(a, b):
    return math.sqrt(math.fsum((x - y) ** 2 for x, y in zip(a, b)) / len(a))


class Scene:
    def __init__(self, options, name, folder):
        self.options, self.name, self.file = options, name, folder / "a.pfm"
        self.scene = measure.ROOT / "scenes" / f"{name}.json"
        least = min(options.error_list) / 6
        self.truth, stats = self.draw("--error", least, "--seed", 4711, "--max-spp", 1 << 20)
        self.truth_bound = stats["error"]["sampling"]

    def draw(self, *arguments):
        within = ["--within-depth"] if "--error" in arguments else []
        _, _, out, _ = measure.run([self.options.glint, "render", self.scene, "--size", self.options.size, "-o", self.file, "-q",
                                    "--stats", "json", *within, *arguments])
        return pixels(self.file), json.loads(out)

    def promised(self, error, seed):
        picture, stats = self.draw("--error", error, "--seed", seed)
        return rmse(picture, self.truth), stats["error"]["samplesPerPixel"]

    def fewest(self, error):
        count = 1
        while True:
            picture, _ = self.draw("--spp", count, "--sampler", "lowDiscrepancy", "--seed", 1)
            if rmse(picture, self.truth) <= error or count > 1 << 14:
                return count
            count = max(count + 1, round(count * 1.2))


def least_share(kept, runs, tail=0.05):
    """The share p with P(at least `kept` of `runs` | p) = tail, by halving: a lower bound of the true share."""
    low, high = 0.0, 1.0
    for _ in range(60):
        p = (low + high) / 2
        above = math.fsum(math.comb(runs, k) * p**k * (1 - p) ** (runs - k) for k in range(kept, runs + 1))
        low, high = (p, high) if above < tail else (low, p)
    return low


def main():
    parser = measure.arguments(__doc__)
    parser.add_argument("--scenes", default=SCENES)
    parser.add_argument("--errors", default="0.01,0.003,0.001")
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--size", default="96x64")
    options = parser.parse_args()
    if options.quick:
        options.scenes, options.errors, options.seeds, options.size = "spheres", "0.02", 3, "32x24"
    options.error_list = [float(e) for e in options.errors.split(",")]
    rows, all_runs, all_kept, ratios, costs = [], 0, 0, [], []
    with tempfile.TemporaryDirectory() as folder:
        for name in options.scenes.split(","):
            scene = Scene(options, name, pathlib.Path(folder))
            for error in options.error_list:
                runs = [scene.promised(error, seed) for seed in range(options.seeds)]
                kept = sum(1 for realized, _ in runs if realized <= error)
                ratio = statistics.median(realized / error for realized, _ in runs)
                samples, fewest = statistics.median(count for _, count in runs), scene.fewest(error)
                all_runs, all_kept = all_runs + len(runs), all_kept + kept
                # A scene that two samples satisfy says nothing about how close the promise comes.
                if samples > 2:
                    ratios.append(ratio)
                    costs.append(samples / fewest)
                rows.append([name, f"{error:g}", f"{kept} of {len(runs)}", f"{ratio:.2f}", f"{samples:g}", fewest, f"{samples / fewest:.2f}",
                             f"{scene.truth_bound:.1g}"])
                print(" | ".join(str(c) for c in rows[-1]), flush=True)
    text = (f"{options.size}, confidence 0.95, {options.seeds} seeds each. Kept: {all_kept} of {all_runs} runs, so with 95 % confidence at least "
            f"{100 * least_share(all_kept, all_runs):.1f} % are. Where more than two samples were needed: median realised over asked "
            f"{statistics.median(ratios or [0]):.2f}, median samples over the fewest {statistics.median(costs or [0]):.2f}.\n\n"
            + measure.table(["scene", "asked", "kept", "realised / asked", "samples", "fewest", "ratio", "truth's own bound"], rows))
    measure.publish(options.page, "error_targets", text)


if __name__ == "__main__":
    main()
