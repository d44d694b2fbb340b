"""The object that a pixel's ray hits, in rational arithmetic, from the scene as it was written.

It shares nothing with glint but the scene format: rays and transforms are fractions, and only the roots of quadratic equations
are rounded, to 60 digits.
"""
import decimal
import math
from fractions import Fraction

decimal.getcontext().prec = 60
UNDECIDED = object()


def camera_of(scene):
    camera, image = scene["camera"], scene["image"]
    forward = unit([t - e for t, e in zip(camera["target"], camera["eye"])])
    right = unit(cross(forward, camera["up"]))
    tangent = math.tan(math.radians(camera["fovY"]) / 2)
    return camera["eye"], forward, right, cross(right, forward), tangent, image["width"], image["height"]


def direction_of(scene, pixel):
    _, forward, right, up, tangent, width, height = camera_of(scene)
    x = ((pixel[0] + 0.5) / width * 2 - 1) * tangent * width / height
    y = (1 - (pixel[1] + 0.5) / height * 2) * tangent
    return [f + x * r + y * u for f, r, u in zip(forward, right, up)]


def pixel_of(scene, point):
    eye, forward, right, up, tangent, width, height = camera_of(scene)
    d = [p - e for p, e in zip(point, eye)]
    depth = dot(d, forward)
    x, y = dot(d, right) / depth / tangent * height / width, dot(d, up) / depth / tangent
    return (x + 1) / 2 * width, (1 - y) / 2 * height


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(v):
    length = math.sqrt(dot(v, v))
    return [c / length for c in v]


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


def fractions(v):
    return [Fraction(c) for c in v]


def root(x):
    value = decimal.Decimal(x.numerator) / decimal.Decimal(x.denominator)
    return Fraction(value.sqrt())


def inverse_rows(m):
    """Rows of the inverse of the linear part of a 4 x 4 matrix by rows."""
    columns = [[m[0], m[4], m[8]], [m[1], m[5], m[9]], [m[2], m[6], m[10]]]
    rows = [cross(columns[1], columns[2]), cross(columns[2], columns[0]), cross(columns[0], columns[1])]
    determinant = dot(columns[0], rows[0])
    return [[c / determinant for c in row] for row in rows]


def in_outline(points, normal, at):
    """Even-odd rule in the plane of the two lesser components of the normal."""
    k = max(range(3), key=lambda i: abs(normal[i]))
    i, j = (k + 1) % 3, (k + 2) % 3
    inside = False
    for a, b in zip(points, points[1:] + points[:1]):
        if (a[j] > at[j]) != (b[j] > at[j]):
            x = a[i] + (at[j] - a[j]) * (b[i] - a[i]) / (b[j] - a[j])
            inside ^= at[i] < x
    return inside


def flat_hits(o, d, point, normal, contains):
    """t and height per t; nothing for a parallel ray."""
    speed = dot(normal, d)
    if speed == 0:
        return
    t = dot(normal, minus(point, o)) / speed
    if contains([a + t * b for a, b in zip(o, d)]):
        yield t, abs(speed) / root(dot(normal, normal))


def roots_of(a, b, c):
    """Of a t^2 + 2 b t + c."""
    if a == 0:
        return [-c / (2 * b)] if b != 0 else []
    square = b * b - a * c
    if square < 0:
        return []
    r = root(square)
    return [(-b - r) / a, (-b + r) / a]


def side_hits(o, d, base, axis, radius_at):
    """Side of a body of revolution: the square of its radius at height h (0 at the base, 1 at the top) is p h^2 + q h + r."""
    p, q, r = radius_at
    w, length = minus(o, base), dot(axis, axis)
    h, k = dot(w, axis) / length, dot(d, axis) / length
    x, e = [a - h * b for a, b in zip(w, axis)], [a - k * b for a, b in zip(d, axis)]
    a = dot(e, e) - p * k * k
    b = dot(x, e) - p * h * k - q * k / 2
    c = dot(x, x) - p * h * h - q * h - r
    for t in roots_of(a, b, c):
        if 0 <= h + t * k <= 1:
            gradient = [2 * (u + t * v) - (2 * p * (h + t * k) + q) * g / length for u, v, g in zip(x, e, axis)]
            yield t, abs(dot(gradient, d)) / root(dot(gradient, gradient)) if any(gradient) else Fraction(0)


def revolution_hits(o, d, base, top, radius_at, capped):
    axis = minus(top, base)
    yield from side_hits(o, d, base, axis, radius_at)
    for place, h in ((base, 0), (top, 1)) if capped else ():
        limit = (radius_at[0] * h + radius_at[1]) * h + radius_at[2]
        if limit > 0:
            yield from flat_hits(o, d, place, axis, lambda at: dot(minus(at, place), minus(at, place)) <= limit)


def box_hits(o, d, lo, hi):
    for k in range(3):
        normal = [int(i == k) for i in range(3)]
        for corner in (lo, hi):
            yield from flat_hits(o, d, corner, normal, lambda at: all(lo[i] <= at[i] <= hi[i] for i in range(3) if i != k))


