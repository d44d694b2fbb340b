"""Objects of glint's scenes as those of POV-Ray's."""
import numpy

from language import SCALE, Refused, array, frame, matrix, number, unit, vector
from surfaces import interior, texture


def axes(normal):
    """The directions of u and v on a flat object (docs/reference/shading.md)."""
    n = unit(normal)
    across = numpy.cross([0, 1, 0], n)
    if numpy.linalg.norm(across) < 1e-4:
        across = array([1, 0, 0]) - n[0] * n
    u = unit(across)
    return u, numpy.cross(n, u), n


def flat(origin, normal, low=(0, 0), size=(1, 1)):
    """Points to (u, v, height): 0 to 1 from `low` on over `size` along the axes."""
    u, v, n = axes(normal)
    rows = [u / size[0], v / size[1], n]
    offsets = [-(rows[0] @ array(origin)) - low[0] / size[0], -(rows[1] @ array(origin)) - low[1] / size[1], -(n @ array(origin))]
    return numpy.column_stack([rows, offsets])


def plane(o):
    n = unit(o["normal"])
    return f"plane {{ {vector(n)}, {number(n @ array(o['point']))}", flat(o["point"], n)


def disc(o):
    r = o["radius"]
    return f"disc {{ {vector(o['center'])}, {vector(unit(o['normal']))}, {number(r)}", flat(o["center"], o["normal"], (-r, -r), (2 * r, 2 * r))


def triangle(o):
    a, b, c = map(array, o["vertices"])
    inverse = numpy.linalg.inv(numpy.column_stack([b - a, c - a, unit(numpy.cross(b - a, c - a))]))
    return f"triangle {{ {vector(a)}, {vector(b)}, {vector(c)}", numpy.column_stack([inverse, -inverse @ a])


def polygon(o):
    """POV-Ray's outline is closed where it comes back to its first vertex, and what follows is another outline of the same even-odd rule. The
    edges between outlines, which it does not have, must be walked there and back."""
    corners = [tuple(map(float, v)) for v in o["vertices"]]
    written, left_out, start = [], [], corners[0]
    for i, corner in enumerate(corners):
        written.append(corner)
        if i and start is not None and corner == start:
            start = None
        elif start is None:
            left_out.append(frozenset((corners[i - 1], corner)))
            start = corner
    if start is None:
        left_out.append(frozenset((corners[-1], corners[0])))
    else:
        written.append(start)
        if start != corners[0]:
            left_out += [frozenset((corners[-1], corners[0])), frozenset((corners[-1], start))]
    if any(left_out.count(edge) % 2 and len(edge) > 1 for edge in left_out):
        raise Refused("a polygon whose outlines are joined by an edge of its own")
    points = array(corners)
    normal = sum(numpy.cross(p, q) for p, q in zip(points, numpy.roll(points, -1, axis=0)))
    text = f"polygon {{ {len(written)}, {', '.join(map(vector, written))}"
    if not normal.any():
        return text, None  # halves that turn either way, as of a bow tie
    u, v, _ = axes(normal)
    along, up = points @ u, points @ v
    where = flat([0, 0, 0], normal, (min(along), min(up)), (max(along) - min(along), max(up) - min(up)))
    where[2, 3] = -(where[2, :3] @ points[0])
    return text, where


def quadric_text(a, b, c, j, clip, caps=""):
    """A x^2 + B y^2 + C z^2, three products, three linear terms, J, and what keeps a part of it."""
    return f"quadric {{ {vector(a)}, {vector(b)}, {vector(c)}, {number(j)} clipped_by {{ {clip} }}{caps}"


def quadric(o):
    A, B, C, D, E, F, G, H, I, J = o["coefficients"]  # D xy + E yz + F xz; POV-Ray's order is xy, xz, yz
    low, high = o["bounds"]
    return quadric_text((A, B, C), (D, F, E), (G, H, I), J, f"box {{ {vector(low)}, {vector(high)} }}", " bounded_by { clipped_by }"), None


def slab(length):
    return f"plane {{ -y, 0 }} plane {{ y, {number(length)} }}"


