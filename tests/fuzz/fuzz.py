#!/usr/bin/env python3
"""Runs the fuzz targets of a build with GLINT_FUZZ, N at a time (1 unless said).

    fuzz.py BUILD [--seconds N] [--runs N] [--jobs N] [--only NAME...] [--keep FOLDER]

Seeds are made from the repository's own scenes, models and pictures and from tests/hostile. What a target finds beyond them is kept in
BUILD/corpus/NAME (--keep: FOLDER/NAME) and is where the next run begins. The time is shared out evenly; with --runs each target has that
many executions instead. An input that crashes a target, takes longer than 10 s or more than 2 GiB is left in BUILD/crashes, and the exit
code is 1.
"""
import argparse
import base64
import concurrent.futures
import json
import os
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import zlib

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
LIMITS = ["-timeout=10", "-rss_limit_mb=2048", "-malloc_limit_mb=1024"]
# Where memory was taken is kept by one call, not by 30, and less of what was freed is held back: twice the executions. To look into a finding,
# run the target on the file that is left, without these.
ASAN = "malloc_context_size=1:quarantine_size_mb=16"
LARGEST = 20000  # bytes of a seed: longer ones slow each execution down, and find nothing else

# Longest input; words that mutations alone do not hit upon.
TARGETS = {
    "json": (4096, []),
    "obj": (2048, ["v ", "vt ", "vn ", "f ", "usemtl ", "mtllib ", "m.mtl", "//", "g ", "o ", "s ", "\\\n", "-1", "1e308", "nan"]),
    "mtl": (1024, ["newmtl ", "Ka ", "Kd ", "Ks ", "Ns ", "Ni ", "illum ", "map_Kd ", "map_Ks ", "map_d ", "map_Ka ", "Tr ", "d ", "-s ",
                   "-o ", "-mm ", "-clamp on", "t.png", "spectral ", "xyz "]),
    "ply": (4096, ["ply\n", "format ascii 1.0\n", "format binary_little_endian 1.0\n", "format binary_big_endian 1.0\n", "element vertex ",
                   "element face ", "property ", "list ", "uchar ", "float ", "double ", "int ", "short ", "uint ", "vertex_indices",
                   "vertex_index", "red", "nx", "texture_u", "end_header\n", "comment "]),
    "stl": (4096, ["solid ", "facet normal ", "outer loop\n", "vertex ", "endloop\n", "endfacet\n", "endsolid"]),
    "gltf": (6144, []),
    "glb": (8192, []),
    "nff": (2048, ["v\n", "from ", "at ", "up ", "angle ", "hither ", "resolution ", "b ", "l ", "f ", "s ", "c\n", "p 3\n", "pp 3\n"]),
    "png": (4096, ["IHDR", "PLTE", "IDAT", "IEND", "tRNS", "gAMA", "sRGB", "iCCP", "acTL"]),
    "jpeg": (4096, ["\\xff\\xc0", "\\xff\\xc2", "\\xff\\xc4", "\\xff\\xda", "\\xff\\xdb", "\\xff\\xdd", "\\xff\\xe0", "\\xff\\xee", "\\xff\\xd9"]),
    "hdr": (4096, ["#?RADIANCE\n", "FORMAT=32-bit_rle_rgbe\n", "-Y ", "+X ", "EXPOSURE=", "\\x02\\x02"]),
    "exr": (8192, ["channels", "chlist", "compression", "dataWindow", "box2i", "displayWindow", "lineOrder", "tiles", "tiledesc", "type",
                   "scanlineimage", "tiledimage", "deepscanline", "chunkCount", "name", "version"]),
    "pfm": (2048, ["PF\n", "Pf\n", "-1.0\n", "1.0\n"]),
    "rays": (2048, [",", "inf", "nan", "-0", "1e308", "#"]),
    "units": (8192, ["HEAD", "UNIT", "DONE", "color", "alpha", "depth", "normal", "position", "uv", "object", "primitive", "material"]),
}


def strings_of(document):
    """Every key and every string of a JSON document."""
    if isinstance(document, dict):
        for key, value in document.items():
            yield key
            yield from strings_of(value)
    elif isinstance(document, list):
        for value in document:
            yield from strings_of(value)
    elif isinstance(document, str):
        yield document


