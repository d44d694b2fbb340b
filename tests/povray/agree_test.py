#!/usr/bin/env python3
"""POV-Ray, an independent renderer, renders scenes of this repository, and the images agree: GLINT [--only NAME]...

Compared are the object that each pixel shows, and the colours, with the double-precision reference. `glint verify` compares devices with the
reference.
"""
import argparse
import concurrent.futures
import pathlib
import shutil
import sys

import numpy

import broken
import draw
import meshes
import translate
from language import OBJECT_CODE, array
from surfaces import NeedsChannels

HERE = pathlib.Path(__file__).resolve().parent
SCENES = HERE.parent.parent / "scenes"
SIZE = (160, 120)
CASES = [SCENES / f"{name}.json" for name in ("spheres", "quadrics", "lights", "orthographic", "polygons", "spots", "checker", "triangles", "discs",
                                                "groups", "cabinet", "corridor", "horizon", "shift", "bow_ties")]
CASES += [HERE / "scenes" / f"{name}.json" for name in ("glass", "textures", "veils")]
U = 2.0 ** -24    # half a unit in the last place of fp32
STEP = 1 / 65535  # of POV-Ray's output


class Theirs:
    """POV-Ray's images of a scene and of the broken translations."""

    def __init__(self, path, scene, pool):
        self.folder, self.pool = path.parent, pool
        self.colours, self.objects = self.colour(scene), self.draw(scene, kind="objects")
        wrong = list(broken.of(path.stem, scene))
        self.broken = {name: self.colour(s) for name, s in wrong}
        self.broken_objects = {name: self.draw(s, kind="objects") for name, s in wrong if name in broken.OBJECTS}

    def draw(self, scene, **options):
        return self.pool.submit(draw.povray, translate.translate(scene, self.folder, SIZE, **options), SIZE)

    def colour(self, scene):
        try:
            return [self.draw(scene)] * 3
        except NeedsChannels:
            return [self.draw(scene, channel=c) for c in range(3)]


def colour_bound(theirs, scene):
    """Of each channel of each pixel. Both programs compute in double, so that edges are in the same place.

    - Half a STEP: the output is rounded.
    - POV-Ray's colours are fp32: what reaches the pixel of one light is rounded up to 8 times where it is made (pigment, light, falloff, two
      products, finish, two for roughness) and then once for each further light and five times (ambient, two products of the reflectivity, the
      sum, the output) at each surface on the way to the eye; the terms are positive, so the errors add up to at most as many U of the sum.
    """
    return STEP / 2 + (8 + (scene.get("maxDepth", 5) + 1) * (len(scene.get("lights", [])) + 5)) * U * theirs


def different(name, apart):
    """The fault of pixels that are apart, or none."""
    return [f"{name}: {apart.sum()} pixels differ; the first at {','.join(map(str, numpy.argwhere(apart)[0][::-1]))}"] if apart.any() else []


def compare(scene, folder, theirs, layers):
    """The faults, and the greatest difference of colours."""
    for mesh in scene.get("meshes", {}).values():  # POV-Ray keeps them in fp32
        exact = array(meshes.read(folder / mesh["file"]).vertices)
        assert (exact == exact.astype(numpy.float32)).all()
    ours = numpy.clip(layers["color"], 0, 1)  # as POV-Ray's output is

    def objects(picture):
        return different("objects", picture.result()[:, :, 0] / OBJECT_CODE - 1 != layers["object"][:, :, 0])

    def error(channels):
        picture = numpy.stack([p.result()[:, :, c] for c, p in enumerate(channels)], axis=2) / 65535
        return abs(picture - ours), colour_bound(picture, scene)

    def colours(channels):
        apart, bound = error(channels)
        return different("colours", ~(apart <= bound).all(axis=2))  # so that NaN is

    faults = objects(theirs.objects) + colours(theirs.colours)
    faults += [f"not told apart from {name}: colours" for name, picture in theirs.broken.items() if not colours(picture)]
    faults += [f"not told apart from {name}: objects" for name, picture in theirs.broken_objects.items() if not objects(picture)]
    return faults, error(theirs.colours)[0].max()


def run(program, cases):
    """Compares all cases, prints a line for each, and returns the number of disagreements."""
    wrong, refused = 0, 0
    threads = concurrent.futures.ThreadPoolExecutor
    with threads(8) as pov_pool, threads(2) as glint_pool:  # most of POV-Ray's half second it sleeps
        drawn = []
        for path in cases:
            scene = translate.load(path)
            ours = glint_pool.submit(draw.glint, program, scene, path.parent, SIZE, "cpu", ("color", "object"))
            drawn.append((path, scene, Theirs(path, scene, pov_pool), ours))
        for path, scene, theirs, ours in drawn:
            refused += len(theirs.broken)
            problems, error = compare(scene, path.parent, theirs, ours.result())
            print(f"{path.stem}: " + ("; ".join(problems) or f"agrees, colours within {error:.1e}"), flush=True)
            wrong += bool(problems)
    print(f"{len(drawn)} scenes, {refused} broken translations")
    return wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("glint", type=pathlib.Path)
    parser.add_argument("--only", action="append", help="a scene's name")
    options = parser.parse_args()
    if shutil.which("povray") is None:
        raise SystemExit("povray is not installed (Debian package povray)")
    return bool(run(options.glint.resolve(), [path for path in CASES if not options.only or path.stem in options.only]))


if __name__ == "__main__":
    sys.exit(main())
