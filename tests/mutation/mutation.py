#!/usr/bin/env python3
"""Breaks the shaders by itself, one small defect at a time, and asks verify whether it notices.

    mutation.py run JUDGE [--seed N] [--count N] [--jobs N] [--minutes N] [--results FILE] [--require SHARE]
    mutation.py suite PROGRAM [--filter TESTS] [--results FILE] [--minutes N]
    mutation.py table [--results FILE] [--output docs/lab/mutation.md]

run: draws mutants by the seed, compiles the kernels that include the broken file, and has JUDGE (mutation_judge) compare their pictures
with the reference's. Mutants whose kernels are the same after optimisation are equivalent. Results are lines of JSON; a run goes on where
the last one with the same file ended. --require: exit with 1 if a smaller share of what is not equivalent is found.
suite: has PROGRAM (render_test) run on the kernels of each mutant that verify let pass.
table: writes what came out.
"""
import argparse
import collections
import json
import os
import random
import re
import select
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import breaks

HERE = Path(__file__).resolve().parent
SOURCE = HERE.parent.parent
SHADERS = SOURCE / "shaders"

# name of KernelFolder: source, defines
KERNELS = {
    "generate": ("generate.comp", ()),
    "intersect": ("intersect.comp", ()),
    "intersect_any": ("intersect.comp", ("GLINT_ANY_HIT=1",)),
    "light": ("light.comp", ()),
    "shade": ("shade.comp", ()),
    "packet_intersect": ("packet_intersect.comp", ()),
    "packet_intersect_any": ("packet_intersect.comp", ("GLINT_ANY_HIT=1",)),
    "light_packet": ("light.comp", ("GLINT_PACKET=1",)),
    "adapt": ("adapt.comp", ()),
}
PACKET_KERNELS = ("packet_intersect", "packet_intersect_any", "light_packet")
# spirv-opt -O without what takes 20 s a kernel: functions stay functions.
OPTIMISER = ("--private-to-local --eliminate-local-single-block --eliminate-local-single-store --ssa-rewrite --ccp --simplify-instructions "
             "--eliminate-dead-branches --merge-blocks --eliminate-dead-code-aggressive --redundancy-elimination "
             "--eliminate-dead-code-aggressive --compact-ids").split()
# What verify never draws: double precision is for `glint report`.
LEFT_OUT = ("double.glsl",)

PREFIXES = {"packet.glsl": "packet", "packet_any.glsl": "packet", "packet_closest.glsl": "packet", "packet_intersect.comp": "packet"}
# Files whose code runs in some scenes alone.
SCENES = {
    "primitives/cuboid.glsl": ["boxes"],
    "primitives/disc.glsl": ["discs", "checker", "textures", "environment", "groups"],
    "primitives/polygon.glsl": ["polygons", "bow_ties", "checker", "glass", "textures", "prism", "groups", "sampling"],
    "primitives/quadric.glsl": ["quadrics", "textured_quadrics"],
    "instance.glsl": ["instances", "groups"],
    "textbook.glsl": ["barycentric", "projection", "planar3d", "algebraic", "geometric"],
    "packet.glsl": ["packet_knot", "packet_spheres", "packet_showcase", "packet_arcade"],
    "packet_any.glsl": ["packet_knot", "packet_spheres", "packet_showcase", "packet_arcade"],
    "packet_closest.glsl": ["packet_knot", "packet_spheres", "packet_showcase", "packet_arcade"],
    "packet_intersect.comp": ["packet_knot", "packet_spheres", "packet_showcase", "packet_arcade"],
    "wide_nodes.glsl": ["bvh4_knot", "bvh4_boxes", "bvh4_instances", "cwbvh_knot", "cwbvh_boxes", "cwbvh_instances"],
    "compressed.glsl": ["cwbvh_knot", "cwbvh_boxes", "cwbvh_instances"],
}
SPECIAL = {name for name, file in ((n, f) for f, names in SCENES.items() for n in names) if not file.startswith(("primitives", "instance"))}


def case_names():
    lines = (HERE / "cases.txt").read_text().splitlines()
    return [line.split()[0] for line in lines if line and not line.startswith("#")]


def spirv_passes():
    text = (SOURCE / "cmake/GlintShaders.cmake").read_text()
    return re.search(r"set\(GLINT_SPIRV_PASSES(.*?)\)", text, re.S).group(1).split()


def includes(name, seen=None):
    """All files that a shader is made of."""
    seen = set() if seen is None else seen
    if name in seen or not (SHADERS / name).exists():
        return seen
    seen.add(name)
    for included in re.findall(r'^\s*#\s*include "([^"]+)"', (SHADERS / name).read_text(), re.M):
        near = os.path.normpath(os.path.join(os.path.dirname(name), included))
        includes(near if (SHADERS / near).exists() else included, seen)
    return seen