def glb(document, binary):
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(binary), 0x004E4942) + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def triangle(uri):
    """A glTF of a triangle with a material, a texture, a camera and a light."""
    floats = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
    indices = struct.pack("<3H", 0, 1, 2)
    binary = floats + indices
    buffer = {"byteLength": len(binary)}
    if uri:
        buffer["uri"] = "data:application/octet-stream;base64," + base64.b64encode(binary).decode()
    return {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1, 2]}],
        "extensionsUsed": ["KHR_lights_punctual", "KHR_texture_transform"],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 20, "color": [1, 1, 1]}]}},
        "nodes": [{"mesh": 0, "translation": [0, 0, 1], "rotation": [0, 0, 0, 1], "scale": [1, 1, 1]}, {"camera": 0},
                  {"matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1], "extensions": {"KHR_lights_punctual": {"light": 0}}}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 0}, "indices": 1, "material": 0, "mode": 4}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0, 1], "metallicFactor": 0, "baseColorTexture": {"index": 0}},
                       "alphaMode": "MASK", "doubleSided": True}],
        "textures": [{"source": 0, "sampler": 0}], "images": [{"uri": "t.png"}], "samplers": [{"wrapS": 10497, "magFilter": 9729}],
        "buffers": [buffer],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 36, "byteStride": 12}, {"buffer": 0, "byteOffset": 36, "byteLength": 6}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
                      {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR",
                       "sparse": {"count": 1, "indices": {"bufferView": 1, "componentType": 5123}, "values": {"bufferView": 1}}}],
    }


def ply(form, colors):
    order = ">" if "big" in form else "<"
    header = f"ply\nformat {form} 1.0\ncomment a\nelement vertex 4\nproperty float x\nproperty float y\nproperty double z\n"
    header += "property uchar red\nproperty uchar green\nproperty uchar blue\n" if colors else ""
    header += "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    data = b""
    for x, y in [(0, 0), (1, 0), (1, 1), (0, 1)]:
        if form == "ascii":
            data += f"{x} {y} 0{' 1 2 3' if colors else ''}\n".encode()
        else:
            data += struct.pack(order + "ffd", x, y, 0) + (b"\1\2\3" if colors else b"")
    data += b"4 0 1 2 3\n" if form == "ascii" else struct.pack(order + "B4i", 4, 0, 1, 2, 3)
    return header.encode() + data


def png(bits, color, interlace):
    """A picture of 8 x 8 black pixels."""
    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    channels = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}[color]
    raw = bytes(2 * 8 * (1 + (8 * channels * bits + 7) // 8))  # enough for any interlacing
    palette = chunk(b"PLTE", bytes(3 << min(bits, 4))) if color == 3 else b""
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 8, 8, bits, color, 0, 0, interlace)) + palette +
            chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b""))


def made_seeds():
    """(target, name, bytes) of what no file of the repository shows."""
    yield "glb", "triangle", glb(triangle(False), struct.pack("<9f3H", 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 2))
    yield "gltf", "triangle", json.dumps(triangle(True)).encode()
    for form in ("ascii", "binary_little_endian", "binary_big_endian"):
        for colors in (False, True):
            yield "ply", f"{form}{colors}", ply(form, colors)
    facet = struct.pack("<12fH", 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0)
    yield "stl", "binary", bytes(80) + struct.pack("<I", 2) + 2 * facet
    yield "stl", "ascii", (b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
                           b"endsolid a\n")
    yield "mtl", "all", b"newmtl a\nKd 1 0 0\nmap_Kd -s 2 2 -o 0.5 0 t.png\nnewmtl b\nKs 1 1 1\nNs 20\nillum 3\nnewmtl c\nd 0.5\nmap_d t.png\n"
    yield "obj", "quads", b"mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nusemtl a\nf 1/1/1 2/1/1 3//1 -1\n"
    yield "rays", "two", b"ox,oy,oz,dx,dy,dz\n0,0,5,0,0,-1\n0,0,5,0,0,-1,0,10\n# a comment\n"
    yield "json", "meshes", (b'{"camera": {"eye": [0,0,5], "target": [0,0,0]}, "objects": [{"type": "mesh", "file": "m.obj"}, '
                             b'{"type": "mesh", "file": "m.obj", "transform": [{"translate": [1,0,0]}]}]}')
    for color, depths in {0: (1, 2, 4, 8, 16), 2: (8, 16), 3: (1, 2, 4, 8), 4: (8, 16), 6: (8, 16)}.items():
        for bits in depths:
            yield "png", f"{color}-{bits}", png(bits, color, bits % 2)


