#!/usr/bin/env python3
"""What `glint render --error` asks for and gets: realised error over asked error, for scenes, errors and seeds.

    bench/error_targets.py [--scenes a,b] [--errors 0.01,0.003] [--seeds N] [--size WxH] [--keep FILE] [--images docs/images] [--quick]

The truth of each scene is drawn by --error too, to a fifth of the least error asked for, with another seed, and its own bound is part of the table.
It is independent of what it judges, so its mean square, as its replicates show it, is taken off: otherwise 2 % of the error asked for would be its.
With --keep, each scene and error that is done is appended to FILE, and not drawn again: 19 scenes, three errors and 20 seeds take hours on two cores.
All with --within-depth: what is judged is sampling. "Fewest samples": of --spp N with the same sampler, the least N of a ladder in steps of
about 1.2, and of the powers of two, whose realised error is at most what was asked for, known afterwards; the median of three seeds. The ratio to it
is what the promise costs in samples, and the ratio of the commands' processor seconds (medians) what it costs in time. Exact bounds of the share of
runs that kept the promise are Clopper and Pearson's (1934).
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
        # A single pixel of the truth may err by several times the root mean square.
        least = min(options.error_list) / (100 if options.measure == "pixel" else 5)
        self.truth, stats, _ = self.draw("--error", least, "--seed", 4711, "--max-spp", 1 << 20)
        self.truth_bound = stats["error"]["sampling"]
        self.truth_square = stats["error"]["estimate"] ** 2 if options.measure == "rmse" else 0

    def draw(self, *arguments):
        within = ["--within-depth"] if "--error" in arguments else []
        _, seconds, out, _ = measure.run([self.options.glint, "render", self.scene, "--size", self.options.size, "-o", self.file, "-q",
                                    "--stats", "json", *within, *arguments])
        return pixels(self.file), json.loads(out), seconds

    def error_of(self, picture):
        return math.sqrt(max(rmse(picture, self.truth) ** 2 - self.truth_square, 0))

    def promised(self, error, seed):
        picture, stats, seconds = self.draw("--error", error, "--seed", seed)
        return self.error_of(picture), stats["samplesTaken"]["mean"], seconds

    def fewest(self, error, about, seed):
        """The least count of the ladder, and what it took. `about`: where to begin to look, as the error falls with every other count or so."""
        counts = [count for count in LADDER if count >= about / 8]
        for count in counts:
            picture, _, seconds = self.draw("--spp", count, "--sampler", "lowDiscrepancy", "--seed", seed)
            if self.error_of(picture) <= error:
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
    """What each error asked for gave in one scene; from options.keep where it is known."""
    done = [json.loads(line) for line in options.keep.read_text().splitlines()] if options.keep and options.keep.exists() else []
    key = {"scene": name, "size": options.size, "seeds": options.seeds}
    known = {row["error"]: row for row in done if all(row[k] == key[k] for k in key)}
    scene = None
    for error in options.error_list:
        if error in known or options.done:
            continue
        scene = scene or Scene(options, name, folder)
        realized, counts, seconds = zip(*(scene.promised(error, seed) for seed in range(options.seeds)))
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
    """What was asked for and what each scene got: the medians of its seeds, and the worst of them."""
    asked = sorted({f["error"] for f in found})
    measure.diagram(path, "Errors asked for, errors got: RMSE of the picture", "asked for", "got",
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
    # A scene that two samples satisfy says nothing about how close the promise comes.
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