class Compiler:
    """Kernels of a copy of the shaders in which one file at a time is broken."""

    def __init__(self, folder):
        self.folder = Path(folder)
        self.shaders = self.folder / "shaders"
        shutil.copytree(SHADERS, self.shaders)
        self.passes = spirv_passes()
        self.files = {kernel: includes(source) for kernel, (source, _) in KERNELS.items()}

    def kernels_of(self, file):
        packets = PREFIXES.get(file) == "packet"
        return [k for k in KERNELS if file in self.files[k] and (packets or k not in PACKET_KERNELS)]

    def compile(self, kernel, output, texel=True):
        source, defines = KERNELS[kernel]
        defines = [f"-D{d}" for d in defines + (("GLINT_TEXEL_LOADS=1",) if texel else ())]
        command = ["glslangValidator", "--quiet", "-V", "--target-env", "vulkan1.1", f"-I{self.shaders}", *defines, "-o", output,
                   self.shaders / source]
        if subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode:
            return False
        return subprocess.run(["spirv-opt", *self.passes, output, "-o", output], stderr=subprocess.DEVNULL).returncode == 0

    def break_file(self, site):
        (self.shaders / site.file).write_text(breaks.broken((SHADERS / site.file).read_text(), site))

    def mend(self, site):
        shutil.copyfile(SHADERS / site.file, self.shaders / site.file)

    def optimised(self, module):
        """The module as an optimiser leaves it, without names: equal for equivalent code, if it sees that."""
        output = self.folder / "optimised.spv"
        subprocess.run(["spirv-opt", "--strip-debug", *OPTIMISER, module, "-o", output], check=True)
        return output.read_bytes()


class Judge:
    """A process of mutation_judge, started again when a mutant has hanged or ended it."""

    def __init__(self, program, seconds):
        self.command, self.seconds, self.process = [program, str(HERE / "cases.txt")], seconds, None

    def used(self):
        """Processor time so far, in seconds: on a busy machine the clock tells nothing."""
        fields = Path(f"/proc/{self.process.pid}/stat").read_text().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def line(self):
        """The next line; None if the process works for `seconds` without one. It sleeps where the device never answers."""
        begin, limit = self.used(), time.monotonic() + 10 * self.seconds
        while self.process.poll() is None and self.used() - begin < self.seconds and time.monotonic() < limit:
            if select.select([self.process.stdout], [], [], 1)[0]:
                return self.process.stdout.readline()
        return None if self.process.poll() is None else b""

    def ask(self, folder, cases):
        if self.process is None:
            self.process = subprocess.Popen(self.command, bufsize=0, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                            stderr=subprocess.DEVNULL)
            if self.line() != b"ready\n":
                raise RuntimeError("mutation_judge did not start")
        for case in cases:
            self.process.stdin.write(f"{folder} {case}\n".encode())
            line = self.line()
            if not line:
                self.end()
                return {"case": case, "why": "hang" if line is None else "crash"}
            if json.loads(line)["why"]:
                return json.loads(line)
        return {"case": "", "why": ""}

    def end(self):
        if self.process:
            self.process.kill()
            self.process.wait()
        self.process = None


def draw_sites(seed, count):
    """`count` sites, kinds in turns, so that each has its share, and at random within."""
    generator = random.Random(seed)
    files = sorted(str(f.relative_to(SHADERS)) for f in SHADERS.rglob("*") if f.suffix in (".glsl", ".comp"))
    kinds = collections.defaultdict(list)
    for file in files:
        if file not in LEFT_OUT:
            for site in breaks.sites_of(file, (SHADERS / file).read_text()):
                kinds[site.kind].append(site)
    for sites in kinds.values():
        generator.shuffle(sites)
    drawn = []
    while len(drawn) < count and any(kinds.values()):
        for kind in sorted(kinds):
            if kinds[kind]:
                drawn.append(kinds[kind].pop())
    return drawn[:count]


def describe(site):
    text = (SHADERS / site.file).read_text()
    line = text.count("\n", 0, site.start) + 1
    return {"file": site.file, "line": line, "kind": site.kind, "was": " ".join(text[site.start:site.end].split()),
            "is": " ".join(site.replacement.split()), "start": site.start, "within": text.splitlines()[line - 1].strip()}


