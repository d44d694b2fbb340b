#!/usr/bin/env python3
"""Profiles the kernel of an image: samples of the processor over the machine code, by part of the shader.

    bench/kernel_profile.py [--samples 10000] [--rate 10000] [--quick] [SCENE...]

Runs `perf record -e cpu-clock` over `glint render` with a filled shader cache until the kernel has --samples samples. lavapipe's code has no
line numbers, so loops tell the parts: the machine code has those of whole.comp, nested and in order as there. A loop that all lanes leave
together exchanges halves of a vector; of such loops the innermost are the nodes' ones, first of nearest hits, then of shadow rays. Scenes that take
other kernels than whole.comp (packets) are left out. Needs perf, zstd and objdump, and makes sense on lavapipe alone.
"""
import collections
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import kernel_code
import measure

SCENES = ["instances", "boxes", "knot", "stiff/doubling_balls", "glass", "showcase", "groups", "panes", "textures", "stiff/needle_fan"]
# Kinds in the order of GLINT_PRIMITIVES (shaders/shared/primitives.h), but those that stand in no leaf.
KINDS = ["triangles", "spheres", "discs", "polygons", "quadrics", "cuboids"]
# Loops shorter than this store a row lane by lane.
SHORT = 40
HALVES = re.compile(r"v(perm(q|pd|2[fi]128)|shuf[fi]\d+x\d+)$")

NEAREST, SHADOW = "nearest hits: ", "shadow rays: "
NODES, LEAVES, BETWEEN, PLANES = "nodes", "leaves", "from nodes to leaves and back", "planes"
OUTSIDE = {"instances": "way into instances", "holes": "whether a hit is a hole", "": "the walk's beginning"}
READY = NEAREST + "rays made ready, looked at again"
CAMERA, SURFACE, LIGHTS, GOES_ON, WAITING, STORE = (
    "camera ray, start", "surface and material", "lights but for their rays", "what goes on", "rows of waiting branches", "end: rows stored")
# Outside of the kernel: what the operating system does in its threads (page faults above all), and the rest (reading back, the driver).
SYSTEM, HOST = "operating system, in the kernel's threads", "host and driver"


class Loop:
    def __init__(self, first, last):
        self.first, self.last, self.children, self.parent = first, last, [], None
        self.together = False

    def has(self, i):
        return self.first <= i <= self.last

    def all(self):
        return [self] + [x for child in self.children for x in child.all()]


def tree(code):
    """The loops of a function, the function itself at the root."""
    root = Loop(0, len(code) - 1)
    ranges = [r for r in kernel_code.loops(code) if r[1] - r[0] + 1 >= SHORT]
    for first, last in sorted(ranges, key=lambda r: (r[0], -r[1])):
        loop, parent = Loop(first, last), root
        while inner := next((c for c in parent.children if c.has(first) and c.has(last)), None):
            parent = inner
        loop.parent = parent
        parent.children.append(loop)
    for loop in root.all()[1:]:
        own = [i for i in range(loop.first, loop.last + 1) if not any(c.has(i) for c in loop.children)]
        loop.together = any(HALVES.match(code[i][1]) for i in own[-SHORT:])
    return root


def short_loops(code):
    return {i for first, last in kernel_code.loops(code) if last - first + 1 < SHORT for i in range(first, last + 1)}


class Walk:
    """Loops of one walk through the BVH: around it, around nodes and leaves, nodes."""

    def __init__(self, nodes, features):
        self.nodes = nodes
        self.outside = "instances" if "instances" in features else ("holes" if "alphaMask" in features else "")
        self.middle = nodes.parent
        self.all = self.middle.parent if self.outside else self.middle
        self.leaves = [c for c in self.middle.children if c is not nodes]

    def part(self, i, kinds):
        if self.nodes.has(i):
            return NODES
        for number, leaf in enumerate(self.leaves):
            if leaf.has(i):
                one = len(self.leaves) == len(kinds)
                return f"{LEAVES} of {kinds[number]}" if one else f"{LEAVES} of all kinds in one loop"
        return BETWEEN if self.middle.has(i) else OUTSIDE[self.outside]


