"""The parts of bench/gpu, each a function that fills the part that is running."""
import json
import os
import pathlib
import platform
import re
import signal
import subprocess
import sys
import tempfile
import time

import measure
import scaling

TRAVERSALS = ["lane", "packet"]
# The part of the whole budget that is kept for writing the page.
RESERVE = 3


class TimeUp(Exception):
    """No time is left for what was asked."""


class Part:
    def __init__(self, name, seconds):
        self.name, self.deadline, self.start = name, time.monotonic() + seconds, time.monotonic()
        self.seconds, self.outcome, self.failed = 0.0, "", False
        self.failures, self.left_out, self.notes = [], [], []
        self.header, self.rows = [], []

    def left(self):
        return self.deadline - time.monotonic()

    def fail(self, what, why):
        self.failures.append(f"{what}: {' '.join(why.split())[:300]}")


class Bench:
    """One run: the program, the device, the time, and what the parts found."""

    def __init__(self, glint, device, tests, seconds):
        self.glint, self.device, self.tests = str(glint), device, tests
        self.start, self.seconds = time.monotonic(), seconds
        self.load = os.getloadavg()[0]
        self.parts, self.part = [], None
        self.info = {}  # of the device
        self.folder = tempfile.TemporaryDirectory(prefix="glint-gpu-")
        self.interrupted = False

    def left(self):
        return self.start + self.seconds - RESERVE - time.monotonic()

    def begin(self, name, share):
        self.part = Part(name, max(0.0, self.left() * share))

    def end(self):
        part = self.part
        part.seconds, part.failed = time.monotonic() - part.start, bool(part.failures)
        if part.failed:
            part.outcome = "failed: " + part.failures[0] + (f" (and {len(part.failures) - 1} more)" if len(part.failures) > 1 else "")
        part.outcome = part.outcome or ("done" if part.rows else "left out: no time")
        self.parts.append(part)
        self.part = None

    def interrupt(self, names):
        self.interrupted = True
        if self.part:
            self.part.outcome = "interrupted"
            self.end()
        done = [part.name for part in self.parts]
        self.not_begun = [name for name in names if name not in done]

    not_begun = ()

    def close(self):
        self.folder.cleanup()

    def run(self, command):
        """Exit code, standard output and standard error; ends the child and raises TimeUp when the part's time is over."""
        if self.part.left() <= 0:
            raise TimeUp
        child = subprocess.Popen([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, errors="replace", cwd=measure.ROOT)
        try:
            out, err = child.communicate(timeout=self.part.left())
        except subprocess.TimeoutExpired:
            raise TimeUp from None
        finally:
            finish(child)
        return child.returncode, out, err

    def ask(self, *arguments):
        """The JSON that a command of glint prints; None, and a failure of the part, if it prints none."""
        where = ["--device", self.device] if self.device else []
        asked = ["--json", "-"] if arguments[0] == "verify" else ["--stats", "json"]
        code, out, err = self.run([self.glint, *arguments, *where, *asked, "--progress", "none"])
        try:
            return code, json.loads(out)
        except ValueError:
            self.part.fail(named(arguments), ended(code) + ": " + (err or out)[-300:])
            return code, None

    def measure_each(self, items, work):
        """work(name, item) for each while time lasts; notes what was left out."""
        items = list(items)
        for i, (name, item) in enumerate(items):
            try:
                if self.part.left() <= 0:
                    raise TimeUp
                work(name, item)
            except TimeUp:
                self.part.left_out += [other for other, _ in items[i:]]
                return


def finish(child):
    """Kills it, and does not wait for ever: a process that hangs within a driver cannot be killed."""
    child.kill()
    try:
        child.wait(timeout=RESERVE / 2)
    except subprocess.TimeoutExpired:
        pass


def named(arguments):
    return " ".join(pathlib.Path(a).name if isinstance(a, pathlib.Path) else str(a) for a in arguments[:2])


def ended(code):
    return f"ended by signal {signal.Signals(-code).name}" if code < 0 else f"exit code {code}"


def all_scenes():
    files = (p for p in measure.ROOT.glob("scenes/**/*") if p.suffix in (".json", ".nff", ".gltf", ".stl") and not p.name.endswith(".schema.json"))
    return [(str(p.relative_to(measure.ROOT / "scenes")), p) for p in sorted(files)]


def devices(bench):
    part = bench.part
    bench.info = {"name": bench.device or "no device", "about": "", "arithmetic": "", "processor": True, "version": ""}
    code, out, err = bench.run([bench.glint, "devices"])
    version = bench.run([bench.glint, "--version"])[1].strip()
    found = re.findall(r"^(\d+)  (.*)\n((?:   .*\n?)*)", out, re.MULTILINE)
    chosen = None
    for index, name, details in found:
        part.rows.append([index, name, " / ".join(line.strip() for line in details.splitlines())])
        wanted = bench.device is not None and (bench.device == index or (not bench.device.isdigit() and bench.device.lower() in name.lower()))
        if wanted or (bench.device is None and re.search(r"^ +chosen:", details, re.MULTILINE)):
            chosen = chosen or (name, details)
    part.header = ["index", "device", "what glint says"]
    if code != 0 or chosen is None:
        part.fail("devices", (err or out or "no device").strip() if code != 0 or not found else f"no device is called {bench.device}")
        bench.info["version"] = version
        return
    name, details = chosen
    lines = [line.strip() for line in details.splitlines()]
    arithmetic = next((line.split(":", 1)[1].strip() for line in lines if line.startswith("arithmetic:")), "")
    bench.info = {"name": name, "about": lines[0] if lines else "", "arithmetic": arithmetic, "processor": bool(lines) and lines[0].startswith("CPU"),
                  "version": version}
    part.outcome = f"{len(found)} found, {name} taken"


def gallery():
    text = (measure.ROOT / "tools/gallery").read_text()
    for line in text.split("<<'LIST'\n", 1)[1].split("\nLIST\n", 1)[0].splitlines():
        name, scene, size, *more = line.split()
        yield name, (scene, [int(side) // 5 for side in size.split("x")], more)


def hashes(bench):
    part = bench.part
    known = dict(line.split() for line in (measure.ROOT / "tests/gallery_hashes.txt").read_text().splitlines())
    shares_bits = bench.info["arithmetic"].startswith("correctly rounded")
    same, other = [], []

    def draw(name, picture):
        scene, size, more = picture
        code, said = bench.ask("render", measure.ROOT / "scenes" / scene, "--size", "%dx%d" % tuple(size), *more, "-o",
                               pathlib.Path(bench.folder.name) / "a.png")
        if said is None:
            return
        (same if said["hash"] == known.get(name) else other).append(name)
        if said["hash"] != known.get(name) and shares_bits:
            part.fail(name, f"hash {said['hash']} instead of {known.get(name)}")

    bench.measure_each(gallery(), draw)
    part.header = ["pictures drawn", "of the committed hash", "of another", "which"]
    if same or other:
        part.rows.append([len(same) + len(other), len(same), len(other), ", ".join(other)])
        part.outcome = f"{len(same)} of {len(same) + len(other)} pictures have the committed bits"
    if other and not shares_bits:
        part.notes.append("This device's arithmetic promises bits of its own, so other hashes are no failure (docs/design/reproducibility.md).")


def verify(bench):
    part = bench.part
    part.header = ["traversal", "scenes", "verified", "unexplained pixels", "explained: edge", "rounding", "left out"]
    for traversal in ["auto", *TRAVERSALS]:
        sums = {key: 0 for key in ("scenes", "passed", "unexplained", "edge", "rounding")}
        before = len(part.left_out)

        def check(name, path, how=traversal, total=sums):
            code, said = bench.ask("verify", path, "--size", "160x120", "--traversal", how)
            if said is None:
                return
            result = said["scenes"][0]
            total["scenes"] += 1
            total["passed"] += result["passed"]
            for key in ("unexplained", "edge", "rounding"):
                total[key] += result["arithmetic"][key]
            if code != 0 or not result["passed"]:
                part.fail(f"{name}, --traversal {how}", result["verdict"])

        bench.measure_each(all_scenes(), check)
        missing = part.left_out[before:]
        part.left_out[before:] = [f"--traversal {traversal}: {', '.join(missing) if len(missing) < 9 else f'{len(missing)} scenes'}"] if missing else []
        if sums["scenes"]:
            part.rows.append([traversal, *sums.values(), len(missing)])
        if part.left() <= 0:
            part.left_out += [f"--traversal {later}" for later in TRAVERSALS[TRAVERSALS.index(traversal) + 1 if traversal in TRAVERSALS else 0:]]
            break
    if part.rows:
        part.outcome = f"{sum(row[2] for row in part.rows)} of {sum(row[1] for row in part.rows)} verified, {sum(row[3] for row in part.rows)} unexplained pixels"


# Programs, and those of their tests that must hold on every driver (tools/test-drivers); others ask for lavapipe.
PICTURES = "AnalyticTest.*:ArithmeticTest.*:ShadowTest.*:WatertightTest.*:TraversalTest.*:RangeTest.*"
TEST_PROGRAMS = {"app_gpu_process_tests": "*", "library_device_test": "*", "render_test": PICTURES}


def tests(bench):
    part = bench.part
    part.header = ["program", "passed", "failed", "seconds", ""]
    if bench.tests is None:
        part.outcome = "left out: --tests was not given"
        return
    programs = [(name, bench.tests.resolve() / name) for name in TEST_PROGRAMS if (bench.tests / name).is_file()]
    part.left_out += [f"{name}: not built" for name in TEST_PROGRAMS if not (bench.tests / name).is_file()]
    for i, (name, program) in enumerate(programs):
        # A share for each, so that a slow one does not take the others' time.
        seconds, start = part.left() / (len(programs) - i), time.monotonic()
        if seconds <= 1:
            part.left_out.append(name)
            continue
        log = pathlib.Path(bench.folder.name) / f"{name}.log"
        code, over = run_tests(bench, [program, "--gtest_color=no", f"--gtest_filter={TEST_PROGRAMS[name]}"], log, seconds)
        said = log.read_text(errors="replace")
        passed, failed = len(re.findall(r"^\[       OK \]", said, re.MULTILINE)), sorted(set(re.findall(r"^\[  FAILED  \] (\w[\w/]*\.[\w/]+)", said, re.MULTILINE)))
        for test in failed:
            part.fail(f"{name} {test}", "failed")
        if code != 0 and not failed and not over:
            part.fail(name, ended(code))
        part.rows.append([name, passed, len(failed), round(time.monotonic() - start), "stopped: no time left" if over else ""])
        if over:
            part.left_out.append(f"the rest of {name}")
    if part.rows:
        part.outcome = f"{sum(row[1] for row in part.rows)} tests passed"
    if bench.device:
        part.notes.append("Tests take the best device, whatever --device says.")


def run_tests(bench, command, log, seconds):
    with open(log, "w") as file:
        child = subprocess.Popen(command, stdout=file, stderr=subprocess.STDOUT, cwd=bench.folder.name)
    try:
        return child.wait(timeout=seconds), False
    except subprocess.TimeoutExpired:
        return 0, True
    finally:
        finish(child)


def timed_scenes(bench):
    """(name, arguments of bench) of what is timed. A processor draws smaller pictures, and begins with the scene whose kernels it compiles soonest."""
    small = bench.info["processor"]
    folder = pathlib.Path(bench.folder.name)
    if not (folder / "hills.ply").exists():
        scaling.terrain(folder / "hills.ply", 300_000)
    hills = ("hills, 300 k triangles", [scaling.terrain_scene(folder, "hills", folder / "hills.ply"), "--size", "256x256" if small else "2048x2048"])
    scenes = [(f"`{name}`", [measure.ROOT / f"scenes/{name}.json", "--size", "160x100" if small else "1920x1080", "--spp", "1"])
              for name in ("spheres", "showcase", "arcade", "instances", "lights", "glass")]
    return [scenes[0], hills, *scenes[1:]] if small else [hills, *scenes]


def rate(rates, kind):
    found = rates.get(kind)
    if not found or not found["median"]:
        return ""
    return f"{found['median'] * 1e-6:.4g} ({found['q1'] * 1e-6:.4g} to {found['q3'] * 1e-6:.4g})"


def traversals(bench):
    part = bench.part
    part.header = ["scene", "pixels", "traversal", "primary, Mrays/s (quartiles)", "shadow", "mirrored", "all", "picture"]

    def time_ways(name, arguments):
        code, said = bench.ask("bench", *arguments, "--traversal", "all", "--repeat", "5")
        if said is None:
            return
        result = said["scenes"][0]
        for walk in result["walks"]:
            same = walk["picture"] == result["walks"][0]["picture"]
            if not same and result["rays"]["refracted"]["number"] == 0:
                part.fail(f"{name}, {walk['traversal']}", "the image has other bits")
            part.rows.append([name, arguments[arguments.index("--size") + 1], walk["traversal"],
                              *(rate(walk["perSecond"], kind) for kind in ("primary", "shadow", "mirrored", "all")), "same" if same else "other bits"])

    bench.measure_each(timed_scenes(bench), time_ways)
    part.outcome = part.rows and f"{len({row[0] for row in part.rows})} scenes, {len(part.rows)} ways timed"
    part.notes.append("Rates are by the device's time stamps, or by the clock where it has none. Light through several dielectrics may differ in its last digits "
                      "from one traversal to another.")


def turns(bench, name, arguments, ways, rounds=2):
    """The bench results of each way, in turns, of as many rounds as there is time for; None once one fails."""
    found = {way: [] for way in ways}
    try:
        for _ in range(rounds):
            for way, more in ways.items():
                code, said = bench.ask("bench", *arguments, "--repeat", "3", *more)
                if said is None:
                    return None
                found[way].append(said["scenes"][0])
    except TimeUp:
        if not all(found.values()):
            raise
    if len({result["picture"] for results in found.values() for result in results}) > 1:
        bench.part.fail(name, "the pictures have different bits")
    return found


def least(results, key):
    return min(result["seconds"][key]["q1"] for result in results)


def in_turns(bench, scenes, ways, base):
    part = bench.part
    key = "processors" if bench.info["processor"] else "trace"
    part.header = ["scene", *(f"{way}, {key}" for way in ways), f"least / {base}"]

    def time_scene(name, arguments):
        found = turns(bench, name, arguments, ways)
        if found is not None:
            times = {way: least(results, key) for way, results in found.items()}
            part.rows.append([name, *map(measure.seconds, times.values()), f"{min(times.values()) / times[base]:.2f}"])

    bench.measure_each(scenes, time_scene)
    part.outcome = part.rows and f"{len(part.rows)} scenes"


def forms(bench):
    ways = {"one for each step": [], "one for whole paths": ["--whole-paths"], "each step, full pipeline": ["--full"]}
    in_turns(bench, timed_scenes(bench), {way: ["--traversal", "lane", *more] for way, more in ways.items()}, "one for each step")


def machine():
    try:
        text = pathlib.Path("/proc/cpuinfo").read_text()
    except OSError:
        text = ""
    model = next((line.split(":", 1)[1].strip() for line in text.splitlines() if line.startswith("model name")), platform.machine())
    return f"{os.cpu_count()} processors ({model}), {platform.system()}, Python {sys.version.split()[0]}"
