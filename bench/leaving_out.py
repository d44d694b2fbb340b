#!/usr/bin/env python3
"""What the code of each feature costs a scene that does not use it: code, compile time, rays a second, memory.

    bench/leaving_out.py [--page docs/lab/leaving-out.md] [--traversal lane|packet|bvh4|cwbvh] [--quick]

The scene is 100,000 triangles under one light, matte: it needs nothing but triangles and pointLights. `glint bench --with FEATURE` draws it with
a pipeline that holds the code of one feature more, `--full` with that of all. SPIR-V is what the driver is given, machine instructions what
it made of it (lavapipe only; needs zstd and objdump, see kernel_code.py). About three minutes on two idle cores.
"""
import pathlib
import re
import shutil
import statistics
import sys
import tempfile

import kernel_code
import measure
import scaling

# Without mirrors and further lights: the kernels of a picture of this scene. Those that count rays come after them.
KERNELS = 4


def machine_instructions(cache):
    if shutil.which("zstd") is None or shutil.which("objdump") is None:
        return None
    sizes = []
    for _, elf in kernel_code.objects(cache):
        sizes += [sum(len(code) for name, code in kernel_code.functions(elf) if name and name.startswith("cs"))]
    return sum(sizes[:KERNELS]) or None


def measured(glint, scene, *options):
    """One cold run of `glint bench`; the cache starts empty, so compiling is cold and its objects can be counted."""
    with tempfile.TemporaryDirectory() as cache:
        result = measure.bench(glint, scene, *options, environment={"MESA_SHADER_CACHE_DIR": cache, "MESA_SHADER_CACHE_DISABLE": "false"})
        result["instructions"] = machine_instructions(cache)
    return result


def features():
    text = (measure.ROOT / "shaders/shared/dispatch.h").read_text()
    lists = text[text.index("#define GLINT_FEATURES") : text.index("#define GLINT_MODES")]
    return re.findall(r"X\(\d+, [A-Z_]+, (\w+)\)", lists)


def rate(result, kind):
    return result["rays"][kind]["perSecond"]["median"]


def row(name, result, base):
    ratio = lambda kind: f"{rate(result, kind) / 1e6:.3g} ({rate(result, kind) / rate(base, kind):.2f})"
    same = "same" if result["picture"] == base["picture"] else "**differs**"
    return [name, f"{result['bytes']['spirv'] / 1024:.0f}", result["instructions"] or "-", f"{result['seconds']['compile'] * 1e3:.0f}", ratio("primary"),
            ratio("shadow"), f"{result['seconds']['trace']['median'] * 1e3:.1f}", f"{result['seconds']['trace']['median'] / base['seconds']['trace']['median']:.2f}",
            f"{result['bytes']['hostPeak'] / 2**20:.0f}", f"{result['bytes']['device'] / 2**20:.0f}", same]


def main():
    parser = measure.arguments(__doc__)
    parser.add_argument("--traversal", default="auto")
    options = parser.parse_args()
    repeat = "3" if options.quick else "7"
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        mesh = folder / "terrain.ply"
        scaling.terrain(mesh, 10**4 if options.quick else 10**5)
        scene = scaling.terrain_scene(folder, "terrain", mesh)
        run = lambda *more: measured(options.glint, scene, "--repeat", repeat, "--traversal", options.traversal, *more)
        bases, rows = [run()], []
        extra = [f for f in features() if f not in bases[0]["features"]]
        if options.quick:
            extra = ["spheres", "transmission"]
        results = []
        for i, feature in enumerate(extra):
            results.append((feature, run("--with", feature)))
            if i == len(extra) // 2:
                bases.append(run())
            print(f"{feature} done", file=sys.stderr)
        full = run("--full")
        bases.append(run())
        # The machine's pace drifts: the pruned pipeline is measured first, in between and last.
        base = sorted(bases, key=lambda r: r["seconds"]["trace"]["median"])[len(bases) // 2]
        base["seconds"]["compile"] = statistics.median(b["seconds"]["compile"] for b in bases)
        rows = [row("**what the scene needs**", base, base)] + [row(n, r, base) for n, r in results] + [row("**everything (`--full`)**", full, base)]
    header = ["code of", "SPIR-V, KiB", "machine instructions", "compile, ms, cold", "primary, Mrays/s", "shadow, Mrays/s", "trace, ms", "times slower", "host, MiB",
              "device, MiB", "picture"]
    publish = f"{measure.machine(base)}, {base['traversal']}s, 512 x 512:\n\n" + measure.table(header, rows)
    measure.publish(options.page, "leaving_out", publish)


if __name__ == "__main__":
    main()
