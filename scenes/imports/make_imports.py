#!/usr/bin/env python3
"""Writes the small files of other programs' formats that the gallery shows. Standard library only; the results are committed.

    python3 scenes/imports/make_imports.py

table.gltf  glTF 2.0, buffer inside: a table top with an image, a gold ball, a glass ball, a painted cube, a camera and
            two lights (KHR_lights_punctual, KHR_materials_transmission, _volume, _ior)
gem.stl     ascii STL: scenes/meshes/gem.obj
"""
import base64
import json
import math
import struct
from pathlib import Path

here = Path(__file__).parent


def unit(a):
    n = math.sqrt(sum(x * x for x in a))
    return tuple(x / n for x in a)


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def sub(a, b):
    return tuple(x - y for x, y in zip(a, b))


def icosphere(levels):
    g = (1 + math.sqrt(5)) / 2
    points = [unit(p) for p in [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g),
                                (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6),
             (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10),
             (8, 6, 7), (9, 8, 1)]
    for _ in range(levels):
        middles, finer = {}, []

        def middle(a, b):
            key = (min(a, b), max(a, b))
            if key not in middles:
                points.append(unit(tuple(x + y for x, y in zip(points[a], points[b]))))
                middles[key] = len(points) - 1
            return middles[key]

        for a, b, c in faces:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        faces = finer
    return points, faces


class Document:
    def __init__(self):
        self.data = b""
        self.views, self.accessors, self.meshes = [], [], []

    def accessor(self, rows, kind, component):
        code = {5126: "f", 5123: "H"}[component]
        flat = [x for row in rows for x in row] if kind != "SCALAR" else list(rows)
        packed = struct.pack("<%d%s" % (len(flat), code), *flat)
        self.data += b"\0" * (-len(self.data) % 4)
        self.views.append({"buffer": 0, "byteOffset": len(self.data), "byteLength": len(packed)})
        self.data += packed
        accessor = {"bufferView": len(self.views) - 1, "componentType": component, "count": len(rows), "type": kind}
        if kind == "VEC3":
            accessor["min"] = [min(r[i] for r in rows) for i in range(3)]
            accessor["max"] = [max(r[i] for r in rows) for i in range(3)]
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def mesh(self, name, points, faces, material, normals=None, uvs=None):
        attributes = {"POSITION": self.accessor([struct.unpack("<3f", struct.pack("<3f", *p)) for p in points],
                                                "VEC3", 5126)}
        if normals:
            attributes["NORMAL"] = self.accessor(normals, "VEC3", 5126)
        if uvs:
            attributes["TEXCOORD_0"] = self.accessor(uvs, "VEC2", 5126)
        indices = self.accessor([i for f in faces for i in f], "SCALAR", 5123)
        self.meshes.append({"name": name, "primitives": [
            {"attributes": attributes, "indices": indices, "material": material}]})
        return len(self.meshes) - 1


def cube_faces():
    points, uvs, faces = [], [], []
    for u, v in [((1, 0, 0), (0, 1, 0)), ((0, 0, -1), (0, 1, 0)), ((-1, 0, 0), (0, 1, 0)), ((0, 0, 1), (0, 1, 0)),
                 ((1, 0, 0), (0, 0, -1)), ((1, 0, 0), (0, 0, 1))]:
        n = cross(u, v)
        first = len(points)
        for s, t in [(-1, -1), (1, -1), (1, 1), (-1, 1)]:
            points.append(tuple(0.5 * (n[i] + s * u[i] + t * v[i]) for i in range(3)))
            uvs.append(((s + 1) / 2, (1 - t) / 2))  # glTF's v runs down
        faces += [(first, first + 1, first + 2), (first, first + 2, first + 3)]
    return points, uvs, faces


def looking(eye, target):
    z = unit(sub(eye, target))
    x = unit(cross((0, 1, 0), z))
    y = cross(z, x)
    return [*x, 0, *y, 0, *z, 0, *eye, 1]


