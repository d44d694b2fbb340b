#!/usr/bin/env python3
"""Compares the error that `glint render --error` reaches with the error asked for, over scenes, errors and seeds.

    bench/error_targets.py [--scenes a,b] [--errors 0.01,0.003] [--seeds N] [--size WxH] [--keep FILE] [--images docs/images] [--quick]

The true image of each scene is rendered by --error too, with another seed, to a fifth of the least error asked for. Its replicates estimate its own
mean square error, which is subtracted; without this, 2 % of the error asked for would be the true image's own. The table states its bound.
All runs use --within-depth, so they measure sampling alone. "Fewest": the least N for which --spp N with the same sampler reaches the error asked
for, among powers of two and steps of about 1.2; the median of three seeds. The ratios to it are the price of the guarantee in samples and, by
the medians of processor seconds, in time. Bounds of the share of runs that kept the guarantee are exact (Clopper and Pearson, 1934).
With --keep, finished pairs of scene and error are appended to FILE and not measured again: 19 scenes, three errors and 20 seeds take hours on two cores.
"""
import array
import json
import math
import pathlib
import statistics
import tempfile

import measure

SCENES = ("arcade,boxes,cabinet,checker,corridor,discs,environment,far_away,glass,groups,horizon,instances,knot,lens,lights,polygons,quadrics,"
          "spheres,spots,triangles")

LADDER = sorted({round(1.2**k) for k in range(60)} | {1 << k for k in range(16)})  # to 40,000


def pixels(path, kind=b"PF"):
    """The floats of a PFM in colour, or (b"Pf") in grey, in the file's order."""
    data = path.read_bytes()
    header, size, scale, rest = data.split(b"\n", 3)
    assert header == kind and float(scale) < 0
    values = array.array("f")
    values.frombytes(rest)
    return values


def rmse(a, b):
    return math.sqrt(math.fsum((x - y) ** 2 for x, y in zip(a, b)) / len(a))


class Scene:
    def __init__(self, options, name, folder):
        self.options, self.name, self.file = options, name, folder / "a.pfm"
        self.scene = measure.ROOT / "scenes" / f"{name}.json"
        self.truth, stats, _ = self.draw("--error", min(options.error_list) / 5, "--seed", 4711, "--max-spp", 1 << 20)
        self.truth_bound = stats["error"]["sampling"]
        self.truth_square = stats["error"]["estimate"] ** 2

    def draw(self, *arguments):
        within = ["--within-depth"] if "--error" in arguments else []
        _, seconds, out, _ = measure.run([self.options.glint, "render", self.scene, "--size", self.options.size, "-o", self.file, "-q",
                                    "--stats", "json", *within, *arguments])
        return pixels(self.file), json.loads(out), seconds

    def error_of(self, image):
        return math.sqrt(max(rmse(image, self.truth) ** 2 - self.truth_square, 0))

    def reach(self, error, seed):
        image, stats, seconds = self.draw("--error", error, "--seed", seed)
        return self.error_of(image), stats["samplesTaken"]["mean"], seconds

    def fewest(self, error, about, seed):
        """The least count of the ladder that reaches `error`, and its processor seconds. The search starts at an eighth of `about`."""
        counts = [count for count in LADDER if count >= about / 8]
        for count in counts:
            image, _, seconds = self.draw("--spp", count, "--sampler", "lowDiscrepancy", "--seed", seed)
            if self.error_of(image) <= error:
                return count, seconds
        return counts[-1], seconds


def least_share(kept, runs, tail=0.05):
    """The share p with P(at least `kept` of `runs` | p) = tail, by halving: a lower bound of the true share."""
    low, high = 0.0, 1.0
    for _ in range(60):
        p = (low + high) / 2
        above = math.fsum(math.comb(runs, k) * p**k * (1 - p) ** (runs - k) for k in range(kept, runs + 1))
        low, high = (p, high) if above < tail else (low, p)
    return low