def parts(code, features):
    """The part of the shader that each instruction of whole.comp belongs to, or None for other kernels."""
    root = tree(code)
    nodes = [x for x in root.all() if x.together and not any(y.together for y in x.all()[1:])]
    if len(nodes) != 2:
        return None
    kinds = [kind for kind in KINDS if kind in features]
    nearest, shadow = (Walk(x, features) for x in nodes)
    lights = shadow.all.parent
    if lights is root or nearest.all is shadow.all or not all(x.together for x in (lights, nearest.all, shadow.all)):
        return None
    steps = lights.parent  # the loop of a path's steps, or the function itself where nothing is reflected
    again = nearest.all if nearest.all.parent is steps else nearest.all.parent
    if again.parent is not steps:
        return None
    short = short_loops(code)

    def plane(i, within, end):
        return any(c.has(i) and c.last < end and not c.together for c in within.children)

    def part(i):
        if not steps.has(i):
            return CAMERA if i < steps.first else STORE
        if nearest.all.has(i):
            return NEAREST + nearest.part(i, kinds)
        if shadow.all.has(i):
            return SHADOW + shadow.part(i, kinds)
        if lights.has(i):
            return SHADOW + PLANES if "planes" in features and plane(i, lights, shadow.all.first) else LIGHTS
        if again.has(i) or i < again.first:
            if "planes" in features and (plane(i, steps, nearest.all.first) or plane(i, again, nearest.all.first)):
                return NEAREST + PLANES
            return READY if steps is not root or again.has(i) else CAMERA
        if i < lights.first:
            return SURFACE
        return STORE if steps is root else (WAITING if i in short else GOES_ON)

    return [part(i) for i in range(len(code))]


SAMPLE = re.compile(r"\s*(\d+)/(\d+)\s+([\d.]+):\s+([0-9a-f]+)")
MAPPED = re.compile(r".*PERF_RECORD_MMAP2? .*\[0x([0-9a-f]+)\(0x([0-9a-f]+)\) @ .*\]: r-xp //anon")


def record(command, environment, rate):
    """Samples (time, address, piece of anonymous code that it lies in or None, thread) of a command."""
    with tempfile.TemporaryDirectory() as folder:
        data = f"{folder}/perf.data"
        measure.run(["perf", "record", "-q", "-e", "cpu-clock", "-F", rate, "-o", data, "--", *command], environment)
        text = subprocess.run(["perf", "script", "-i", data, "--show-mmap-events", "-F", "pid,tid,time,ip"], capture_output=True, text=True).stdout
    mapped, found = [], []
    for line in text.splitlines():
        if match := MAPPED.match(line):
            start, size = int(match[1], 16), int(match[2], 16)
            mapped = [m for m in mapped if m[0] >= start + size or m[1] <= start] + [(start, start + size, len(found))]
        elif match := SAMPLE.match(line):
            address = int(match[4], 16)
            found.append((float(match[3]), address, next((m for m in mapped if m[0] <= address < m[1]), None), match[2]))
    return found


def lay_over(samples, code):
    """How many samples each instruction has, and SYSTEM and HOST while the picture is traced. The code is where all samples are at the beginning of an
    instruction."""
    starts = [address for address, _, _ in code]
    place = {address: i for i, address in enumerate(starts)}
    for piece in {p for _, _, p, _ in samples if p is not None}:
        here = [s for s in samples if s[2] == piece and starts[0] <= s[1] - piece[0] <= starts[-1]]
        if len(here) > 50 and all(s[1] - piece[0] in place for s in here):
            threads = {s[3] for s in here}
            found = collections.Counter(place[s[1] - piece[0]] for s in here)
            for _, address, p, thread in samples[samples.index(here[0]):samples.index(here[-1])]:
                if p != piece:
                    found[SYSTEM if thread in threads and address >> 63 else HOST] += 1
            return found
    return None


def main_kernel(cache):
    """The longest function that the driver has compiled."""
    functions = [code for _, elf in kernel_code.objects(cache) for _, code in kernel_code.functions(elf)]
    return max(functions, key=len)