def revolved(o, start, end, cap_radii, coefficients):
    """A quadric about y from 0 to its length, r^2 = c0 + c1 y + c2 y^2, with discs for caps; placed by a matrix of its own."""
    base, axis = array(o[start]), array(o[end]) - array(o[start])
    length = float(numpy.linalg.norm(axis))
    c0, c1, c2 = coefficients(length)
    side = quadric_text((1, -c2, 1), (0, 0, 0), (0, -c1, 0), -c0, f"intersection {{ {slab(length)} }}")
    if not o.get("capped", False):
        return f"{side} {matrix(frame(base, axis))}", None
    caps = " ".join(f"disc {{ y*{number(y)}, y, {number(r)} }}" for y, r in zip((0.0, length), cap_radii) if r)
    return f"union {{ {side} }} {caps} {matrix(frame(base, axis))}", None


def hyperboloid(o):
    r2, w2 = o["radius"] ** 2, o["waist"] ** 2
    # waist^2 + (radius^2 - waist^2) (2 y / length - 1)^2
    return revolved(o, "base", "top", (o["radius"],) * 2, lambda l: (r2, -4 * (r2 - w2) / l, 4 * (r2 - w2) / l ** 2))


def paraboloid(o):
    return revolved(o, "vertex", "top", (0, o["radius"]), lambda l: (0, o["radius"] ** 2 / l, 0))


def cylinder(o):
    open_ = "" if o.get("capped", False) else " open"
    return f"cylinder {{ {vector(o['base'])}, {vector(o['top'])}, {number(o['radius'])}{open_}", None


def cone(o):
    open_ = "" if o.get("capped", False) else " open"
    return (f"cone {{ {vector(o['base'])}, {number(o['radius'])}, {vector(o['apex'])}, {number(o.get('topRadius', 0))}{open_}", None)


def ellipsoid(o):
    m = numpy.diag([*o["radii"], 1.0])
    m[:3, 3] = o["center"]
    return f"sphere {{ 0, 1 {matrix(m)}", None


def sphere(o):
    return f"sphere {{ {vector(o['center'])}, {number(o['radius'])}", ("sphere", o["center"])


def box(o):
    return f"box {{ {vector(o['min'])}, {vector(o['max'])}", None


def mesh_text(translation, o, named, unit_of):
    mesh = translation.mesh(o["mesh"])
    names = sorted({name for _, name in mesh.faces if name}) if not named else []
    out = [f"mesh2 {{vertex_vectors {{ {len(mesh.vertices)},\n" + ",\n".join(vector(unit_of * array(v)) for v in mesh.vertices) + " }\n"]
    if names:
        out.append(f"texture_list {{ {len(names)}, " + " ".join(texture(translation, mesh.materials[n], None) for n in names) + " }\n")
    faces = ["<{},{},{}>".format(*corners) + (f", {names.index(name)}" if names else "") for corners, name in mesh.faces]
    out.append(f"face_indices {{ {len(faces)},\n" + ",\n".join(faces) + " }\n")
    return "".join(out), bool(names)


KINDS = {f.__name__: f for f in (plane, disc, triangle, polygon, quadric, hyperboloid, paraboloid, cylinder, cone, ellipsoid, sphere, box)}


def shape(translation, o, named, material, placed):
    textured, scaled = False, f" scale {number(SCALE)}"
    if o["type"] == "mesh":
        # POV-Ray transforms rays for a mesh, 6 % of a picture's time; a power of two may as well be multiplied in.
        if (placed == numpy.eye(4)).all() and not any(isinstance(value, dict) for value in material.values()):
            scaled = ""
        (geometry, textured), where = mesh_text(translation, o, named, 1.0 if scaled else SCALE), None
    elif o["type"] in KINDS:
        geometry, where = KINDS[o["type"]](o)
    else:
        raise Refused(f"an object of type {o['type']}")
    surface = "" if textured else texture(translation, material, where)
    inside = interior(translation, material) if translation.kind == "colour" and translation.is_clear(material) else ""
    if inside and o.get("capped", False) and o["type"] in ("hyperboloid", "paraboloid"):
        raise Refused(f"a clear {o['type']}")
    return f"{geometry} {surface}{inside} {matrix(placed)}{scaled} }}\n"
