"""Triangles of OBJ and PLY files, read without code of glint, for a translation to another renderer."""
import dataclasses
import functools
import struct


@dataclasses.dataclass
class Mesh:
    vertices: list
    faces: list  # (three indices of vertices, name of a material or None)
    materials: dict = dataclasses.field(default_factory=dict)


def read_ply(path):
    """Vertices and triangles of a PLY file, ascii or little-endian, whose vertices start with float x y z."""
    with open(path, "rb") as file:
        counts, element, binary = {}, None, False
        while (line := file.readline().decode("ascii", "replace").split()) != ["end_header"]:
            if line[:1] == ["format"]:
                binary = line[1] == "binary_little_endian"
            elif line[:1] == ["element"]:
                element = line[1]
                counts[element] = int(line[2])
            elif line[:1] == ["property"] and element == "vertex":
                if line[-1] in ("red", "nx", "u", "s", "texture_u"):
                    raise ValueError(f"{path}: {line[-1]}: not read")
        if binary:
            vertices = list(struct.iter_unpack("<3f", file.read(12 * counts["vertex"])))
            faces = [f[1:] for f in struct.iter_unpack("<B3i", file.read(13 * counts["face"]))]
        else:
            vertices = [tuple(map(float, file.readline().split()[:3])) for _ in range(counts["vertex"])]
            faces = [tuple(map(int, file.readline().split()[1:4])) for _ in range(counts["face"])]
    return Mesh(vertices, [(face, None) for face in faces])


def read_mtl(path):
    """Materials as glint's scenes write them: Kd, Ka, Ks, Ns; illum from 3 up makes Ks the mirror colour (docs/reference/file-formats.md)."""
    materials, current = {}, {}
    for line in path.read_text().splitlines():
        key, *rest = line.split() or [""]
        if key == "newmtl":
            current = materials.setdefault(rest[0], {})
        elif key in ("Kd", "Ka", "Ks", "Ns", "illum"):
            current[key] = [float(x) for x in rest]
        elif key and not key.startswith("#"):
            raise ValueError(f"{path}: {key}: not read")
    read = {}
    for name, m in materials.items():
        model = m.get("illum", [2])[0]
        if model > 3:
            raise ValueError(f"{path}: illum {model:g}: not read")
        shines = model >= 2 and m.get("Ns", [0])[0] > 0
        read[name] = {"diffuse": m.get("Kd", [0.8] * 3), "ambient": m["Ka"] if any(m.get("Ka", [])) else m.get("Kd", [0.8] * 3),
                      "specular": m.get("Ks", 0) if shines else 0, "shininess": m.get("Ns", [0])[0], "mirror": m.get("Ks", 0) if model >= 3 else 0}
    return read


@functools.lru_cache
def read(path):
    if path.suffix == ".ply":
        return read_ply(path)
    mesh, material = Mesh([], []), None
    for line in path.read_text().splitlines():
        key, *rest = line.split() or [""]
        if key in ("vn", "vt") or (key == "v" and len(rest) > 3):
            raise ValueError(f"{path}: {line}: not read")
        if key == "v":
            mesh.vertices.append(tuple(map(float, rest)))
        elif key == "usemtl":
            material = rest[0]
        elif key == "mtllib":
            mesh.materials.update(read_mtl(path.parent / rest[0]))
        elif key == "f":
            corners = [int(corner) - 1 for corner in rest]
            # A fan: right for the convex faces that these files have.
            mesh.faces += [((corners[0], *corners[i:i + 2]), material) for i in range(1, len(corners) - 1)]
    return mesh
