#!/usr/bin/env python3
"""What `glint render --error` asks for and gets: realised error over asked error, for scenes, errors and seeds.

    bench/error_targets.py [--page docs/lab/error-targets.md] [--scenes a,b] [--errors 0.01,0.003] [--seeds N] [--size WxH] [--keep FILE] [--quick]

The truth of each scene is drawn by --error too, to a fifth of the least error asked for, with another seed, and its own bound is part of the table.
With --keep, each scene and error that is done is appended to FILE, and not drawn again: 20 scenes, three errors and 20 seeds take hours on two cores.
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
        least = min(options.error_list) / 5
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


def measured(options, name, folder):
    """What each error asked for gave in one scene; from options.keep where it is known."""
    done = [json.loads(line) for line in options.keep.read_text().splitlines()] if options.keep and options.keep.exists() else []
    key = {"scene": name, "size": options.size, "seeds": options.seeds}
    known = {row["error"]: row for row in done if all(row[k] == key[k] for k in key)}
    scene = None
    for error in options.error_list:
        if error in known:
            continue
        scene = scene or Scene(options, name, folder)
        runs = [scene.promised(error, seed) for seed in range(options.seeds)]
        known[error] = {**key, "error": error, "realized": [r for r, _ in runs], "kept": sum(1 for r, _ in runs if r <= error),
                        "ratio": statistics.median(r / error for r, _ in runs), "samples": statistics.median(count for _, count in runs),
                        "fewest": scene.fewest(error), "truthBound": scene.truth_bound}
        print({k: v for k, v in known[error].items() if k != "realized"}, flush=True)
        if options.keep:
            with options.keep.open("a") as file:
                file.write(json.dumps(known[error]) + "\n")
    return [known[error] for error in options.error_list]


def main():
    parser = measure.arguments(__doc__)
    parser.add_argument("--scenes", default=SCENES)
    parser.add_argument("--errors", default="0.01,0.003,0.001")
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--size", default="96x64")
    parser.add_argument("--keep", type=pathlib.Path, help="file of what is done, to go on from after an interruption")
    options = parser.parse_args()
    if options.quick:
        options.scenes, options.errors, options.seeds, options.size = "spheres", "0.02", 3, "32x24"
    options.error_list = [float(e) for e in options.errors.split(",")]
    with tempfile.TemporaryDirectory() as folder:
        found = [row for name in options.scenes.split(",") for row in measured(options, name, pathlib.Path(folder))]
    rows = [[f["scene"], f"{f['error']:g}", f"{f['kept']} of {len(f['realized'])}", f"{f['ratio']:.2f}", f"{f['samples']:g}", f["fewest"],
             f"{f['samples'] / f['fewest']:.2f}", f"{f['truthBound']:.1g}"] for f in found]
    runs, kept = sum(len(f["realized"]) for f in found), sum(f["kept"] for f in found)
    # A scene that two samples satisfy says nothing about how close the promise comes.
    more = [f for f in found if f["samples"] > 2]
    text = (f"{options.size}, confidence 0.95, {options.seeds} seeds each. Kept: {kept} of {runs} runs, so with 95 % confidence at least "
            f"{100 * least_share(kept, runs):.1f} % are. Where more than two samples were needed: median realised over asked "
            f"{statistics.median([f['ratio'] for f in more] or [0]):.2f}, median samples over the fewest "
            f"{statistics.median([f['samples'] / f['fewest'] for f in more] or [0]):.2f}.\n\n"
            + measure.table(["scene", "asked", "kept", "realised / asked", "samples", "fewest", "ratio", "truth's own bound"], rows))
    measure.publish(options.page, "error_targets", text)


if __name__ == "__main__":
    main()
