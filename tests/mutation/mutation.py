#!/usr/bin/env python3
"""Breaks the shaders by itself, one small defect at a time, and asks verify whether it notices.

    mutation.py run JUDGE [--seed N] [--count N] [--jobs N] [--minutes N] [--results FILE] [--require SHARE] [--files NAMES] [--of FILE | --again [--cases NAMES]]
    mutation.py suite JUDGE PROGRAM [--filter TESTS] [--results FILE] [--minutes N] [--files NAMES]
    mutation.py table [--results FILE] --output PAGE.md

run: draws mutants by the seed, compiles the kernels that include the broken file, and has JUDGE (mutation_judge) compare their pictures
with the reference's. Mutants whose kernels are the same after optimisation are equivalent; those whose kernels are the same once rays and
tests are not counted (--stats, --aov cost) change counts alone, which verify does not ask for. Results are lines of JSON; a run goes on where
the last one with the same file ended. --files: of these files of shaders/ alone. --of: the mutants of another file of results whose lines
are still in the shaders, after these have changed elsewhere. --again: what survived, unless reasons.json explains it, by all cases, or by some. --require: exit with 1 if a smaller share of what is not equivalent is found.
suite: asks the tests about each mutant that verify let pass and that reasons.json does not explain: first those of PROGRAM
(render_test, stability_test), run on the mutant's kernels, then the gallery's hashes, as tools/test-drivers asks for them, by JUDGE.
table: writes what came out.
"""
import argparse
import collections
import json
import os
import re
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import page
import sites
from kernels import ARITHMETIC, KERNELS, SOURCE, WALKS, Compiler

HERE = Path(__file__).resolve().parent
# Pipelines of sound kernels, and of a mutant's whose code is the same in many cases, are found again; nothing of it goes to a disk.
MEMORY = "/dev/shm" if os.access("/dev/shm", os.W_OK) else None

# What cases see of a mutant, by how much that is.
PICTURES = ("", "same code", "same bits", "other bits")

# Cases of a walk that are asked about primitives, too: another order of what lies at one place decides what their closed intervals are for.
FOR_ALL_FILES = ("heap_spheres", "heap_ellipsoids")


def case_names(file=None):
    """All cases, or those that may judge a file."""
    lines = (line for line in (HERE / "cases.txt").read_text().splitlines() if line and not line.startswith("#"))
    walks, own = re.compile(r" (traversal|trips|stack)="), re.compile(r" own\b")
    return [line.split()[0] for line in lines if file is None or ((file in WALKS or not walks.search(line) or line.split()[0] in FOR_ALL_FILES) and
                                                                  (file == ARITHMETIC or not own.search(line)))]


class Judge:
    """A process of mutation_judge, started again when a mutant has hanged or ended it."""

    def __init__(self, program, folder, seconds, cases=HERE / "cases.txt", cache=None):
        self.command, self.seconds, self.process = [program, cases, folder / "sound"], seconds, None
        self.environment = os.environ | {"MESA_SHADER_CACHE_DIR": str(cache or folder / "cache")}
        self.before = 0.0  # processor seconds of the processes that have ended

    def used(self):
        """Processor time so far, in seconds: on a busy machine the clock tells nothing."""
        if not self.process:
            return 0
        fields = Path(f"/proc/{self.process.pid}/stat").read_text().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def spent(self):
        return self.before + self.used()

    def line(self):
        """The next line; None if the process works for `seconds` without one. It sleeps where the device never answers."""
        begin, limit = self.used(), time.monotonic() + 10 * self.seconds
        while self.process.poll() is None and self.used() - begin < self.seconds and time.monotonic() < limit:
            if select.select([self.process.stdout], [], [], 1)[0]:
                return self.process.stdout.readline()
        return None if self.process.poll() is None else b""

    def ask(self, *words):
        """The answer to a line; `why` is hang or crash where there is none."""
        if self.process is None:
            self.process = subprocess.Popen(self.command, env=self.environment, bufsize=0, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                            stderr=subprocess.DEVNULL, start_new_session=True)
            if self.line() != b"ready\n":
                raise RuntimeError("mutation_judge did not start")
        self.process.stdin.write((" ".join(map(str, words)) + "\n").encode())
        line = self.line()
        if line:
            return json.loads(line)
        self.end()
        return {"why": "hang" if line is None else "crash", "pictures": ""}

    def end(self):
        if self.process:
            self.before += self.used() if self.process.poll() is None else 0
            self.process.kill()
            self.process.wait()
        self.process = None


