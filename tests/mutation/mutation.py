#!/usr/bin/env python3
"""Breaks the shaders by itself, one small defect at a time, and asks verify whether it notices.

    mutation.py JUDGE [--seed N] [--count N] [--files NAMES] [--jobs N] [--minutes N] [--results FILE] [--require SHARE]

Draws mutants by the seed, compiles the kernels that include the broken file, and has JUDGE (mutation_judge) compare their images with the
reference's in the cases of cases.txt. Results are lines of JSON; a run continues where the last one with the same file ended. Survivors
that reasons.json explains are no defects. --require: exit with 1 if a smaller share of the other mutants is found.
"""
import argparse
import collections
import json
import math
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

import sites
from kernels import ARITHMETIC, KERNELS, TRAVERSAL, Compiler

HERE = Path(__file__).resolve().parent
# Compiled kernels, which are found again in many cases, are kept in memory.
MEMORY = "/dev/shm" if os.access("/dev/shm", os.W_OK) else None


def case_names(file):
    """The cases that may judge a file."""
    lines = [line for line in (HERE / "cases.txt").read_text().splitlines() if line and not line.startswith("#")]
    if file.startswith("packet"):
        return [line.split()[0] for line in lines if " traversal=packet" in line]
    if file == "primitives/textbook.glsl":
        return [line.split()[0] for line in lines if re.search(" (triangles|spheres)=", line)]
    traversal = re.compile(" (traversal|trips)=")
    return [line.split()[0] for line in lines if (file in TRAVERSAL or not traversal.search(line)) and (file == ARITHMETIC or " own" not in line)]


class Judge:
    """A process of mutation_judge, started again when a mutant has hung or ended it."""

    def __init__(self, program, folder, seconds, cache):
        self.command, self.seconds, self.process = [program, HERE / "cases.txt", folder / "sound"], seconds, None
        self.environment = os.environ | {"MESA_SHADER_CACHE_DIR": str(cache)}

    def used(self):
        """Processor time in seconds: elapsed time depends on the load of the machine."""
        fields = Path(f"/proc/{self.process.pid}/stat").read_text().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def line(self):
        """The next line, or "found: hang" after `seconds` of work without one. A device that never answers sleeps."""
        begin, limit = self.used(), time.monotonic() + 10 * self.seconds
        while self.process.poll() is None and self.used() - begin < self.seconds and time.monotonic() < limit:
            if select.select([self.process.stdout], [], [], 1)[0]:
                return self.process.stdout.readline().decode().strip() or "found: crash"
        return "found: crash" if self.process.poll() is not None else "found: hang"

    def ask(self, *words):
        if self.process is None:
            self.process = subprocess.Popen(self.command, env=self.environment, bufsize=0, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                            stderr=subprocess.DEVNULL, start_new_session=True)
            if self.line() != "ready":
                raise RuntimeError("mutation_judge did not start")
        self.process.stdin.write((" ".join(map(str, words)) + "\n").encode())
        answer = self.line()
        if answer.startswith("sound"):
            raise RuntimeError(f"{words}: {answer}")
        if answer in ("found: hang", "found: crash"):
            self.end()
        return answer

    def end(self):
        if self.process:
            self.process.kill()
            self.process.wait()
        self.process = None