def hits_of(thing, o, d):
    """Pairs of t and of the way that the ray makes across the surface for a unit of t."""
    if "transform" in thing:
        m = fractions(thing["transform"])
        rows = inverse_rows(m)
        away = minus(o, [m[3], m[7], m[11]])
        inside = {key: value for key, value in thing.items() if key != "transform"}
        local_o, local_d = [dot(row, away) for row in rows], [dot(row, d) for row in rows]
        # In the frame's third direction, in which coincident surfaces lie, lengths grow by this factor.
        normal_scale = 1 / root(dot(rows[2], rows[2]))
        for t, speed in hits_of(inside, local_o, local_d):
            yield t, speed * normal_scale
        return
    kind = thing["type"]
    if kind == "plane":
        yield from flat_hits(o, d, fractions(thing["point"]), fractions(thing["normal"]), lambda at: True)
    elif kind == "disc":
        center, radius = fractions(thing["center"]), Fraction(thing["radius"])
        yield from flat_hits(o, d, center, fractions(thing["normal"]), lambda at: dot(minus(at, center), minus(at, center)) <= radius**2)
    elif kind in ("triangle", "polygon"):
        points = [fractions(p) for p in thing["vertices"]]
        normal = cross(minus(points[1], points[0]), minus(points[2], points[0]))
        yield from flat_hits(o, d, points[0], normal, lambda at: in_outline(points, normal, at))
    elif kind == "mesh":
        yield from flat_hits(o, d, [0, 0, 0], [0, 0, 1], lambda at: max(abs(at[0]), abs(at[1])) <= 1)
    elif kind == "box":
        yield from box_hits(o, d, fractions(thing["min"]), fractions(thing["max"]))
    elif kind == "sphere":
        yield from ellipsoid_hits(o, d, fractions(thing["center"]), [Fraction(thing["radius"])] * 3)
    elif kind == "ellipsoid":
        yield from ellipsoid_hits(o, d, fractions(thing["center"]), fractions(thing["radii"]))
    elif kind == "quadric":
        yield from quadric_hits(o, d, fractions(thing["coefficients"]), [fractions(b) for b in thing["bounds"]])
    elif kind == "paraboloid":
        yield from revolution_hits(o, d, fractions(thing["vertex"]), fractions(thing["top"]), (0, Fraction(thing["radius"])**2, 0), False)
    else:
        first, last = Fraction(thing["radius"]), Fraction(thing.get("topRadius", thing["radius"] if kind == "cylinder" else 0))
        ends = fractions(thing["base"]), fractions(thing["top" if kind == "cylinder" else "apex"])
        change = last - first
        yield from revolution_hits(o, d, *ends, (change**2, 2 * first * change, first**2), thing.get("capped", False))


def ellipsoid_hits(o, d, center, radii):
    w = [(a - b) / r for a, b, r in zip(o, center, radii)]
    e = [a / r for a, r in zip(d, radii)]
    for t in roots_of(dot(e, e), dot(w, e), dot(w, w) - 1):
        gradient = [(a + t * b) / r for a, b, r in zip(w, e, radii)]
        yield t, abs(dot(gradient, d)) / root(dot(gradient, gradient))


def quadric_hits(o, d, coefficients, bounds):
    xx, yy, zz, xy, yz, xz, x, y, z, constant = coefficients
    rows = [[2 * xx, xy, xz], [xy, 2 * yy, yz], [xz, yz, 2 * zz]]

    def gradient_at(p):
        return [dot(row, p) + c for row, c in zip(rows, (x, y, z))]
    linear = dot(o, (x, y, z)) + constant
    for t in roots_of(dot(d, [dot(row, d) for row in rows]) / 2, dot(gradient_at(o), d) / 2,
                      dot(o, [dot(row, o) for row in rows]) / 2 + linear):
        at = [a + t * b for a, b in zip(o, d)]
        if all(lo <= c <= hi for lo, c, hi in zip(bounds[0], at, bounds[1])):
            gradient = gradient_at(at)
            yield t, abs(dot(gradient, d)) / root(dot(gradient, gradient))


def object_at(scene, pixel, bound):
    """Number of the object hit, -1 for none: of the surfaces within `bound` of the closest the first opaque one, else the first.

    UNDECIDED if a hit within 16 bounds is not within one."""
    o, d = fractions(scene["camera"]["eye"]), fractions(direction_of(scene, pixel))
    hits = [(t, speed, i) for i, thing in enumerate(scene["objects"]) for t, speed in hits_of(thing, o, d) if t > 0]
    if not hits:
        return -1
    closest = min(hits)
    if closest[1] < Fraction(1, 1000):
        return UNDECIDED
    together = []
    for t, speed, i in hits:
        height = (t - closest[0]) * max(speed, closest[1])
        if height <= bound:
            together.append((scene["objects"][i]["material"] == "glass", i))
        elif height <= 2 * bound:
            return UNDECIDED
    return min(together)[1]
