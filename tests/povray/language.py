"""What every part of the translation to POV-Ray uses: its numbers, vectors and matrices, and the transforms of glint's scenes."""
import math

import numpy

SCALE = 512.0         # lengths are multiplied by it, see translate.py
OBJECT_CODE = 64      # objects are told apart by a red of (number + 1) OBJECT_CODE / 65535


class Refused(Exception):
    """This part of a scene has no counterpart in POV-Ray."""


def colour(value):
    return [float(x) for x in value] if isinstance(value, list) else [float(value)] * 3


def number(x):
    return repr(float(x))


def vector(v):
    return "<" + ",".join(map(number, v)) + ">"


def rgb(v):
    return f"rgb {vector(v)}"


def array(v):
    return numpy.array(v, dtype=float)


def unit(v):
    return array(v) / numpy.linalg.norm(v)


def matrix(m):
    """A 4x4 matrix for column vectors, if it does anything. POV-Ray multiplies row vectors, so it takes the columns."""
    if (m == numpy.eye(4)).all():
        return ""
    return "matrix <" + ",".join(number(m[row][column]) for column in range(4) for row in range(3)) + ">"


def rotation(axis, degrees):
    (x, y, z), c, s = unit(axis), math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    k = array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return numpy.eye(3) + s * k + (1 - c) * k @ k


def transform(steps):
    """glint's list of steps, or its 16 numbers, as a matrix."""
    if steps and not isinstance(steps[0], dict):
        return array(steps).reshape(4, 4)
    total = numpy.eye(4)
    for step in steps:
        (kind, value), m = next(iter(step.items())), numpy.eye(4)
        if kind == "scale":
            m[:3, :3] = numpy.diag(value if isinstance(value, list) else [value] * 3)
        elif kind == "rotate":
            m[:3, :3] = rotation(value[:3], value[3])
        elif kind == "translate":
            m[:3, 3] = value
        else:
            raise Refused(f"transform: {kind}")
        total = m @ total
    return total


def frame(origin, y):
    """The matrix that takes the y axis to `y` (of its length) at `origin`, and x and z to unit vectors across it."""
    direction = unit(y)
    across = unit(numpy.cross(direction, [1, 0, 0] if abs(direction[0]) < 0.9 else [0, 1, 0]))
    m = numpy.eye(4)
    m[:3, 0], m[:3, 1], m[:3, 2], m[:3, 3] = across, direction, numpy.cross(across, direction), origin
    return m