class Run:
    def __init__(self, arguments):
        self.arguments, self.lock = arguments, threading.Lock()
        self.deadline = time.monotonic() + 60 * arguments.minutes
        self.sites = draw_sites(arguments.seed, arguments.count)
        self.results = read_results(arguments.results)
        self.done = {(r["file"], r["start"], r["kind"], r["is"]) for r in self.results}
        self.kills = collections.Counter((r["file"], r["case"]) for r in self.results if r["state"] == "killed")
        self.all_cases = case_names()
        self.optimised = {}  # of the sound kernels

    def cases_for(self, file):
        names = SCENES.get(file) or [n for n in self.all_cases if n not in SPECIAL]
        return sorted(names, key=lambda n: -self.kills[file, n])

    def next(self):
        with self.lock:
            while self.sites and time.monotonic() < self.deadline:
                site = self.sites.pop(0)
                key = describe(site)
                if (key["file"], key["start"], key["kind"], key["is"]) not in self.done:
                    return site
        return None

    def record(self, result):
        with self.lock:
            self.results.append(result)
            if result["state"] == "killed":
                self.kills[result["file"], result["case"]] += 1
            with open(self.arguments.results, "a") as file:
                file.write(json.dumps(result) + "\n")

    def work(self):
        with tempfile.TemporaryDirectory() as folder:
            compiler, judge = Compiler(folder), Judge(self.arguments.program, self.arguments.seconds)
            sound = Path(folder) / "sound"
            sound.mkdir()
            for kernel in KERNELS:
                if not compiler.compile(kernel, sound / f"{kernel}.spv"):
                    raise RuntimeError(f"{kernel} does not compile")
            while site := self.next():
                begin = time.monotonic()
                compiler.break_file(site)
                result = describe(site) | self.try_one(compiler, judge, sound, site)
                compiler.mend(site)
                self.record(result | {"seconds": round(time.monotonic() - begin, 2)})
            judge.end()

    def try_one(self, compiler, judge, sound, site):
        broken = compiler.folder / "broken"
        shutil.rmtree(broken, ignore_errors=True)
        broken.mkdir()
        for kernel in compiler.kernels_of(site.file):
            module = broken / f"{kernel}.spv"
            if not compiler.compile(kernel, module):
                return {"state": "invalid"}
            if module.read_bytes() == (sound / module.name).read_bytes():
                module.unlink()
        if not list(broken.iterdir()):
            return {"state": "equivalent"}
        answer = judge.ask(broken, self.cases_for(site.file))
        if answer["why"]:
            return {"state": "killed"} | answer
        for module in broken.iterdir():
            if module.name not in self.optimised:
                self.optimised[module.name] = compiler.optimised(sound / module.name)
            if compiler.optimised(module) != self.optimised[module.name]:
                return {"state": "survived"}
        return {"state": "equivalent"}


