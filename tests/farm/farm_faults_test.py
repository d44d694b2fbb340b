#!/usr/bin/env python3
"""Failures while a picture is drawn in pieces, with the program as users have it: GLINT [TEST...]

A limit of a file's size stands for a full disk: the write fails in the middle, and so does every one after it.
"""
import atexit
import functools
import json
import os
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import tempfile

GLINT = os.path.abspath(sys.argv[1])
OPTIONS = ["--backend", "cpu", "--size", "128x96", "--spp", "4"]
SCENE = '{"camera": {"eye": [0, 0, 5], "target": [0, 0, 0]}, "lights": [{"type": "point", "position": [2, 3, 5]}], ' \
        '"objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1}]}'
NOBODY = 65534 if os.getuid() == 0 else None  # whom permissions mean something to


@functools.cache
def copy_for_all():
    """Another user may not run a program below /root."""
    folder = pathlib.Path(tempfile.mkdtemp())
    atexit.register(shutil.rmtree, folder)
    folder.chmod(0o755)
    return shutil.copy(GLINT, folder / "glint")


def run(*arguments, code, says="", file_bytes=None, memory=None, user=None):
    def prepare():
        if file_bytes is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (file_bytes, file_bytes))
        if memory is not None:
            resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
        if user is not None:
            os.setgid(user)
            os.setuid(user)

    ran = subprocess.run([GLINT if user is None else copy_for_all(), *map(str, arguments)], capture_output=True, text=True, preexec_fn=prepare, timeout=300)
    lines = ran.stderr.splitlines()
    if ran.returncode != code or (code != 0 and (len(lines) != 1 or says not in lines[0])):
        raise SystemExit(f"{arguments}: exit code {ran.returncode} and {ran.stderr!r}, not {code} and {says!r}")
    return ran


def check(holds, what):
    if not holds:
        raise SystemExit(f"not so: {what}")


def render(*more, **options):
    return run("render", "a.json", *OPTIONS, "-q", *more, **options)


def full_disks():
    render("-o", "whole.pfm", code=0)
    expected = pathlib.Path("whole.pfm").read_bytes()
    render("--part", "1/2", "-o", "1.part", code=1, says="1.part: cannot write: ", file_bytes=20_000)
    check(not pathlib.Path("1.part").exists(), "no half part")
    render("--checkpoint", "c.check", "-o", "again.pfm", code=1, says="c.check: cannot write: ", file_bytes=60_000)
    check(0 < pathlib.Path("c.check").stat().st_size <= 60_000, "what was finished stays")
    render("--checkpoint", "c.check", "-o", "again.pfm", code=0)
    check(pathlib.Path("again.pfm").read_bytes() == expected, "a checkpoint goes on when there is room again")
    for part in (1, 2):
        render("--part", f"{part}/2", "-o", f"{part}.part", code=0)
    for more in ([], ["--in-bands"]):
        run("merge", "1.part", "2.part", "-o", "m.pfm", *more, code=1, says="m.pfm: cannot write: ", file_bytes=20_000)
        check(not pathlib.Path("m.pfm").exists(), "no half picture")
        run("merge", "1.part", "2.part", "-o", f"m{len(more)}.pfm", *more, code=0)
        check(pathlib.Path(f"m{len(more)}.pfm").read_bytes() == expected, f"{more}: the picture of one run")


def folders_without_permission():
    render("--part", "1/1", "-o", "1.part", code=0)
    os.chmod(".", 0o777)
    os.chmod("1.part", 0o000)
    run("merge", "1.part", "-o", "m.pfm", code=1, says="1.part: cannot be read: Permission denied", user=NOBODY)
    os.chmod(".", 0o555)
    render("--checkpoint", "c.check", "-o", "/tmp/never.pfm", code=1, says="c.check: cannot write: ", user=NOBODY)
    render("--part", "1/1", "-o", "2.part", code=1, says="2.part: cannot write: ", user=NOBODY)


def huge_pictures_are_refused_before_they_are_drawn():
    huge = ["render", "a.json", "--backend", "cpu", "--size", "65536x65536", "-q"]
    memory = 2 << 30
    run(*huge, "--checkpoint", "c.check", "-o", "a.hdr", code=1, says="of memory", memory=memory)
    ran = run(*huge, "--part", "1/4", "-o", "1.part", code=1, says="part 1 of 4 (", memory=memory)
    check(re.search("takes [0-9.]+ GiB of memory, [0-9.]+ (G|M)iB are free; use more parts$", ran.stderr.strip()), ran.stderr)
    check(not [p for p in pathlib.Path(".").iterdir() if p.name != "a.json"], "nothing is left")


def pictures_larger_than_memory_are_drawn_in_units():
    """They go into the file row by row, whoever drew them when."""
    large = ["render", "a.json", "--backend", "cpu", "--size", "4096x2048", "--max-depth", "1", "-q"]
    # The whole image takes 464 MiB at once; the program itself 100 to 170 MiB of address space, by system.
    little = {"memory": 450 << 20}
    run(*large, "-o", "a.exr", code=0)
    expected = pathlib.Path("a.exr").read_bytes()
    run(*large, "--checkpoint", "c.check", "-o", "a.hdr", code=1, says="of memory", **little)
    run(*large, "--checkpoint", "c.check", "-o", "a.exr", code=1, says="c.check: cannot write: ", file_bytes=80 << 20, **little)
    check(pathlib.Path("c.check").stat().st_size > 60 << 20, "half of it is there")
    ran = run(*large, "--checkpoint", "c.check", "-o", "c.exr", "--stats", "json", code=0, **little)
    check(json.loads(ran.stdout)["bands"], ran.stdout)
    check(pathlib.Path("c.exr").read_bytes() == expected, "a checkpoint larger than memory goes on")
    parts = [f"{k}.part" for k in range(1, 5)]
    for k, part in enumerate(parts, 1):
        run(*large, "--part", f"{k}/4", "-o", part, code=0, **little)
    run("merge", *parts, "-q", "-o", "m.exr", code=0, **little)
    check(pathlib.Path("m.exr").read_bytes() == expected, "parts come together")


TESTS = [full_disks, folders_without_permission, huge_pictures_are_refused_before_they_are_drawn,
         pictures_larger_than_memory_are_drawn_in_units]
for test in [globals()[name] for name in sys.argv[2:]] or TESTS:
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        pathlib.Path("a.json").write_text(SCENE)
        test()
        print(test.__name__, "ok", flush=True)
        os.chdir("/")
        os.chmod(folder, 0o755)
