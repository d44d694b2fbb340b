#!/usr/bin/env python3
"""Pictures by Open MPI's mpirun: GLINT MPIRUN SOURCE [TEST...]

What ranks do with each other is tested without MPI (ranks_test.cpp); here, that MPI carries it, and what mpirun does to processes.
"""
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time

GLINT, MPIRUN, SOURCE = map(os.path.abspath, sys.argv[1:4])
OPTIONS = ["--backend", "cpu", "--size", "256x192", "--spp", "24"]  # a second or two of work
LONG = [*OPTIONS[:-1], "2400"]
ENVIRONMENT = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1", LP_NUM_THREADS="1")
SCENE = f"{SOURCE}/scenes/showcase.json"


def mpirun(*arguments, ranks=2, more=()):
    return [MPIRUN, "--oversubscribe", "--bind-to", "none", *more, "-n", str(ranks), GLINT, *map(str, arguments)]


def by_rank(ranks, first, others, command):
    """Rank 0 runs the shell command `first` before `command`, the others `others`. (Open MPI 5.0.7 crashes at "mpirun A : B".)"""
    script = f'if [ "$OMPI_COMM_WORLD_RANK" = 0 ]; then {first}; else {others}; fi && exec "$@"'
    return [MPIRUN, "--oversubscribe", "-n", str(ranks), "sh", "-c", script, "sh", *command]


def run(command, code=0, **options):
    ran = subprocess.run(command, env=ENVIRONMENT, capture_output=True, text=True, timeout=300, **options)
    if ran.returncode != code:
        raise SystemExit(f"{' '.join(command)}: exit code {ran.returncode}, not {code}\n{ran.stdout}{ran.stderr}")
    return ran


def said(ran):
    """glint's lines of the output, without mpirun's. (Open MPI 5.0.7 writes a zero byte after its own.)"""
    lines = [line.lstrip("\0") for line in ran.stderr.splitlines()]
    return [line for line in lines if line.startswith("glint: ")]


def check(holds, what):
    if not holds:
        raise SystemExit(f"not so: {what}")


def has_the_bits_of_one_process(folder):
    run([GLINT, "render", SCENE, *OPTIONS, "-q", "-o", str(folder / "whole.pfm")])
    expected = (folder / "whole.pfm").read_bytes()
    for ranks in (2, 8):
        ran = run(mpirun("render", SCENE, *OPTIONS, "--stats", "json", "-o", folder / "all.pfm", ranks=ranks))
        stats = json.loads(ran.stdout)  # one rank speaks
        check(stats["ranks"] == ranks, stats)
        check((folder / "all.pfm").read_bytes() == expected, f"{ranks} ranks have the bits of one process")
        check(said(ran) == [], ran.stderr)


def one_machine_looks_for_no_networks(folder):
    """Unless the user says what Open MPI is to send by."""
    for more, others in (([], False), (["--mca", "pml", "^v"], True)):
        ran = run(mpirun("render", SCENE, *OPTIONS, "-q", "-o", folder / "all.pfm", more=["--mca", "pml_base_verbose", "10", *more]))
        opened = set(re.findall(r"found loaded component (\w+)", ran.stderr))
        check("ob1" in opened and (opened != {"ob1"}) == others, f"{more}: {opened}")


def devices_do_too(folder):
    options = ["--size", "160x120", "--spp", "2", "--aov", "color,depth,cost"]
    run([GLINT, "render", SCENE, *options, "-q", "-o", str(folder / "whole.exr")])
    run(mpirun("render", SCENE, *options, "-q", "-o", folder / "all.exr", ranks=3))
    check((folder / "all.exr").read_bytes() == (folder / "whole.exr").read_bytes(), "three devices have the bits of one")


def the_scene_is_read_by_rank_0_alone(folder):
    """The others are started in an empty folder, where its relative name names nothing."""
    here, there = folder / "here", folder / "there"
    here.mkdir()
    there.mkdir()
    (here / "scene.obj").write_text("mtllib scene.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n")
    (here / "scene.mtl").write_text("newmtl red\nKd 1 0 0\n")
    ask = [GLINT, "render", "scene.obj", *OPTIONS, "-q", "-o", "all.pfm"]
    run(by_rank(3, f"cd {here}", f"cd {there}", ask))
    check(list(there.iterdir()) == [], "the others write nothing")
    together = (here / "all.pfm").read_bytes()
    run([GLINT, "render", str(here / "scene.obj"), *OPTIONS, "-q", "-o", str(folder / "whole.pfm")])
    check(together == (folder / "whole.pfm").read_bytes(), "the scene is the same without its files")