def read_results(file):
    path = Path(file)
    return [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []


def run(arguments):
    job = Run(arguments)
    threads = [threading.Thread(target=job.work) for _ in range(arguments.jobs)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    states = collections.Counter(r["state"] for r in job.results)
    tried = states["killed"] + states["survived"]
    share = states["killed"] / tried if tried else 0
    print(f"{sum(states.values())} mutants: {dict(states)}; verify found {share:.1%} of those that are not equivalent")
    for r in job.results:
        if r["state"] == "survived":
            print(f"  {r['file']}:{r['line']}: {r['kind']}: `{r['was']}` -> `{r['is']}` in {r['within']}")
    return 0 if tried and share >= arguments.require else 1


def suite(arguments):
    """Those that verify let pass, by the tests of a program."""
    results = read_results(arguments.results)
    deadline = time.monotonic() + 60 * arguments.minutes
    with tempfile.TemporaryDirectory() as folder:
        compiler = Compiler(folder)
        for result in results:
            if result["state"] != "survived" or "suite" in result or time.monotonic() > deadline:
                continue
            text = (SHADERS / result["file"]).read_text()
            site = next(s for s in breaks.sites_of(result["file"], text)
                        if (s.start, s.kind, describe(s)["is"]) == (result["start"], result["kind"], result["is"]))
            kernels = Path(folder) / "kernels"
            shutil.rmtree(kernels, ignore_errors=True)
            compiler.break_file(site)
            for access in ("texel", "storage"):
                (kernels / access).mkdir(parents=True)
                for kernel in [k for k in KERNELS if site.file in compiler.files[k]]:
                    compiler.compile(kernel, kernels / access / f"{kernel}.spv", access == "texel")
            compiler.mend(site)
            command = [arguments.program, "--gtest_brief=1", "--gtest_fail_fast", f"--gtest_filter={arguments.filter}"]
            try:
                done = subprocess.run(command, env=os.environ | {"GLINT_TEST_KERNELS": str(kernels)}, text=True, capture_output=True,
                                      timeout=arguments.seconds)
                failed = re.findall(r"^\[  FAILED  \] (\S+?),? ", done.stdout + " ", re.M)
                result["suite"] = (failed[0] if failed else "crash") if done.returncode else ""
            except subprocess.TimeoutExpired:
                result["suite"] = "hang"
            print(f"{result['file']}:{result['line']}: {result['kind']}: {result['suite'] or 'survived'}", flush=True)
            Path(arguments.results).write_text("".join(json.dumps(r) + "\n" for r in results))
    return 0


def counts_by(results, key):
    groups = collections.defaultdict(collections.Counter)
    for result in results:
        groups[result[key]][result["state"]] += 1
        groups[result[key]]["suite"] += bool(result.get("suite"))
    return sorted(groups.items())


def share(part, whole):
    return f"{100 * part / whole:.1f} %" if whole else "-"


def table(arguments):
    results = [r for r in read_results(arguments.results) if r["state"] != "invalid"]
    total = collections.Counter(r["state"] for r in results)
    tried = total["killed"] + total["survived"]
    by_suite = sum(bool(r.get("suite")) for r in results)
    asked = sum("suite" in r for r in results)
    why = collections.Counter(r["why"] for r in results if r["state"] == "killed")
    out = ["# Mutation score", "",
           "Would `glint verify` notice a defect that nobody thought of? `tests/mutation/mutation.py` breaks the shaders by itself, one small "
           "defect at a time,", "compiles the kernels that include the broken file, and has them drawn and verified on the scenes of "
           "`tests/mutation/cases.txt`. Sites are drawn by a seed,", "kinds of defects in turns. This page is written by the script:", "",
           "```", "tests/mutation/mutation.py run build/bin/mutation_judge --seed 1 --count N --results mutation.jsonl",
           "tests/mutation/mutation.py suite build/bin/render_test --results mutation.jsonl",
           "tests/mutation/mutation.py table --results mutation.jsonl", "```", "",
           f"{len(results)} mutants; {total['equivalent']} are equivalent: their kernels are the same, byte for byte, after spirv-opt. "
           f"Of the {tried} others `verify` alone finds {total['killed']}, **{share(total['killed'], tried)}**", "(" +
           ", ".join(f"{n} {w}" for w, n in why.most_common()) + ")." +
           (f" Of the {total['survived']} that it lets pass, {asked} were given to the GPU tests, which find {by_suite}: "
            f"**{share(total['killed'] + by_suite, tried)}** together." if asked else ""), "",
           "| kind | mutants | equivalent | found by verify | by the tests | left |", "|---|---|---|---|---|---|"]
    for name, key in (("kind", "kind"), ("file", "file")):
        if name == "file":
            out += ["", "| file | mutants | equivalent | found by verify | by the tests | left |", "|---|---|---|---|---|---|"]
        for value, c in counts_by(results, key):
            alive = c["killed"] + c["survived"]
            out.append(f"| {value} | {alive + c['equivalent']} | {c['equivalent']} | {c['killed']} ({share(c['killed'], alive)}) | "
                       f"{c['suite']} | {c['survived'] - c['suite']} |")
    out += ["", "## What verify lets pass", "", "Not all of these are defects that a picture could show: bounds that are wider, guards against 0, values "
            "that nobody reads.", "The optimiser does not see that, so they count.", "", "| where | was | is | found by the tests | |", "|---|---|---|---|---|"]
    notes = json.loads((HERE / "notes.json").read_text()) if (HERE / "notes.json").exists() else {}
    code = lambda text: f"`{text}`".replace("|", "\\|") if text else ""
    for r in results:
        if r["state"] == "survived":
            where = f"{r['file']}:{r['line']} {code(r['within'])}"
            note = notes.get(f"{r['file']}|{r['within']}|{r['is']}", "")
            out.append(f"| {where} | {code(r['was'])} | {code(r['is'])} | {r.get('suite', 'not asked') or 'no'} | {note} |")
    Path(arguments.output).write_text("\n".join(out) + "\n")
    return 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True)
    for name, function in (("run", run), ("suite", suite), ("table", table)):
        command = commands.add_parser(name)
        command.set_defaults(function=function)
        command.add_argument("--results", default="mutation.jsonl")
        if name == "table":
            command.add_argument("--output", default=SOURCE / "docs/lab/mutation.md")
            continue
        command.add_argument("program")
        command.add_argument("--minutes", type=float, default=1e6)
        command.add_argument("--seconds", type=float, default=30 if name == "run" else 600, help="for a case, of processor time, or the program: then it hangs")
        if name == "run":
            command.add_argument("--seed", type=int, default=1)
            command.add_argument("--count", type=int, default=600)
            command.add_argument("--jobs", type=int, default=2)
            command.add_argument("--require", type=float, default=0)
        else:
            command.add_argument("--filter", default="-*Mutant*:*Verdict*")
    arguments = parser.parse_args()
    return arguments.function(arguments)


if __name__ == "__main__":
    sys.exit(main())
