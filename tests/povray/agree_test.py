#!/usr/bin/env python3
"""POV-Ray, an independent renderer, renders scenes of this repository, and the images agree: GLINT [--backend gpu|cpu]... [--only NAME]...

Compared are the object that each pixel shows, and the colours. Bounds are derived (judge.py).
"""
import argparse
import concurrent.futures
import math
import pathlib
import shutil
import sys

import numpy

import broken
import draw
import judge
import meshes
import translate
from language import OBJECT_CODE, array, colour, transform
from surfaces import NeedsChannels

HERE = pathlib.Path(__file__).resolve().parent
SCENES = HERE.parent.parent / "scenes"
SIZE = (160, 120)
CASES = [SCENES / f"{name}.json" for name in ("spheres", "quadrics", "lights", "orthographic", "polygons", "spots", "checker", "triangles", "discs",
                                                "groups", "knot", "cabinet", "corridor", "horizon", "shift", "bow_ties")]
CASES += [HERE / "scenes" / f"{name}.json" for name in ("glass", "textures", "veils")]


def flat_objects(listed, outer=numpy.eye(4)):
    for o in listed:
        placed = outer @ transform(o.get("transform", []))
        if o["type"] == "group":
            yield from flat_objects(o["objects"], placed)
        else:
            yield o, placed


class Theirs:
    """POV-Ray's images of a scene: objects and colours, and both of them moved a little."""

    def __init__(self, path, scene, pool):
        folder = path.parent
        self.scene, self.folder, self.pool = scene, folder, pool
        aside = (judge.MOVE, judge.MOVE)
        self.asked = {"colour": self.colour((0.0, 0.0)), "right": self.colour((judge.MOVE, 0.0)), "down": self.colour((0.0, judge.MOVE)),
                      "fine right": self.colour((judge.FINE, 0.0)), "fine down": self.colour((0.0, judge.FINE)),
                      "objects": self.draw(kind="objects"), "objects moved": self.draw(kind="objects", shift=aside)}
        wrong = list(broken.of(path.stem, scene))
        self.broken = {name: self.colour((0.0, 0.0), s) for name, s in wrong}
        self.broken_objects = {name: self.draw(s, kind="objects") for name, s in wrong if name in broken.OBJECTS}

    def draw(self, scene=None, **options):
        return self.pool.submit(draw.povray, translate.translate(scene or self.scene, self.folder, SIZE, **options), SIZE)

    def colour(self, shift, scene=None):
        try:
            return [self.draw(scene, shift=shift)] * 3
        except NeedsChannels:
            return [self.draw(scene, shift=shift, channel=c) for c in range(3)]

    def moved(self, how=""):
        """What moving the film to the right and down changes of each channel, at most."""
        still, right, down = (together(self.asked[name]) for name in ("colour", how + "right", how + "down"))
        return numpy.maximum(abs(right - still), abs(down - still))


def numbers(picture):
    """The objects that a flat picture shows."""
    return picture.result()[:, :, 0] / OBJECT_CODE - 1


def together(channels):
    return numpy.stack([picture.result()[:, :, c] for c, picture in enumerate(channels)], axis=2) / 65535


def view(scene):
    """The eye, and a pixel's angle, or for parallel rays minus its size."""
    c = scene.get("camera", {})
    eye = array(c.get("eye", [0, 0, 5]))
    if c.get("type") == "orthographic":
        return eye, -c.get("height", 4) / SIZE[1]
    return eye, 2 * math.tan(math.radians(c.get("fovY", 40)) / 2) / SIZE[1]


def facet_sides(scene, folder, layers):
    """Pixels of smooth meshes whose triangle faces the eye or a light otherwise than its interpolated normal does: glint goes by both, POV-Ray by the
    interpolated one alone, so there they mean different things."""
    leave = numpy.zeros(SIZE[::-1], bool)
    ids, faces, points = layers["object"][:, :, 0], layers["primitive"][:, :, 0], layers["position"]
    for number, (o, placed) in enumerate(flat_objects(scene["objects"])):
        if o["type"] != "mesh":
            continue
        mesh = meshes.read(folder / scene["meshes"][o["mesh"]]["file"])
        if not mesh.normals:
            continue
        of_face = {}
        for number_of_face, corners in mesh.outlines:
            a, b, c = (placed[:3, :3] @ array(mesh.vertices[i]) for i in corners)
            of_face.setdefault(number_of_face, []).append(numpy.cross(b - a, c - a))
        for y, x in zip(*numpy.nonzero(ids == number)):
            s, p = layers["normal"][y, x], points[y, x]
            towards = [view(scene)[0] - p] + [-array(l["direction"]) if l["type"] == "directional" else array(l["position"]) - p for l in scene["lights"]]
            leave[y, x] = any((n @ way > 0) != (s @ way > 0) for n in of_face[faces[y, x]] for way in towards)
    return leave