class Run:
    def __init__(self, arguments):
        self.arguments, self.lock, self.failure = arguments, threading.Lock(), None
        self.deadline = time.monotonic() + 60 * arguments.minutes
        self.sites = sites.draw(arguments.seed, arguments.count, arguments.files.split(",") if arguments.files else None)
        path = Path(arguments.results)
        self.results = [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []
        self.done = {sites.key(result) for result in self.results}
        # Cases that found mutants of a file, or many mutants, are asked first, which only saves time.
        found = [result for result in self.results if result["state"] == "found"]
        self.finds = collections.Counter((result["file"], result["case"]) for result in found)
        self.all_finds = collections.Counter(result["case"] for result in found)

    def cases_for(self, file):
        with self.lock:
            return sorted(case_names(file), key=lambda name: (-self.finds[file, name], -self.all_finds[name]))

    def next(self):
        with self.lock:
            while self.sites and time.monotonic() < self.deadline:
                site, description = self.sites.pop(0)
                if sites.key(description) not in self.done:
                    return site, description
        return None

    def stop(self, *_):
        """After the mutants at hand."""
        self.deadline = 0

    def record(self, result):
        with self.lock:
            self.results.append(result)
            if result["state"] == "found":
                self.finds[result["file"], result["case"]] += 1
                self.all_finds[result["case"]] += 1
            with open(self.arguments.results, "a") as file:
                file.write(json.dumps(result) + "\n")

    def work(self, folder):
        """The body of a thread."""
        try:
            folder.mkdir()
            compiler = Compiler(folder)
            judge = Judge(self.arguments.judge, folder, self.arguments.seconds, folder.parent / "cache")
            if not compiler.compile_all(KERNELS, folder / "sound"):
                raise RuntimeError("the kernels do not compile")
            while drawn := self.next():
                site, description = drawn
                compiler.break_file(site)
                self.record(description | self.try_one(compiler, judge, site.file))
                compiler.mend(site)
            judge.end()
        except Exception as error:
            self.failure = error
            raise

    def try_one(self, compiler, judge, file):
        broken = compiler.folder / "broken"
        shutil.rmtree(broken, ignore_errors=True)
        kernels = compiler.kernels_of(file)
        if not kernels or not compiler.compile_all(kernels, broken):
            return {"state": "invalid"}
        for module in list(broken.iterdir()):
            if module.read_bytes() == (compiler.folder / "sound" / module.name).read_bytes():
                module.unlink()
        if not any(broken.iterdir()):
            return {"state": "invalid"}  # the compiler sees no difference
        seen = "same bits"
        for case in self.cases_for(file):
            answer = judge.ask(broken, case)
            if answer.startswith("found: "):
                return {"state": "found", "case": case, "why": answer.removeprefix("found: ")}
            seen = answer if answer == "other bits" else seen
        return {"state": "survived", "images": seen}


def reasons():
    """(file, text of the line, was, is): the columns of changes that are no defects, or None for all."""
    return {(entry["file"], entry["within"], was, becomes): entry.get("columns")
            for entry in json.loads((HERE / "reasons.json").read_text()) for was, becomes in entry["changes"]}


def interval(found, tried):
    """The 95 % confidence interval of a share (E. B. Wilson, J. Am. Stat. Assoc. 22(158), 1927)."""
    z = 1.96
    share, middle = found / tried, z * z / (2 * tried)
    spread = z * math.sqrt(share * (1 - share) / tried + (z / (2 * tried)) ** 2)
    return tuple((share + middle + side * spread) / (1 + z * z / tried) for side in (-1, 1))


def summary(results):
    """Prints the score; the share that verify finds of the mutants that no reason explains."""
    known = reasons()

    def explained(result):
        key = tuple(result[k] for k in ("file", "within", "was", "is"))
        return key in known and result["column"] in (known[key] or [result["column"]])

    states = collections.Counter(result["state"] for result in results)
    survivors = [result for result in results if result["state"] == "survived"]
    left = [result for result in survivors if not explained(result)]
    found, tried = states["found"], states["found"] + len(left)
    print(f"{len(results)} mutants: {dict(states)}, {len(survivors) - len(left)} of the surviving are no defects")
    for name, count in (("all", found + len(survivors)), ("those without a recorded reason", tried)):
        if count:
            print("verify found {:.1%} of {}; with 95 % confidence {:.1%} to {:.1%}".format(found / count, name, *interval(found, count)))
    for r in left:
        print(f"  {r['file']}:{r['line']}: {r['kind']}: `{r['was']}` -> `{r['is']}` in {r['within']} ({r['images']})")
    return found / tried if tried else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("judge")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=600)
    parser.add_argument("--files", help="files of shaders/ whose mutants are drawn, separated by commas (default: all)")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--minutes", type=float, default=1e6)
    parser.add_argument("--seconds", type=float, default=30, help="processor seconds for a case before it counts as a hang (default 30)")
    parser.add_argument("--results", default="mutation.jsonl")
    parser.add_argument("--require", type=float, default=0)
    arguments = parser.parse_args()
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
    return 0 if summary(job.results) >= arguments.require else 1


if __name__ == "__main__":
    sys.exit(main())
