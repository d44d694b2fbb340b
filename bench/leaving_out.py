#!/usr/bin/env python3
"""Measures the price of each feature's code in a scene that does not use it: code size, compile time, rays a second, memory.

    bench/leaving_out.py [--traversal lane|packet] [--only FEATURE,...] [--quick]

The scene is 100,000 triangles under one light, matte: it needs nothing but triangles and pointLights. `glint bench --with FEATURE` draws it with
a pipeline that holds the code of one feature more, `--full` with that of all. SPIR-V is what the driver is given, machine instructions what
it made of it (lavapipe only; needs zstd and objdump, see kernel_code.py).

All take turns, several rounds of them, and every third run is of the pipeline that holds what the scene needs alone. Each run is compared with
the nearest of these in its round, so that what else the machine does meets both; the rounds' ratios have a median and quartiles. How far two
runs of the same pipeline are apart is measured in the same way: a row whose quartiles overlap those says that it is within noise. About
six minutes on two idle cores. `--only` measures some features, into a table of their own.
"""
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import tempfile

import kernel_code
import measure
import scaling

# Without mirrors and further lights: the kernels of an image of this scene. Those that count rays come after them.
KERNELS = 4


def machine_instructions(cache):
    if shutil.which("zstd") is None or shutil.which("objdump") is None:
        return None
    sizes = []
    for _, elf in kernel_code.objects(cache):
        sizes += [sum(len(code) for name, code in kernel_code.functions(elf) if name and name.startswith("cs"))]
    return sum(sizes[:KERNELS]) or None


def measured(glint, scene, cache, *options):
    """A run of `glint bench` with a cache of its own: the first one starts empty, so compiling is cold and its objects can be counted."""
    cold = not cache.exists()
    cache.mkdir(exist_ok=True)
    result = measure.bench(glint, scene, *options, environment={"MESA_SHADER_CACHE_DIR": str(cache), "MESA_SHADER_CACHE_DISABLE": "false"})
    if cold:
        result["instructions"] = machine_instructions(cache)
    return result


def features(glint, scene):
    """As the program lists them: what the scene uses, and what its pipelines leave out."""
    text = subprocess.run([glint, "info", scene], capture_output=True, text=True, check=True).stdout
    lists = re.findall(r"^  (?:features used|left out) +(.*)$", text, re.MULTILINE)
    return [name for names in lists for name in names.split(", ")]


def rate(result, kind):
    return result["rays"][kind]["perSecond"]["median"]


def processors(result):
    return result["seconds"]["processors"]["median"]


def quartiles(values):
    if len(values) < 2:
        return values[0], values[0], values[0]
    q = statistics.quantiles(values, n=4, method="inclusive")
    return q[0], q[1], q[2]


def ratios(pairs, figure):
    return quartiles([figure(run) / figure(base) for run, base in pairs])


def spread(q):
    return f"{q[1]:.2f} ({q[0]:.2f}..{q[2]:.2f})"


def verdict(times, noise):
    """Whether the quartiles of a row are apart from those of the same pipeline, measured against itself."""
    return "within noise" if times[0] <= noise[2] and noise[0] <= times[2] else "slower" if times[1] > 1 else "faster"


def row(name, first, pairs, noise):
    times = ratios(pairs, processors)
    same = "same" if all(run["picture"] == base["picture"] for run, base in pairs) else "**differs**"
    return [name, f"{first['bytes']['spirv'] / 1024:.0f}", first["instructions"] or "-", f"{first['seconds']['compile'] * 1e3:.0f}",
            spread(ratios(pairs, lambda r: rate(r, "primary"))), spread(ratios(pairs, lambda r: rate(r, "shadow"))), spread(times),
            "-" if noise is None else verdict(times, noise), f"{first['bytes']['hostPeak'] / 2**20:.0f}", f"{first['bytes']['device'] / 2**20:.0f}", same]


def take_turns(run, variants, rounds):
    """Of each variant its first run, and every run with the nearest one of the base in its round; "" is the base, paired with itself."""
    first, pairs = {}, {name: [] for name in ["", *variants]}
    for turn in range(rounds):
        order = variants[turn % len(variants):] + variants[: turn % len(variants)]
        base = run("")
        first.setdefault("", base)
        for i in range(0, len(order), 2):
            two = [(name, run(name)) for name in order[i:i + 2]]
            after = run("")
            pairs[""].append((after, base))
            for j, (name, result) in enumerate(two):
                first.setdefault(name, result)
                pairs[name].append((result, after if j == 1 else base))
            base = after
            print(f"round {turn + 1} of {rounds}: {min(i + 2, len(order))} of {len(order)}", file=sys.stderr)
    return first, pairs


def main():
    parser = measure.arguments(__doc__)
    parser.add_argument("--traversal", default="auto")
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--only", type=lambda text: text.split(","))
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        mesh = folder / "terrain.ply"
        scaling.terrain(mesh, 10**4 if options.quick else 10**5)
        scene = scaling.terrain_scene(folder, "terrain", mesh)

        def run(variant):
            code = ["--full"] if variant == "full" else ["--with", variant] if variant else []
            return measured(options.glint, scene, folder / f"cache-{variant}", "--repeat", "3", "--traversal", options.traversal, *code)

        used = run("")["features"]
        shutil.rmtree(folder / "cache-")
        extra = ["spheres", "transmission"] if options.quick else [f for f in features(options.glint, scene) if f not in used]
        extra = options.only or extra
        all_code = [] if options.only else ["full"]
        first, pairs = take_turns(run, [*extra, *all_code], 2 if options.quick else options.rounds)
    noise = ratios(pairs[""], processors)
    rows = [row("**what the scene needs**", first[""], pairs[""], None)] + [row(n, first[n], pairs[n], noise) for n in extra]
    rows += [row("**everything (`--full`)**", first[n], pairs[n], noise) for n in all_code]
    header = ["code of", "SPIR-V, KiB", "machine instructions", "compile, ms, cold", "primary rays/s", "shadow rays/s", "processor time", "verdict",
              "host, MiB", "device, MiB", "picture"]
    base, absolute = first[""], [run for run, _ in pairs[""]]
    median = lambda figure: statistics.median(figure(r) for r in absolute)
    publish = (f"{measure.machine(base)}, {base['traversal']}s, 512 x 512, {len(pairs[extra[0]])} rounds. What the scene needs: primary "
               f"{median(lambda r: rate(r, 'primary')) / 1e6:.3g}, shadow {median(lambda r: rate(r, 'shadow')) / 1e6:.3g} Mrays/s, "
               f"{median(processors) * 1e3:.3g} ms of processor time a picture; all else against it, in turns: median (quartiles).\n\n"
               + measure.table(header, rows))
    print(publish)


if __name__ == "__main__":
    main()