def profile(options, scene, most):
    """Samples of each part, its instructions, and seconds of processors; None if the scene takes other kernels."""
    counted = measure.bench(options.glint, scene, "--repeat", "1")
    shares, runs = collections.Counter(), 0
    with tempfile.TemporaryDirectory() as cache:
        environment = {"MESA_SHADER_CACHE_DIR": cache}
        command = [options.glint, "render", scene, "-o", f"{cache}/picture.pfm", "--progress", "none"]
        measure.run(command, environment)
        code = main_kernel(cache)
        part = parts(code, counted["features"])
        if part is None:
            return None
        while sum(shares.values()) < most and runs < 40:
            samples = record(command, environment, options.rate)
            over = lay_over(samples, code)
            if over is None:
                sys.exit(f"{scene}: no samples lie in the kernel")
            runs += 1
            for i, n in over.items():
                shares[i if i in (SYSTEM, HOST) else part[i]] += n
    rays = {name: value["number"] for name, value in counted["rays"].items()}
    return {"scene": pathlib.Path(scene).stem, "parts": shares, "sizes": collections.Counter(part),
            "seconds": sum(shares.values()) / options.rate / runs, "machine": measure.machine(counted),
            "nearest": rays["primary"] + rays["mirrored"] + rays["refracted"], "shadow": rays["shadow"]}


def columns(found):
    """Shares of a scene in the order of HEADER."""
    total = sum(found["parts"].values())
    share = lambda take: sum(n for name, n in found["parts"].items() if take(name)) / total
    cells = []
    for ray in (NEAREST, SHADOW):
        cells += [share(lambda p: p == ray + NODES), share(lambda p: p.startswith(ray + LEAVES)),
                  share(lambda p: p.startswith(ray) and p != ray + NODES and not p.startswith(ray + LEAVES))]
    away = [share(lambda p: p == name) for name in (CAMERA, SURFACE, LIGHTS)]
    away += [share(lambda p: p in (GOES_ON, WAITING)), *(share(lambda p: p == name) for name in (STORE, SYSTEM, HOST))]
    return cells + [sum(cells)] + away + [sum(away)]


HEADER = ["scene", "processor time", "samples", "nearest: nodes", "leaves", "rest", "shadow: nodes", "leaves", "rest", "**tracing**", "camera ray", "surface",
          "lights", "what goes on", "end", "system", "host, driver", "**not tracing**"]


def percent(value):
    return f"{100 * value:.1f} %" if value else "0"


def details(found, least):
    """A part a row: its share, instructions, and nanoseconds for each ray of its sort."""
    total, rows = sum(found["parts"].values()), []
    for name, n in found["parts"].most_common():
        if n >= least * total:
            shadow = name.startswith(SHADOW) or name == LIGHTS
            each = found["seconds"] * n / total / max(1, found["shadow" if shadow else "nearest"])
            size = found["sizes"][name]
            rows.append([f"`{found['scene']}`", name, percent(n / total), size or "", f"{1e9 * each:.0f}"])
    return rows


def main():
    parser = measure.arguments(__doc__)
    parser.add_argument("--samples", type=int, default=10000, help="of the kernel and around it, at least (default 10000)")
    parser.add_argument("--rate", type=int, default=10000, help="samples of a second of processor time (default 10000)")
    parser.add_argument("scenes", nargs="*")
    options = parser.parse_args()
    scenes = options.scenes or [str(measure.ROOT / f"scenes/{name}.json") for name in SCENES]
    found, without = [], []
    for scene in scenes:
        one = profile(options, scene, 1000 if options.quick else options.samples)
        if one is None:
            without.append(f"`{pathlib.Path(scene).stem}`")
            continue
        found.append(one)
        print(one["scene"], *(percent(value) for value in columns(one)), sep=" | ", file=sys.stderr, flush=True)
    if not found:
        sys.exit("none of the scenes is drawn by whole.comp alone")
    rows = [[f"`{f['scene']}`", measure.seconds(f["seconds"]), sum(f["parts"].values()), *map(percent, columns(f))] for f in found]
    text = f"{found[0]['machine']}. Load of the machine {os.getloadavg()[2]:.0f}.\n\n" + measure.table(HEADER, rows)
    text += "\nParts with at least 4 % of a scene's samples; ns of processor time for each nearest or each shadow ray, whichever the part belongs to:\n\n"
    text += measure.table(["scene", "part", "samples", "instructions", "ns a ray"], [row for f in found for row in details(f, 0.04)])
    if without:
        text += f"\nNot drawn by `whole.comp` alone: {', '.join(without)}.\n"
    print(text)


if __name__ == "__main__":
    main()