def mistakes_are_said_once(folder):
    for arguments, code, text in (
            (["render", "none.json"], 3, "glint: none.json: no such file"),
            (["render", SCENE, "--spp", "none"], 2, "glint: "),
            (["render", SCENE, "-o", "none/a.png"], 1, "glint: none/a.png: cannot write: "),
            (["render", SCENE, "--device", "none such"], 4, "glint: "),
            (["render", SCENE, "--frames", "0:3", "-o", "#.png"], 2, "glint: --frames: mpirun's processes share one image"),
            (["render", SCENE, "--error", "0.1"], 2, "glint: mpirun: --error chooses the samples of the whole image")):
        ran = run(mpirun(*arguments, ranks=3), code, cwd=folder)
        check(len(said(ran)) == 1 and said(ran)[0].startswith(text), f"{arguments}: {ran.stderr}")


def one_rank_may_fail(folder):
    """Rank 1 alone has no device."""
    ask = [GLINT, "render", SCENE, "-q", "-o", str(folder / "a.pfm")]
    ran = run(by_rank(2, "true", "export VK_ICD_FILENAMES=/none VK_DRIVER_FILES=/none", ask), 4)
    check(len(said(ran)) == 1 and said(ran)[0].startswith("glint: rank 1 ("), ran.stderr)
    check(not (folder / "a.pfm").exists(), "nothing is written")


def rank_processes(folder):
    """{rank: process number} of the picture in `folder`."""
    found = {}
    for process in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            if str(folder) not in (process / "cmdline").read_text() or (process / "comm").read_text() != "glint\n":
                continue
            for variable in (process / "environ").read_bytes().split(b"\0"):
                if variable.startswith(b"OMPI_COMM_WORLD_RANK="):
                    found[int(variable.split(b"=")[1])] = int(process.name)
        except OSError:
            pass
    return found


def processor_seconds(process):
    try:
        words = pathlib.Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()
        return (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")
    except OSError:
        return 0


def start(command, folder, ranks):
    """Returns when all ranks draw. Open MPI 4.1.4 may wait for ever for one that dies while they still find each other (1 of 4 times)."""
    child = subprocess.Popen(command, env=ENVIRONMENT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    while child.poll() is None and sum(processor_seconds(p) > 0.3 for p in rank_processes(folder).values()) < ranks:
        time.sleep(0.01)
    return child


def a_killed_rank_ends_all(folder):
    child = start(mpirun("render", SCENE, *LONG, "-o", folder / "all.pfm", ranks=3), folder, 3)
    os.kill(rank_processes(folder)[2], signal.SIGKILL)
    child.communicate(timeout=60)
    check(child.returncode == 137 and not (folder / "all.pfm").exists(), f"exit code {child.returncode}")


def interrupts_end_all(folder):
    child = start(mpirun("render", SCENE, *LONG, "-o", folder / "all.pfm", ranks=3), folder, 3)
    begin = time.monotonic()
    child.send_signal(signal.SIGINT)
    child.communicate(timeout=60)
    check(time.monotonic() - begin < 20 and child.returncode != 0, "mpirun ends soon")
    check(rank_processes(folder) == {} and not (folder / "all.pfm").exists(), "nothing is left")


TESTS = [has_the_bits_of_one_process, one_machine_looks_for_no_networks, devices_do_too, the_scene_is_read_by_rank_0_alone, mistakes_are_said_once, one_rank_may_fail,
         a_killed_rank_ends_all, interrupts_end_all]
for test in [globals()[name] for name in sys.argv[4:]] or TESTS:
    with tempfile.TemporaryDirectory() as name:
        started = time.monotonic()
        test(pathlib.Path(name))
        print(f"{test.__name__}: {time.monotonic() - started:.1f} s", flush=True)
