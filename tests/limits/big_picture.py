#!/usr/bin/env python3
"""A picture far larger than the memory that it is given, drawn in bands: big_picture.py GLINT SCENE [WxH]

Renders a PFM under a limit of address space, and looks at the file: rows at several heights against crops that are drawn by themselves.
Then a PNG and an EXR under the same limit: all rows must be in the files.
"""
import os
import pathlib
import resource
import struct
import subprocess
import sys
import tempfile
import zlib

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


def png_size(path):
    """(width, height), after the whole file was read: every chunk's sum, and as many bytes of pixels as there should be."""
    with open(path, "rb") as file:
        if file.read(8) != b"\x89PNG\r\n\x1a\n":
            sys.exit(f"big_picture.py: {path} is no PNG")
        inflate, count, header = zlib.decompressobj(), 0, None
        while True:
            length, kind = struct.unpack(">I4s", file.read(8))
            data = file.read(length)
            if zlib.crc32(kind + data) != struct.unpack(">I", file.read(4))[0]:
                sys.exit(f"big_picture.py: {path}: a chunk's sum is wrong")
            if kind == b"IHDR":
                header = struct.unpack(">IIBB", data[:10])
            while kind == b"IDAT" and data:  # a few bytes may be many pixels
                count += len(inflate.decompress(data, 1 << 24))
                data = inflate.unconsumed_tail
            if kind == b"IEND":
                break
    width, height, bits, color = header
    row = 1 + width * {0: 1, 2: 3, 6: 4}[color] * bits // 8
    if count != height * row:
        sys.exit(f"big_picture.py: {path}: {count} bytes of pixels, not {height * row}")
    return width, height


def exr_size(path):
    """(width, height), after the table of blocks was looked at: every block must have its place in the file."""
    def word(file):
        letters = b""
        while (letter := file.read(1)) != b"\0":
            letters += letter
        return letters.decode()
    with open(path, "rb") as file:
        file.seek(8)
        attributes = {}
        while name := word(file):
            word(file)
            attributes[name] = file.read(struct.unpack("<I", file.read(4))[0])
        left, top, right, bottom = struct.unpack("<4i", attributes["dataWindow"])
        height = bottom - top + 1
        blocks = -(-height // {0: 1, 1: 1, 2: 1, 3: 16}[attributes["compression"][0]])
        places = struct.unpack(f"<{blocks}Q", file.read(8 * blocks))
        if not file.tell() <= min(places) <= max(places) < os.path.getsize(path) or len(set(places)) != blocks:
            sys.exit(f"big_picture.py: {path}: blocks are missing")
    return right - left + 1, height


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
        for found in (png_size(folder / "all.png"), exr_size(folder / "all.exr")):
            if found != (width, height):
                sys.exit(f"big_picture.py: an image of {found}")
        for y in (0, height // 3 // 8 * 8, height - 8):
            crop = f"0,{y},{width},{y + 8}"
            subprocess.run([*command, "--crop", crop, "-o", folder / "crop.pfm"], check=True)
            if rows_of(folder / "crop.pfm", 0, 8) != rows_of(folder / "all.pfm", y, 8):
                sys.exit(f"big_picture.py: rows from {y} on differ from those of a crop")
        if peak > limit:
            sys.exit("big_picture.py: more memory than the limit")


if __name__ == "__main__":
    main()