class Run:
    def __init__(self, arguments):
        self.arguments, self.lock, self.failure = arguments, threading.Lock(), None
        self.deadline = time.monotonic() + 60 * arguments.minutes
        self.results = page.read_results(arguments.results)
        earlier = page.read_results(arguments.of) if arguments.of else self.results
        self.sites = self.still_there(earlier) if arguments.of else sites.draw(arguments.seed, arguments.count, arguments.files.split(",") if arguments.files else None)
        # What the cases said of a mutant's pictures that are not asked again.
        self.seen = {sites.key(r): r for r in self.results if r["state"] == "survived" and arguments.cases}
        self.done = {sites.key(r) for r in self.results if r["state"] != "survived" or not arguments.again or page.reason_of(r)}
        # Cases that found mutants of a file, here or among those whose results are kept, are asked first, which saves time and nothing else; a
        # mutant of another file is likeliest found by those that found many.
        known = {sites.key(r): r for r in page.read_results(HERE / "results.jsonl") + earlier if r["state"] == "killed"}
        self.kills = collections.Counter((r["file"], r["case"]) for r in known.values())
        self.all_kills = collections.Counter(r["case"] for r in known.values())
        # That no thread has seen pass with sound kernels.
        self.unseen = arguments.cases.split(",") if arguments.cases else case_names()

    @staticmethod
    def still_there(results):
        known = sites.all_sites()
        return [known[sites.key(r)] for r in results if sites.key(r) in known]

    def cases_for(self, file):
        wanted = self.arguments.cases.split(",") if self.arguments.cases else case_names()
        with self.lock:
            return sorted((n for n in case_names(file) if n in wanted), key=lambda n: (-self.kills[file, n], -self.all_kills[n]))

    def next(self):
        with self.lock:
            while self.sites and time.monotonic() < self.deadline:
                site, description = self.sites.pop(0)
                if sites.key(description) not in self.done and (not self.arguments.cases or sites.key(description) in self.seen):
                    return site, description
        return None

    def stop(self, *_):
        """After the mutants at hand."""
        self.deadline = 0

    def record(self, result):
        with self.lock:
            self.results.append(result)
            if result["state"] == "killed":
                self.kills[result["file"], result["case"]] += 1
                self.all_kills[result["case"]] += 1
            with open(self.arguments.results, "a") as file:
                file.write(json.dumps(result) + "\n")

    def next_unseen(self):
        with self.lock:
            return self.unseen.pop(0) if self.unseen else None

    def work(self, folder):
        try:
            self.work_in(folder)
        except Exception as error:
            self.failure = error
            raise

    def work_in(self, folder):
        """A thread: its share of the cases by sound kernels, then mutants. What one compiles of a sound kernel the others find; a case that
        another thread has seen pass is drawn by sound kernels, and judged, when a mutant first needs it."""
        folder.mkdir()
        compiler = Compiler(folder)
        judge = Judge(self.arguments.program, folder, self.arguments.seconds, cache=folder.parent / "cache")
        if not compiler.compile_all(KERNELS, folder / "sound"):
            raise RuntimeError("the kernels do not compile")
        (folder / "none").mkdir()
        while case := self.next_unseen():
            if judge.ask("judge", folder / "none", case)["why"]:
                raise RuntimeError(f"sound kernels do not pass {case}")
        while drawn := self.next():
            site, description = drawn
            before = compiler.spent + judge.spent()
            compiler.break_file(site)
            try:
                result = description | self.try_one(compiler, judge, site)
                if result["state"] == "survived" and sites.key(result) in self.seen:
                    result = self.as_before(result)
            finally:
                compiler.mend(site)
            self.record(result | {"seconds": round(compiler.spent + judge.spent() - before, 2)})
        judge.end()

    def as_before(self, result):
        """With what other cases saw of it, and tests."""
        before = self.seen[sites.key(result)]
        pictures = max(result["pictures"], before["pictures"], key=PICTURES.index)
        return {k: before[k] for k in ("suite", "tests") if k in before} | result | {"pictures": pictures}

    def try_one(self, compiler, judge, site):
        sound, broken = compiler.folder / "sound", compiler.folder / "broken"
        shutil.rmtree(broken, ignore_errors=True)
        kernels = compiler.kernels_of(site.file)
        if not kernels or not compiler.compile_all(kernels, broken):
            return {"state": "invalid"}
        changed = [m for m in sorted(broken.iterdir()) if m.read_bytes() != (sound / m.name).read_bytes()]
        for module in set(broken.iterdir()) - set(changed):
            module.unlink()
        if not changed:
            return {"state": self.unchanged(compiler, site, kernels)}
        pictures = {}
        for case in self.cases_for(site.file):
            answer = judge.ask("judge", broken, case)
            pictures[case] = answer["pictures"]
            if answer["why"]:
                return {"state": "killed", "case": case, "why": answer["why"]}
        seen = max(pictures.values(), key=PICTURES.index, default="same code")
        drawn = [case for case in pictures if pictures[case] == "same bits"]
        if seen != "other bits" and not self.arguments.cases and self.equivalent(compiler, judge, broken, drawn):
            return {"state": "equivalent"}
        if seen != "other bits" and all(compiler.same_but_for_counts(m, sound / m.name) for m in broken.iterdir()):
            return {"state": "counts"}
        return {"state": "survived", "pictures": seen}

    @staticmethod
    def unchanged(compiler, site, kernels):
        """The compiler saw that it is the same, or the preprocessor had left it out: then it is in none of these kernels."""
        broken = [compiler.text(k) for k in kernels]
        compiler.mend(site)
        return "invalid" if broken == [compiler.text(k) for k in kernels] else "equivalent"

    @staticmethod
    def equivalent(compiler, judge, broken, drawn):
        """Whether an optimiser leaves the same of what the cases drawn with other code run, and of the kernels as they are."""
        pairs = compiler.folder / "pairs"
        for case in drawn:
            shutil.rmtree(pairs, ignore_errors=True)
            pairs.mkdir()
            if judge.ask("write", broken, case, pairs)["why"]:
                return False
            for module in pairs.glob("*.broken.spv"):
                if not compiler.same_after_optimisation(module, pairs / module.name.replace("broken", "sound")):
                    return False
        return all(compiler.same_after_optimisation(m, compiler.folder / "sound" / m.name, keep=True) for m in broken.iterdir())


