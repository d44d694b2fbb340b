#!/usr/bin/env python3
"""Writes the small images that scenes/*.json show: scenes/images/*.png and sky.hdr. Standard library only.

    python3 scenes/images/make_images.py

letters.png   4 x 4 squares of as many colours, rows from the top red, yellow, green, blue, each lighter from left to
              right, so that it is seen which way up, and which way round, an image lies.
leaf.png      a leaf with alpha: 1 inside |x| < 0.42 sin(pi y), 0 outside.
bricks.png    bricks, each of its own shade.
sky.hdr       64 x 32 latitude-longitude sky: grey ground, sky from pale at the horizon to blue above, red posts along
              -z (the middle), green along +x (three quarters), a sun of radiance 200 at +x+y-z.
"""
import math
import struct
import zlib
from pathlib import Path


def png(width, height, channels, pixel):
    rows = b""
    for y in range(height):
        rows += b"\0" + bytes(value for x in range(width) for value in pixel(x, y))

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    header = struct.pack(">IIBBBBB", width, height, 8, {3: 2, 4: 6}[channels], 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows, 9)) +
            chunk(b"IEND", b""))


def letters(x, y):
    base = [(200, 30, 30), (200, 180, 30), (40, 160, 40), (40, 60, 200)][y // 8]
    lift = 18 * (x // 8)
    return [min(c + lift, 255) for c in base]


def leaf(x, y):
    u, v = (x + 0.5) / 32 - 0.5, (y + 0.5) / 32
    inside = abs(u) < 0.42 * math.sin(math.pi * v)
    vein = abs(u) < 0.02 or abs(abs(u) - 0.6 * ((v * 5) % 1) * 0.3) < 0.008
    return ((90, 140, 50) if vein else (45, 110, 35)) + ((255,) if inside else (0,))


def bricks(x, y):
    row = y // 8
    shifted = (x + 8 * (row % 2)) % 64
    if y % 8 == 0 or shifted % 16 == 0:
        return [170, 165, 155]
    shade = (row * 7 + shifted // 16 * 3) % 5
    return [140 + 8 * shade, 62 + 5 * shade, 45 + 3 * shade]


def rgbe(color):
    greatest = max(color)
    if greatest < 1e-32:
        return bytes(4)
    mantissa, exponent = math.frexp(greatest)
    scale = mantissa * 256 / greatest
    return bytes([int(c * scale) for c in color] + [exponent + 128])


def sky(x, y):
    longitude, latitude = ((x + 0.5) / 64 - 0.5) * 2 * math.pi, (0.5 - (y + 0.5) / 32) * math.pi
    d = (math.cos(latitude) * math.sin(longitude), math.sin(latitude), -math.cos(latitude) * math.cos(longitude))
    sun = [s / math.sqrt(3) for s in (1, 1, -1)]
    if sum(a * b for a, b in zip(d, sun)) > math.cos(math.radians(5)):
        return (200, 190, 160)
    if 0 < latitude < 0.35 and x in (31, 32):
        return (1.2, 0.1, 0.1)
    if 0 < latitude < 0.35 and x in (47, 48):
        return (0.1, 0.9, 0.1)
    if d[1] < 0:
        return (0.22, 0.2, 0.18)
    t = d[1] ** 0.5
    return tuple(a + (b - a) * t for a, b in zip((0.8, 0.85, 0.9), (0.15, 0.3, 0.7)))


def hdr(width, height, pixel):
    data = b"".join(rgbe(pixel(x, y)) for y in range(height) for x in range(width))
    return b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n" % (height, width) + data


def main():
    folder = Path(__file__).parent
    (folder / "letters.png").write_bytes(png(32, 32, 3, letters))
    (folder / "leaf.png").write_bytes(png(32, 32, 4, leaf))
    (folder / "bricks.png").write_bytes(png(64, 32, 3, bricks))
    (folder / "sky.hdr").write_bytes(hdr(64, 32, sky))


if __name__ == "__main__":
    main()
