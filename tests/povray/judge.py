"""What two pictures may differ by, derived; docs/lab/agreement.md tells the derivations in words.

U is half a unit in the last place of fp32. Of the two programs one or both compute in double, whose roundings (2^-53) lie 2^29 below all that
is judged here and count as nothing: an edge then moves past no centre of a pixel at all.
"""
import dataclasses
import math

import numpy

U = 2.0 ** -24
STEP = 1 / 65535       # of POV-Ray's output
MOVE = 1 / 16          # pixels that the film is moved by to see how pictures respond
FINE = 2.0 ** -11      # pixels, more than what rounding moves the film by
CONFIDENCE = 0.999
# Roundings of fp32 on the way from a ray to the next hit: normalising 4, the intersection's sums 8, the point 4. Each is one of U of a coordinate.
ROUNDINGS = 16


@dataclasses.dataclass
class Rounding:
    """How far rounding may move things: hits, relative to their coordinates; normals; and whether shading is done in fp32."""
    place: float        # at most
    typical: float      # on average: independent roundings, each even over +-U, add up to U sqrt(n / 3)
    arithmetic: bool
    normal: float = 0.0  # what POV-Ray's meshes, kept in fp32, are turned by


def rounding_of(backend, mesh_shift, mesh_turn):
    single = backend == "gpu"
    return Rounding(place=mesh_shift + (ROUNDINGS * U if single else 0), typical=mesh_shift + (math.sqrt(ROUNDINGS / 3) * U if single else 0),
                    arithmetic=single, normal=mesh_turn)


def quantile(mean):
    """The least count that a Poisson variable exceeds with a probability below 1 - CONFIDENCE."""
    if mean > 100:
        return math.ceil(upper(mean))  # exp(-mean) vanishes in the end; the limit of the mean lies above that of the count
    term = total = math.exp(-mean)
    count = 0
    while total < CONFIDENCE:
        count += 1
        term *= mean / count
        total += term
    return count


def upper(count):
    """Above the expectation of what was counted, with CONFIDENCE (Garwood's limit by Wilson and Hilferty's cube root)."""
    n = count + 1
    return n * (1 - 1 / (9 * n) + 3.1 / (3 * math.sqrt(n))) ** 3


def blur(eye, distances, pixel):
    """Of a relative error of hits, what it is in pixels: at most and on average. pixel: the angle of one, or for parallel rays its size (negative)."""
    seen = distances[numpy.isfinite(distances)]
    factor = (numpy.linalg.norm(eye) + seen) / (-pixel if pixel < 0 else pixel * seen)
    return float(factor.max()), float(factor.mean())


def neighbourhood(values, pick):
    """The least (or greatest) of each pixel and its eight neighbours."""
    padded = numpy.pad(values, [(1, 1), (1, 1)] + [(0, 0)] * (values.ndim - 2), mode="edge")
    height, width = values.shape[:2]
    return pick.reduce([padded[y:y + height, x:x + width] for y in range(3) for x in range(3)])


def classes(name, theirs, ours, expected):
    """Images of objects: a pixel that differs shows what a pixel beside it shows in the other image, and few pixels differ."""
    most, problems = quantile(expected), []
    places = list(zip(*numpy.nonzero(theirs != ours)))
    lone = sum(ours[y, x] not in theirs[max(0, y - 1):y + 2, max(0, x - 1):x + 2] for y, x in places)
    if lone:
        problems.append(f"{name}: {lone} pixels show what POV-Ray has nowhere near")
    if len(places) > most:
        problems.append(f"{name}: {len(places)} pixels differ, {most} may; the first at {places[0][1]},{places[0][0]}")
    return problems


@dataclasses.dataclass
class Light:
    """What the bound on colours needs to know of a scene."""
    depth: int
    lights: int
    shine: float       # the greatest specular reflectance times all lights together
    exponent: float    # the greatest shininess
    total: float       # all lights together, for what a turned normal changes


def colour_bound(theirs, response, rounding, blurred, light):
    """Of each channel of each pixel.

    - Half a STEP: the output is rounded.
    - POV-Ray's colours are fp32: what reaches the pixel of one light is rounded up to 8 times where it is made (pigment, light, falloff, two
      products, finish, two for roughness) and then once for each further light and five times (ambient, two products of the reflectivity, the
      sum, the output) at each surface on the way to the eye; the terms are positive, so the errors add up to no more than as many U of the sum.
    - glint's shaders take as many, twice over: their quotients and roots are rounded where POV-Ray has doubles.
    - A highlight's cosine is a dot product of two normalised vectors, 9 U off, and its power as many times more as the exponent says.
    - A moved hit changes the colour by what moving the film changes it by, of this pixel or one beside it.
    - A turned normal changes a diffuse cosine by its angle at most, and a highlight by the exponent times that.
    """
    count = 8 + (light.depth + 1) * (light.lights + 5)
    bound = STEP / 2 + count * U * theirs * (3 if rounding.arithmetic else 1)
    glare = numpy.minimum(theirs, light.shine)
    if rounding.arithmetic:
        bound = bound + 9 * U * light.exponent * glare
    return bound + response * blurred + rounding.normal * (light.total + light.exponent * glare)


def colours(theirs, ours, bound, moved, share, leave):
    """Colours agree within the bound, but for as few pixels as rounding moves an edge past; those show what POV-Ray shows beside them."""
    ours = numpy.clip(ours, 0, 1)  # as POV-Ray's output is
    error = abs(theirs - ours)
    beyond = ~(error <= bound).all(axis=2) & ~leave  # so that NaN is
    problems = []
    excess = float(numpy.nan_to_num(error[beyond], nan=1.0).max(axis=1).min()) if beyond.any() else 0.0
    low, high = neighbourhood(theirs, numpy.minimum), neighbourhood(theirs, numpy.maximum)
    # Where colours run smoothly, moving the film by MOVE changes a pixel by about MOVE of what its neighbours differ by; an edge that comes past, by all.
    jumps = ((moved > (high - low) * (4 * MOVE)) & (moved > excess / 2)).any(axis=2)
    most = quantile(upper(jumps.sum()) * share) if excess else 0
    strange = beyond & ~((ours >= low - bound) & (ours <= high + bound)).all(axis=2)
    if strange.any():
        y, x = next(zip(*numpy.nonzero(strange)))
        problems.append(f"colour: {strange.sum()} pixels unlike all of POV-Ray's around them; the first at {x},{y}: {theirs[y, x]} and {ours[y, x]}")
    if beyond.sum() > most:
        y, x = next(zip(*numpy.nonzero(beyond)))
        problems.append(f"colour: {beyond.sum()} pixels beyond their bounds, {most} may be; the first at {x},{y}: {theirs[y, x]} and {ours[y, x]}, "
                        f"bound {bound[y, x].max():.1e}")
    return problems, float(error[~(beyond | leave)].max())