def run(arguments):
    job = Run(arguments)
    signal.signal(signal.SIGINT, job.stop)
    signal.signal(signal.SIGTERM, job.stop)
    with tempfile.TemporaryDirectory(dir=MEMORY) as name:
        threads = [threading.Thread(target=job.work, args=(Path(name) / str(number),)) for number in range(arguments.jobs)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    if job.failure:
        return 2
    score = page.Score(page.counted(job.results))
    raw = score.tried + len(score.explained)
    shares = [(name, "{:.1%} to {:.1%}".format(*page.interval(score.killed, tried))) for name, tried in
              (("all", raw), ("those without a recorded reason", score.tried)) if tried]
    print(f"{score.summary()}; verify found {score.by_verify:.1%} of those that are not equivalent; with 95 % confidence " +
          ", ".join(f"{share} of {name}" for name, share in shares))
    for r in score.left:
        print(f"  {r['file']}:{r['line']}: {r['kind']}: `{r['was']}` -> `{r['is']}` in {r['within']}")
    return 0 if score.tried and score.by_verify >= arguments.require else 1


def write_gallery(output):
    """The gallery's pictures as cases, in the ways that tools/test-drivers draws them; their names."""
    listed = subprocess.run(["bash", SOURCE / "tools/gallery", "--list"], text=True, capture_output=True, check=True).stdout
    cases, lines = [], []
    for name, scene, size, *options in map(str.split, listed.splitlines()):
        width, height = (int(n) // 5 for n in size.split("x"))
        chosen = dict(zip(options[::2], options[1::2]))
        samples = chosen.pop("--spp")
        words = " ".join(f"{option[2:]}={value}" for option, value in chosen.items())
        ways = ["traversal=packet", "traversal=lane"]
        ways += ["own"] if name in ("spheres", "boxes", "glass") else []
        for way in ways:
            case = f"{name}:{way}"
            lines.append(f"{case} {scene} {width} {height} {samples} {words} {way}\n")
            cases.append(case)
    output.write_text("".join(lines))
    return cases


def failed_test(program, tests, kernels, seconds):
    command = [program, "--gtest_brief=1", "--gtest_fail_fast", f"--gtest_filter={tests}"]
    try:
        done = subprocess.run(command, env=os.environ | {"GLINT_TEST_KERNELS": str(kernels)}, text=True, capture_output=True, timeout=seconds)
    except subprocess.TimeoutExpired:
        return "hang"
    failed = re.findall(r"^\[  FAILED  \] (\S+?),? ", done.stdout + " ", re.M)
    return (failed[0] if failed else "crash") if done.returncode else ""


class Suite:
    def __init__(self, arguments, folder):
        self.arguments, self.compiler, self.kernels = arguments, Compiler(folder), folder / "kernels"
        self.cases = write_gallery(folder / "gallery.txt")
        self.judge = Judge(arguments.judge, folder, 60, folder / "gallery.txt")
        self.compiler.compile_all(KERNELS, folder / "sound")
        (folder / "none").mkdir()
        self.sound = {}  # hashes of the pictures that the sound kernels draw

    def check(self):
        """Whether the tests run on the kernels that they are given: on one that is none they must fail."""
        self.kernels.mkdir(parents=True)
        (self.kernels / "shade.spv").write_bytes(bytes(64))
        (self.kernels / "primitive_probe.spv").write_bytes(bytes(64))
        if not failed_test(self.arguments.program, "AnalyticTest.*:SliverTest.*:Specialize.LeavesOutMem*", self.kernels, self.arguments.seconds):
            raise RuntimeError("the tests do not run on other kernels than the program's own")

    def verdict(self, site):
        """The test that finds the mutant, or nothing."""
        shutil.rmtree(self.kernels, ignore_errors=True)
        self.compiler.break_file(site)
        kernels = [k for k in KERNELS if site.file in self.compiler.files[k]]
        self.compiler.compile_all(kernels, self.kernels)
        self.compiler.compile_probes(site.file, self.kernels)
        self.compiler.mend(site)
        tests = failed_test(self.arguments.program, self.arguments.filter, self.kernels, self.arguments.seconds)
        return tests or ("tools/gallery-hashes" if self.arguments.gallery and self.changes_gallery(site.file) else "")

    def changes_gallery(self, file):
        for case in self.cases:
            if file not in WALKS and not case.endswith(("lane", "own")):
                continue
            if case not in self.sound:
                self.sound[case] = self.judge.ask("hash", self.compiler.folder / "none", case)["hash"]
            if self.judge.ask("hash", self.kernels, case).get("hash") != self.sound[case]:
                return True
        return False


def suite(arguments):
    """Those that verify let pass, by the tests."""
    deadline = time.monotonic() + 60 * arguments.minutes
    found = sites.all_sites()
    with tempfile.TemporaryDirectory(dir=MEMORY) as name:
        tests = Suite(arguments, Path(name))
        tests.check()
        for result in page.read_results(arguments.results):
            site, _ = found.get(sites.key(result), (None, None))
            asked = result.get("suite") or arguments.filter in result.get("tests", "").split(" + ")
            if result["state"] != "survived" or asked or not site or page.reason_of(result) or time.monotonic() > deadline:
                continue
            if arguments.files and site.file not in arguments.files.split(","):
                continue
            verdict = tests.verdict(site)
            print(f"{result['file']}:{result['line']}: {result['kind']}: {verdict or 'survived'}", flush=True)
            with open(arguments.results, "a") as file:
                file.write(json.dumps(result | {"suite": verdict, "tests": " + ".join(filter(None, (result.get("tests"), arguments.filter, "gallery" * arguments.gallery)))}) + "\n")
        tests.judge.end()
    return 0


def table(arguments):
    known = sites.all_sites()
    results = [r for r in page.read_results(arguments.results) if sites.key(r) in known]
    places = collections.Counter(site.kind for site, _ in known.values())
    Path(arguments.output).write_text(page.written(results, places))
    return 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True)
    for name, function in (("run", run), ("suite", suite), ("table", table)):
        command = commands.add_parser(name)
        command.set_defaults(function=function)
        command.add_argument("--results", default="mutation.jsonl")
        if name == "table":
            command.add_argument("--output", required=True)
            continue
        command.add_argument("judge" if name == "suite" else "program")
        if name == "suite":
            command.add_argument("program")
        command.add_argument("--minutes", type=float, default=1e6)
        command.add_argument("--files", help="whose mutants are drawn or asked about, with commas between")
        command.add_argument("--seconds", type=float, default=30 if name == "run" else 600,
                             help="for a case, of processor time, or the program: then it hangs")
        if name == "run":
            command.add_argument("--seed", type=int, default=1)
            command.add_argument("--count", type=int, default=600)
            command.add_argument("--jobs", type=int, default=2)
            command.add_argument("--of", help="results whose mutants are judged anew")
            command.add_argument("--require", type=float, default=0)
            command.add_argument("--cases", help="that are asked, with commas between")
            command.add_argument("--again", action="store_true", help="try what survived again, by cases that were added since")
        else:
            command.add_argument("--filter", default="-*Mutant*:*Verdict*")
            command.add_argument("--gallery", action=argparse.BooleanOptionalAction, default=True, help="whether its pictures are asked, too")
    arguments = parser.parse_args()
    return arguments.function(arguments)


if __name__ == "__main__":
    sys.exit(main())