def table():
    d = Document()
    points, faces = icosphere(3)
    gold = d.mesh("gold ball", points, faces, 0, normals=points)
    glass = d.mesh("glass ball", points, faces, 1, normals=points)
    corners, uvs, sides = cube_faces()
    cube = d.mesh("cube", corners, sides, 2, uvs=uvs)
    top = d.mesh("table", [(-3, 0, 3), (3, 0, 3), (3, 0, -3), (-3, 0, -3)], [(0, 1, 2), (0, 2, 3)], 3,
                 uvs=[(0, 6), (6, 6), (6, 0), (0, 0)])
    png = (here.parent / "images" / "letters.png").read_bytes()
    bricks = (here.parent / "images" / "bricks.png").read_bytes()
    uri = "data:image/png;base64,"
    document = {
        "asset": {"version": "2.0", "generator": "make_imports.py"},
        "extensionsUsed": ["KHR_lights_punctual", "KHR_materials_transmission", "KHR_materials_volume",
                           "KHR_materials_ior"],
        "extensions": {"KHR_lights_punctual": {"lights": [
            {"type": "point", "intensity": 60, "color": [1, 0.95, 0.85]},
            {"type": "directional", "intensity": 1.2}]}},
        "scene": 0,
        "scenes": [{"nodes": [0, 1, 2, 3, 4, 5, 6]}],
        "nodes": [
            {"name": "eye", "camera": 0, "matrix": looking((0, 2.4, 5.6), (0, 0.45, 0))},
            {"mesh": top},
            {"mesh": gold, "translation": [-1.25, 0.7, -0.2], "scale": [0.7, 0.7, 0.7]},
            {"mesh": glass, "translation": [0.3, 0.6, 0.9], "scale": [0.6, 0.6, 0.6]},
            {"mesh": cube, "translation": [1.5, 0.5, -0.4], "rotation": [0, math.sin(0.3), 0, math.cos(0.3)]},
            {"name": "lamp", "translation": [2.5, 4, 3], "extensions": {"KHR_lights_punctual": {"light": 0}}},
            {"name": "sun", "rotation": [math.sin(-0.6), 0, 0, math.cos(-0.6)],
             "extensions": {"KHR_lights_punctual": {"light": 1}}}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.62, "aspectRatio": 4 / 3, "znear": 0.1}}],
        "materials": [
            {"name": "gold", "pbrMetallicRoughness": {"baseColorFactor": [1, 0.76, 0.33, 1], "metallicFactor": 1,
                                                      "roughnessFactor": 0.1}},
            {"name": "glass", "pbrMetallicRoughness": {"roughnessFactor": 0, "metallicFactor": 0},
             "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1},
                            "KHR_materials_ior": {"ior": 1.5},
                            "KHR_materials_volume": {"thicknessFactor": 1, "attenuationColor": [0.6, 0.9, 0.8],
                                                     "attenuationDistance": 1}}},
            {"name": "painted", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicFactor": 0,
                                                         "roughnessFactor": 0.8}},
            {"name": "tiles", "pbrMetallicRoughness": {"baseColorTexture": {"index": 1}, "metallicFactor": 0,
                                                       "roughnessFactor": 0.6}}],
        "textures": [{"source": 0, "sampler": 0}, {"source": 1}],
        "samplers": [{"magFilter": 9728}],
        "images": [{"uri": uri + base64.b64encode(png).decode()}, {"uri": uri + base64.b64encode(bricks).decode()}],
        "meshes": d.meshes,
        "accessors": d.accessors,
        "bufferViews": d.views,
        "buffers": [{"byteLength": len(d.data),
                     "uri": "data:application/octet-stream;base64," + base64.b64encode(d.data).decode()}],
    }
    (here / "table.gltf").write_text(json.dumps(document, indent=1) + "\n", encoding="ascii")


def stl():
    points, lines = [], ["solid gem"]
    for line in (here.parent / "meshes" / "gem.obj").read_text(encoding="ascii").splitlines():
        words = line.split()
        if words and words[0] == "v":
            points.append(tuple(float(x) for x in words[1:4]))
        if words and words[0] == "f":
            face = [points[int(w.split("/")[0]) - 1] for w in words[1:]]
            for i in range(1, len(face) - 1):
                a, b, c = face[0], face[i], face[i + 1]
                n = unit(cross(sub(b, a), sub(c, a)))
                lines.append("facet normal %.6g %.6g %.6g" % n)
                lines.append(" outer loop")
                lines += ["  vertex %.9g %.9g %.9g" % p for p in (a, b, c)]
                lines += [" endloop", "endfacet"]
    lines.append("endsolid gem")
    (here / "gem.stl").write_text("\n".join(lines) + "\n", encoding="ascii")


table()
stl()
