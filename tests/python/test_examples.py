"""The tutorial's programs write images, and the same ones with the reference and a Vulkan device."""
import os
import pathlib
import re
import struct
import subprocess
import sys
import zlib

import numpy
import pytest

ROOT = pathlib.Path(os.environ["GLINT_SOURCE"])
SIZE = 48


def read_png(path):
    """Reads PNG files of examples/python/town.py: one chunk of unfiltered RGB."""
    data = path.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    width, height, bits, kind = struct.unpack(">IIBB", data[16:26])
    assert (bits, kind) == (8, 2)
    at = data.index(b"IDAT")
    length, = struct.unpack(">I", data[at - 4:at])
    assert zlib.crc32(data[at:at + 4 + length]) == struct.unpack(">I", data[at + 4 + length:at + 8 + length])[0]
    rows = numpy.frombuffer(zlib.decompress(data[at + 4:at + 4 + length]), numpy.uint8).reshape(height, 1 + 3 * width)
    assert not rows[:, 0].any()
    return rows[:, 1:].reshape(height, width, 3)


def draw(folder, name, device):
    path = folder / f"{name}-{device}.png"
    command = [sys.executable, "-W", "error", ROOT / "examples/python" / f"{name}.py", path, "--size", str(SIZE), "--device", device]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    return read_png(path), done.stdout.split(": ", 1)[1]


@pytest.mark.parametrize("name, height", [("lidar_scan", 128 + SIZE), ("sun_hours", SIZE), ("sky_view", SIZE)])
def test_example(tmp_path, name, height):
    picture, said = draw(tmp_path, name, "cpu")
    assert picture.shape == (height, SIZE, 3)
    assert len(numpy.unique(picture.reshape(-1, 3), axis=0)) > 20
    assert re.search(r"\d", said)
    on_device, _ = draw(tmp_path, name, "")
    differ = (picture.astype(int) - on_device).any(axis=-1)
    assert differ.mean() < 0.01