def mesh_rounding(scene, folder):
    """What keeping meshes in fp32 does: the greatest shift of a vertex, relative, and turn of a flat triangle's normal."""
    shift = turn = 0.0
    for o, _ in flat_objects(scene["objects"]):
        if o["type"] == "mesh":
            mesh = meshes.read(folder / scene["meshes"][o["mesh"]]["file"])
            exact = array(mesh.vertices)
            rounded = exact.astype(numpy.float32).astype(float)
            if (exact == rounded).all():
                continue
            shift = judge.U
            corners = array([f[0] for f in mesh.faces]).astype(int)
            normals = [numpy.cross(v[corners[:, 1]] - v[corners[:, 0]], v[corners[:, 2]] - v[corners[:, 0]]) for v in (exact, rounded)]
            sines = numpy.linalg.norm(numpy.cross(*normals), axis=1) / numpy.maximum(1e-300, numpy.prod([numpy.linalg.norm(n, axis=1) for n in normals], axis=0))
            # An interpolated normal is rounded three times over, its own numbers and its weights.
            turn = max(turn, 3 * judge.U if mesh.normals else float(sines.max()))
    return shift, turn


def lighting(scene, folder):
    sums = sum((array(colour(light.get("intensity", 1))) for light in scene.get("lights", [])), numpy.zeros(3))
    used = list(scene.get("materials", {}).values())
    for m in scene.get("meshes", {}).values():
        used += meshes.read(folder / m["file"]).materials.values()
    shiny = [m for m in used if any(colour(m.get("specular", 0)))]
    return judge.Light(depth=scene.get("maxDepth", 5), lights=len(scene.get("lights", [])), total=float(sums.max()),
                       shine=max([max(colour(m["specular"])) for m in shiny], default=0.0) * float(sums.max()),
                       exponent=max([m.get("shininess", 32) for m in shiny], default=0.0))


def compare(scene, folder, theirs, layers, backend):
    """The faults, and the greatest difference of colours within its bound. layers: of glint's image."""
    depth = scene.get("maxDepth", 5) + 1
    rounding = judge.rounding_of(backend, *mesh_rounding(scene, folder))
    most, mean = judge.blur(view(scene)[0], layers["depth"], view(scene)[1])
    share = rounding.typical * mean / judge.MOVE  # of the pixels that the film's move changes, those that rounding does
    leave, asked = facet_sides(scene, folder, layers), theirs.asked
    still, ids = numbers(asked["objects"]), layers["object"][:, :, 0]

    def objects(picture):
        return judge.classes("objects", picture, ids, judge.upper((still != numbers(asked["objects moved"])).sum()) * share)

    moved = theirs.moved()
    response = judge.neighbourhood(moved, numpy.maximum) / judge.MOVE * math.sqrt(2)
    light, blurred = lighting(scene, folder), depth * rounding.place * most
    if rounding.arithmetic:
        # What rounding may turn into anything: edges, and patterns finer than it, as a checker's at the horizon. Moving the film by as little
        # changes POV-Ray's picture there by more than a slope does (and the steps of two outputs).
        slope = judge.colour_bound(together(asked["colour"]), response, rounding, max(blurred, judge.FINE), light)
        leave |= (theirs.moved("fine ") > slope + judge.STEP).any(axis=2)
    def colours(picture):
        bound = judge.colour_bound(picture, response, rounding, blurred, light)
        return judge.colours(picture, layers["color"], bound, moved, depth * share, leave | (still != ids))

    faults, error = colours(together(asked["colour"]))
    missed = [f"{name}: colours" for name, picture in theirs.broken.items() if not colours(together(picture))[0]]
    missed += [f"{name}: objects" for name, picture in theirs.broken_objects.items() if not objects(numbers(picture))]
    return objects(still) + faults + [f"not told apart from {m}" for m in missed], error


def run(options):
    """Compares all cases, prints a line for each, and returns the number of disagreements."""
    wrong, refused = 0, 0
    threads = concurrent.futures.ThreadPoolExecutor
    with threads(8) as pov_pool, threads(2) as glint_pool:  # most of POV-Ray's half second it sleeps
        cases = [(path, translate.load(path)) for path in CASES if not options.only or path.stem in options.only]
        layers = ("color", "object", "primitive", "position", "normal", "depth")
        drawn = [(path, scene, Theirs(path, scene, pov_pool),
                  {backend: glint_pool.submit(draw.glint, options.glint, scene, path.parent, SIZE, backend, layers) for backend in options.backend})
                 for path, scene in cases]
        for path, scene, theirs, ours in drawn:
            refused += len(theirs.broken)
            for backend in options.backend:
                problems, error = compare(scene, path.parent, theirs, ours[backend].result(), backend)
                print(f"{path.stem}, {backend}: " + ("; ".join(problems) or f"agrees, colours within {error:.1e}"), flush=True)
                wrong += bool(problems)
    print(f"{len(drawn)} scenes, {refused} broken translations")
    return wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("glint", type=pathlib.Path)
    parser.add_argument("--backend", action="append", choices=("gpu", "cpu"))
    parser.add_argument("--only", action="append", help="a scene's name")
    options = parser.parse_args()
    options.glint, options.backend = options.glint.resolve(), options.backend or ["cpu", "gpu"]
    if shutil.which("povray") is None:
        raise SystemExit("povray is not installed (Debian package povray)")
    return bool(run(options))


if __name__ == "__main__":
    sys.exit(main())