def measured(options, name, folder):
    """A row for each error asked for in one scene, read from options.keep where it holds one."""
    done = [json.loads(line) for line in options.keep.read_text().splitlines()] if options.keep and options.keep.exists() else []
    key = {"scene": name, "size": options.size, "seeds": options.seeds}
    known = {row["error"]: row for row in done if all(row[k] == key[k] for k in key)}
    scene = None
    for error in options.error_list:
        if error in known or options.done:
            continue
        scene = scene or Scene(options, name, folder)
        realized, counts, seconds = zip(*(scene.reach(error, seed) for seed in range(options.seeds)))
        samples = statistics.median(counts)
        fewest = [scene.fewest(error, samples, seed) for seed in range(1, 4)]
        known[error] = {**key, "error": error, "realized": realized, "kept": sum(1 for r in realized if r <= error),
                        "ratio": statistics.median(r / error for r in realized), "samples": samples, "fewest": statistics.median(n for n, _ in fewest),
                        "seconds": statistics.median(seconds), "fewestSeconds": statistics.median(s for _, s in fewest), "truthBound": scene.truth_bound}
        print({k: v for k, v in known[error].items() if k != "realized"}, flush=True)
        if options.keep:
            with options.keep.open("a") as file:
                file.write(json.dumps(known[error]) + "\n")
    return [known[error] for error in options.error_list if error in known]


def draw(found, path):
    """Diagram of the errors reached against the errors asked for: median and worst seed of each scene."""
    asked = sorted({f["error"] for f in found})
    measure.diagram(path, "Errors asked for, errors got: RMSE of the image", "asked for", "got",
                    [("as much as asked for", [(e, e) for e in asked], 1), ("a scene's median run", [(f["error"], statistics.median(f["realized"])) for f in found], None),
                     ("its worst run", [(f["error"], max(f["realized"])) for f in found], None)])


def main():
    parser = measure.arguments(__doc__)
    parser.add_argument("--scenes")
    parser.add_argument("--errors")
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--size")
    parser.add_argument("--keep", type=pathlib.Path, help="file of what is done, to go on from after an interruption")
    parser.add_argument("--images", type=pathlib.Path, help="folder for the diagram, error-targets.svg")
    parser.add_argument("--done", action="store_true", help="measure nothing: the table of what --keep holds")
    options = parser.parse_args()
    if options.quick:
        options.scenes, options.errors, options.seeds, options.size = "spheres", "0.02", 3, "32x24"
    options.scenes = options.scenes or SCENES
    options.errors = options.errors or "0.01,0.003,0.001"
    options.size = options.size or "96x64"
    options.error_list = [float(e) for e in options.errors.split(",")]
    with tempfile.TemporaryDirectory() as folder:
        found = [row for name in options.scenes.split(",") for row in measured(options, name, pathlib.Path(folder))]
    over = {id(f): (f["samples"] / f["fewest"], f["seconds"] / f["fewestSeconds"]) for f in found}
    rows = [[f["scene"], f"{f['error']:g}", f"{f['kept']} of {len(f['realized'])}", f"{f['ratio']:.2f}", f"{f['samples']:.4g}", f"{f['fewest']:g}",
             *(f"{ratio:.2f}" for ratio in over[id(f)]), f"{f['truthBound']:.1g}"] for f in found]
    runs, kept = sum(len(f["realized"]) for f in found), sum(f["kept"] for f in found)
    # Scenes that need at most two samples are left out: their errors cannot come close to the bound.
    more = [f for f in found if f["samples"] > 2]
    text = (f"{options.size}, confidence 0.95, {options.seeds} seeds each. Kept: {kept} of {runs} runs, so with 95 % confidence at least "
            f"{100 * least_share(kept, runs):.1f} % are. Where more than two samples were needed: median realised over asked "
            f"{statistics.median([f['ratio'] for f in more] or [0]):.2f}, median samples over the fewest "
            f"{statistics.median([over[id(f)][0] for f in more] or [0]):.2f}, median processor time over that of the fewest "
            f"{statistics.median([over[id(f)][1] for f in more] or [0]):.2f}.\n\n"
            + measure.table(["scene", "asked", "kept", "realised / asked", "samples", "fewest", "ratio", "of time", "truth's own bound"], rows))
    print(text)
    if options.images:
        draw(found, options.images / "error-targets.svg")


if __name__ == "__main__":
    main()