def file_seeds():
    kinds = {"jpg": "jpeg", "csv": "rays", "part": "units"}
    for folder in ("scenes", "tests/hostile", "examples", "tests"):
        for path in sorted((ROOT / folder).rglob("*")):
            kind = kinds.get(path.suffix[1:], path.suffix[1:])
            if kind in TARGETS and path.is_file() and path.stat().st_size <= LARGEST and not path.name.endswith("schema.json"):
                yield kind, path.name, path.read_bytes()


def words_of(name):
    words = list(TARGETS[name][1])
    if name == "json":
        schema = json.loads((ROOT / "scenes/scene.schema.json").read_text())
        words += sorted({s for s in strings_of(schema) if re.fullmatch(r"[A-Za-z0-9]{2,20}", s)}) + ["m.obj", "t.png", "1e308", "null"]
    if name in ("gltf", "glb"):
        words += sorted({s for s in strings_of(triangle(False)) if len(s) <= 30}) + ["5120", "5121", "5123", "5125", "5126", "SCALAR", "VEC2",
                                                                                    "VEC4", "normalized", "BLEND", "COLOR_0", "NORMAL"]
    return words


def escaped(word):
    """As libFuzzer's dictionaries have it; \\xNN stays."""
    if re.fullmatch(r"(\\x[0-9a-f]{2})+", word):
        return word
    return "".join(c if c.isalnum() or c in " /.-_#?=,+" else f"\\x{ord(c):02x}" for c in word)


def prepare(build):
    """Seeds and dictionaries, in BUILD/seeds/NAME and BUILD/seeds/NAME.dict."""
    seeds = build / "seeds"
    shutil.rmtree(seeds, ignore_errors=True)
    for name in TARGETS:
        (seeds / name).mkdir(parents=True)
        (seeds / f"{name}.dict").write_text("".join(f'"{escaped(word)}"\n' for word in words_of(name)))
    written = seeds / "written"
    written.mkdir()
    subprocess.run([build / "bin/fuzz_seeds", written], check=True)
    for path in written.iterdir():
        kind = "units" if path.suffix == ".part" else path.suffix[1:]
        path.rename(seeds / kind / path.name)
    for kind, name, data in [*made_seeds(), *file_seeds()]:
        (seeds / kind / name).write_bytes(data)
    for name in TARGETS:
        if not any((seeds / name).iterdir()):
            sys.exit(f"fuzz.py: no seeds for {name}")


def run(build, name, corpus, seconds, runs):
    """(executions, seconds, peak MiB, files of the corpus, what went wrong or "")."""
    corpus.mkdir(parents=True, exist_ok=True)
    crashes = build / "crashes"
    crashes.mkdir(exist_ok=True)
    command = [build / f"bin/fuzz_{name}", *LIMITS, f"-max_len={TARGETS[name][0]}", f"-dict={build}/seeds/{name}.dict",
               f"-artifact_prefix={crashes}/{name}-", "-print_final_stats=1", f"-max_total_time={seconds}", "-entropic=0",
               *([f"-runs={runs}", "-seed=1"] if runs else []), corpus, build / f"seeds/{name}"]
    environment = {**os.environ, "ASAN_OPTIONS": os.environ.get("ASAN_OPTIONS", ASAN)}
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, errors="replace", env=environment)
    stat = {key: int(value) for key, value in re.findall(r"stat::(\w+):\s*(\d+)", done.stdout)}
    wrong = ""
    if done.returncode != 0:
        (crashes / f"{name}.log").write_text(done.stdout)
        wrong = f"{crashes}/{name}.log"
    rate = stat.get("average_exec_per_sec", 0)
    executions = stat.get("number_of_executed_units", 0)
    return executions, rate, stat.get("peak_rss_mb", 0), sum(1 for _ in corpus.iterdir()), wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--seconds", type=int, default=60)
    parser.add_argument("--runs", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--only", nargs="+", choices=sorted(TARGETS), default=list(TARGETS))
    parser.add_argument("--keep", type=pathlib.Path)
    given = parser.parse_args()
    build = given.build.resolve()
    prepare(build)
    keep = (given.keep or build / "corpus").resolve()
    share = 0 if given.runs else max(1, given.seconds // len(given.only))
    failed = False
    print(f"{'target':8} {'executions':>12} {'a second':>9} {'MiB':>6} {'corpus':>7}")
    with concurrent.futures.ThreadPoolExecutor(given.jobs) as pool:
        results = pool.map(lambda name: run(build, name, keep / name, share, given.runs), given.only)
        for name, (executions, rate, peak, files, wrong) in zip(given.only, results):
            print(f"{name:8} {executions:12} {rate:9} {peak:6} {files:7}  {wrong}", flush=True)
            failed = failed or bool(wrong) or executions == 0
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
