#!/usr/bin/env python3
"""An image far larger than the memory of each process, rendered in every way there is: big_picture.py GLINT SCENE [--mpirun MPIRUN] [WxH]

Each process has a limit of address space, which its peak of memory must not exceed either. One process renders a PFM, a PNG and an EXR in
bands. Rows of the PFM are compared with crops that are rendered by themselves; `glint diff`, without a limit, must read the PNG and the EXR
whole and find the same image. Parts, a checkpoint and ranks must give the EXR of the one process. Prints each peak.
"""
import argparse
import os
import pathlib
import re
import subprocess
import sys
import tempfile

GIB = 1 << 30
BANDS_LIMIT, PARTS_LIMIT = 3 * GIB // 2, 2 * GIB
PARTS = 6


def peak_of(limit, *command):
    """The peak of memory of a command and of the processes that it starts, each under a limit of bytes."""
    environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    # A process of its own waits for the command, so that earlier commands do not count.
    watch = (f"import resource, subprocess, sys; resource.setrlimit(resource.RLIMIT_AS, ({limit}, {limit}));"
             "code = subprocess.call(sys.argv[1:]); print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss); sys.exit(code != 0)")
    ran = subprocess.run([sys.executable, "-c", watch, *command], env=environment, stdout=subprocess.PIPE, text=True)
    if ran.returncode != 0:
        sys.exit(f"big_picture.py: failed: {command}")
    peak = int(ran.stdout.splitlines()[-1]) * 1024
    if peak > limit:
        sys.exit(f"big_picture.py: {peak / GIB:.2f} GiB is more than the limit: {command}")
    return peak


def rows_of(path, first, count):
    """The bytes of rows from `first` on of a PFM, whose rows go from the bottom to the top."""
    with open(path, "rb") as file:
        file.readline()
        width, height = map(int, file.readline().split())
        file.readline()
        start = file.tell()
        file.seek(start + (height - first - count) * width * 12)
        return file.read(count * width * 12)


def check_bands(render, folder, width, height):
    """The image in bands, as files of three kinds."""
    for kind, most in (("exr", 0), ("png", 0.01)):  # 8 bits, and white for what is brighter
        ran = subprocess.run([render[0], "diff", folder / f"all.{kind}", folder / "all.pfm"], capture_output=True, text=True)
        found = re.match(r"RMSE ([^,]+),", ran.stdout)
        if not found or float(found[1]) > most:
            sys.exit(f"big_picture.py: all.{kind} is not all.pfm: {ran.stdout}{ran.stderr}")
    for y in (0, height // 3 // 8 * 8, height - 8):
        subprocess.run([*render, "--crop", f"0,{y},{width},{y + 8}", "-o", folder / "crop.pfm"], check=True)
        if rows_of(folder / "crop.pfm", 0, 8) != rows_of(folder / "all.pfm", y, 8):
            sys.exit(f"big_picture.py: rows from {y} on differ from those of a crop")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("glint")
    parser.add_argument("scene")
    parser.add_argument("size", nargs="?", default="65536x1024")
    parser.add_argument("--mpirun")
    arguments = parser.parse_args()
    width, height = map(int, arguments.size.split("x"))
    # Bytes of a pixel: 29 as rendered, and as many again as layers.
    if width * height * 29 < BANDS_LIMIT or width * height * 58 < PARTS_LIMIT:
        sys.exit("big_picture.py: the image would fit")
    with tempfile.TemporaryDirectory(dir=os.environ.get("TMPDIR", ".")) as name:
        folder = pathlib.Path(name)
        render = [os.path.abspath(arguments.glint), "render", os.path.abspath(arguments.scene), "--size", arguments.size, "-q"]
        took = {kind: peak_of(BANDS_LIMIT, *render, "-o", folder / f"all.{kind}") for kind in ("pfm", "png", "exr")}
        check_bands(render, folder, width, height)
        parts = [folder / f"{k}.part" for k in range(1, PARTS + 1)]
        took["a part of six"] = max(peak_of(PARTS_LIMIT, *render, "--part", f"{k}/{PARTS}", "-o", part) for k, part in enumerate(parts, 1))
        took["merge"] = peak_of(PARTS_LIMIT, render[0], "merge", *parts, "-q", "-o", folder / "merge.exr")
        for part in parts:
            part.unlink()
        took["checkpoint"] = peak_of(PARTS_LIMIT, *render, "--checkpoint", folder / "check", "-o", folder / "checkpoint.exr")
        if arguments.mpirun:
            ranks = [arguments.mpirun, "--oversubscribe", "--bind-to", "none", "-n", "2"]
            took["mpirun"] = peak_of(PARTS_LIMIT, *ranks, *render, "-o", folder / "mpirun.exr")
        print(f"{arguments.size}, at once {width * height * 29 / GIB:.2f} GiB: " + ", ".join(f"{k} {v / GIB:.2f}" for k, v in took.items()))
        expected = (folder / "all.exr").read_bytes()
        for path in folder.glob("*.exr"):
            if path.read_bytes() != expected:
                sys.exit(f"big_picture.py: {path.name} differs from the image of one process")


if __name__ == "__main__":
    main()
