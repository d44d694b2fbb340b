"""Pictures of both programs as arrays, rows from the top."""
import json
import os
import pathlib
import subprocess
import tempfile

import numpy

# No display, no messages, no antialiasing, one thread; binary PPM of 16 bits, linear.
POVRAY = ["povray", "-D", "-V", "-A", "-GA", "+WT1", "+FP16", "File_Gamma=1", "Dither=off"]


def read_ppm(path, width, height):
    data = path.read_bytes()  # magic, width, height, greatest value, with comments between; then the pixels
    if not data.startswith(b"P6") or not data[:-6 * width * height].endswith(b"\n65535\n"):
        raise ValueError(f"{path}: no PPM of 16 bits and {width} x {height}")
    return numpy.frombuffer(data[-6 * width * height:], ">u2").reshape(height, width, 3)


def read_pfm(path):
    with open(path, "rb") as file:
        kind, (width, height), scale = file.readline().strip(), map(int, file.readline().split()), float(file.readline())
        values = numpy.frombuffer(file.read(), "<f4" if scale < 0 else ">f4")
    channels = 3 if kind == b"PF" else 1
    return values.reshape(height, width, channels)[::-1].astype(float)


def povray(text, size):
    """The picture of a text in POV-Ray's language, in units of 1 / 65535."""
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        (folder / "scene.pov").write_text(text)
        command = [*POVRAY, f"+I{folder / 'scene.pov'}", f"+O{folder / 'scene.ppm'}", f"+W{size[0]}", f"+H{size[1]}"]
        ran = subprocess.run(command, capture_output=True, text=True, cwd=folder, env={**os.environ, "HOME": str(folder)}, timeout=600)
        if ran.returncode:
            raise RuntimeError("povray: " + "\n".join(line for line in ran.stderr.splitlines() if "rror" in line or "line" in line)[-2000:])
        return read_ppm(folder / "scene.ppm", *size)


def absolute(value, folder):
    """A scene whose files are named by their whole paths, so that it may be written anywhere."""
    if isinstance(value, list):
        return [absolute(v, folder) for v in value]
    if isinstance(value, dict):
        return {k: str((folder / v).resolve()) if k in ("file", "texture", "environment") and isinstance(v, str) else absolute(v, folder)
                for k, v in value.items()}
    return value


def glint(program, scene, folder, size, backend, layers=("color",)):
    """The layers of glint's picture of a scene, one sample in the middle of each pixel."""
    with tempfile.TemporaryDirectory() as temporary:
        path = pathlib.Path(temporary) / "scene.json"
        path.write_text(json.dumps(absolute(scene, folder)))
        command = [program, "render", path, "--allow-outside", "--size", f"{size[0]}x{size[1]}", "--spp", "1", "--sampler", "grid", "--filter", "box",
                   "--backend", backend, "--aov", ",".join(layers), "-o", path.with_suffix(".pfm"), "-q"]
        ran = subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=600)
        if ran.returncode:
            raise RuntimeError(ran.stderr)
        return {layer: read_pfm(path.with_suffix(".pfm" if layer == "color" else f".{layer}.pfm")) for layer in layers}
