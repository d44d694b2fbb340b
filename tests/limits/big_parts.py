#!/usr/bin/env python3
"""A picture far larger than the memory of each process, drawn by several in every way there is: big_parts.py GLINT SCENE [--mpirun MPIRUN] [WxH]

By parts, with a checkpoint and by ranks, each process under a limit of address space. All pictures must be those of one
process, which draws in bands, and no process may take more memory than the limit. Prints what each took.
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile

GIB = 1 << 30
LIMIT = 2 * GIB
PARTS = 6


def peak_of(*commands):
    """The most memory that any of the processes took, which run at once, and what they start."""
    environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    # One that waits for the commands, so that what ran before does not count.
    watch = ("import json, resource, subprocess, sys; resource.setrlimit(resource.RLIMIT_AS, (%d, %d));"
             "children = [subprocess.Popen(c) for c in json.loads(sys.argv[1])]; codes = [c.wait() for c in children];"
             "print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss); sys.exit(any(codes))") % (LIMIT, LIMIT)
    ran = subprocess.run([sys.executable, "-c", watch, json.dumps([[str(a) for a in c] for c in commands])], env=environment,
                         stdout=subprocess.PIPE, text=True)
    if ran.returncode != 0:
        sys.exit(f"big_parts.py: failed: {commands}")
    return int(ran.stdout.splitlines()[-1]) * 1024


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("glint")
    parser.add_argument("scene")
    parser.add_argument("size", nargs="?", default="65536x1024")
    parser.add_argument("--mpirun")
    arguments = parser.parse_args()
    glint, scene = os.path.abspath(arguments.glint), os.path.abspath(arguments.scene)
    width, height = map(int, arguments.size.split("x"))
    whole = width * height * 58  # as drawn, and as layers
    if whole < LIMIT:
        sys.exit("big_parts.py: the picture would fit")
    with tempfile.TemporaryDirectory(dir=os.environ.get("TMPDIR", ".")) as name:
        folder = pathlib.Path(name)
        draw = [glint, "render", scene, "--size", arguments.size, "-q"]
        parts = [folder / f"{k}.part" for k in range(1, PARTS + 1)]
        took = {"bands": peak_of([*draw, "-o", folder / "bands.exr"])}
        took["a part of six"] = max(peak_of([*draw, "--part", f"{k}/{PARTS}", "-o", part]) for k, part in enumerate(parts, 1))
        took["merge"] = peak_of([glint, "merge", *parts, "-q", "-o", folder / "merge.exr"])
        for part in parts:
            part.unlink()
        took["checkpoint"] = peak_of([*draw, "--checkpoint", folder / "check", "-o", folder / "checkpoint.exr"])
        if arguments.mpirun:
            took["mpirun"] = peak_of([arguments.mpirun, "--oversubscribe", "--bind-to", "none", "-n", "2", *draw, "-o", folder / "mpirun.exr"])
        print(f"{arguments.size}, at once {whole / GIB:.2f} GiB: " + ", ".join(f"{k} {v / GIB:.2f}" for k, v in took.items()))
        expected = (folder / "bands.exr").read_bytes()
        for path in folder.glob("*.exr"):
            if path.read_bytes() != expected:
                sys.exit(f"big_parts.py: {path.name} differs from the picture of one process")
        if max(took.values()) > LIMIT:
            sys.exit("big_parts.py: more memory than the limit")


if __name__ == "__main__":
    main()
