#!/usr/bin/env python3
"""A picture far larger than the memory that it is given, drawn in bands: big_picture.py GLINT SCENE [WxH]

Renders a PFM under a limit of address space, and looks at the file: rows at several heights against crops that are drawn by themselves.
Then a PNG and an EXR under the same limit: `glint diff`, without a limit, must read them whole and find the same picture.
"""
import os
import pathlib
import re
import resource
import subprocess
import sys
import tempfile

GIB = 1 << 30


def rows_of(path, first, count):
    """The bytes of rows from `first` on of a PFM, whose rows go from the bottom to the top."""
    with open(path, "rb") as file:
        file.readline()
        width, height = map(int, file.readline().split())
        file.readline()
        start = file.tell()
        file.seek(start + (height - first - count) * width * 12)
        return file.read(count * width * 12)


def main():
    glint, scene = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    size = sys.argv[3] if len(sys.argv) > 3 else "65536x1024"
    width, height = map(int, size.split("x"))
    whole = width * height * 29
    limit = 3 * GIB // 2
    if whole < limit:
        sys.exit("big_picture.py: the picture would fit")
    with tempfile.TemporaryDirectory(dir=os.environ.get("TMPDIR", ".")) as name:
        folder = pathlib.Path(name)
        command = [glint, "render", scene, "--size", size, "-q"]
        for kind in ("pfm", "png", "exr"):
            subprocess.run([*command, "-o", folder / f"all.{kind}"], check=True,
                           preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)))
        peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024
        print(f"{size}: {peak / GIB:.2f} GiB, at once {whole / GIB:.2f} GiB")
        for kind, most in (("exr", 0), ("png", 0.01)):  # 8 bits, and white for what is brighter
            ran = subprocess.run([glint, "diff", folder / f"all.{kind}", folder / "all.pfm"], capture_output=True, text=True)
            found = re.match(r"RMSE ([^,]+),", ran.stdout)
            if not found or float(found[1]) > most:
                sys.exit(f"big_picture.py: all.{kind} is not all.pfm: {ran.stdout}{ran.stderr}")
        for y in (0, height // 3 // 8 * 8, height - 8):
            crop = f"0,{y},{width},{y + 8}"
            subprocess.run([*command, "--crop", crop, "-o", folder / "crop.pfm"], check=True)
            if rows_of(folder / "crop.pfm", 0, 8) != rows_of(folder / "all.pfm", y, 8):
                sys.exit(f"big_picture.py: rows from {y} on differ from those of a crop")
        if peak > limit:
            sys.exit("big_picture.py: more memory than the limit")


if __name__ == "__main__":
    main()
