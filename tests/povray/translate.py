"""A scene of glint's in the language of POV-Ray 3.7, written from the documentation of both (docs/reference/shading.md; Debian's povray-doc).

What the two do not mean alike is refused by name (`Refused`), never approximated. Lengths are multiplied by SCALE, a power of two, so that
POV-Ray's fixed distances are small: a hit nearer than 1e-3 throws no shadow, one beyond 1e7 is none.
"""
import json
import math
import pathlib
import re

import numpy

import meshes
from language import SCALE, Refused, array, colour, number, rgb, transform, unit, vector
from shapes import shape

FAR = 8e6           # where a directional light stands, in POV-Ray's lengths
FADE = 2.0 ** -20   # the distance within which a light's falloff is not yet 1 / distance^2


def load(path):
    """A scene file without its comments."""
    text = re.sub(r'("(?:\\.|[^"\\])*")|//[^\n]*|/\*.*?\*/', lambda m: m[1] or " ", pathlib.Path(path).read_text(), flags=re.DOTALL)
    return json.loads(text)


def camera(c, size):
    """POV-Ray's film goes through location + direction, its edges half of `right` and `up` away."""
    known = {"type", "eye", "target", "up", "fovY", "height", "window", "planeNormal"}
    if set(c) - known:
        raise Refused(f"camera: {', '.join(sorted(set(c) - known))}")
    eye, width, height = array(c.get("eye", [0, 0, 5])), *size
    view = unit(array(c.get("target", [0, 0, 0])) - eye)
    w = -view
    if "planeNormal" in c:
        w = unit(c["planeNormal"])
        w = -w if w @ view > 0 else w
    u = unit(numpy.cross(c.get("up", [0, 1, 0]), w))
    v = numpy.cross(w, u)
    parallel = c.get("type", "perspective") == "orthographic"
    tall = c.get("height", 4) if parallel else 2 * math.tan(math.radians(c.get("fovY", 40)) / 2)
    left, right, bottom, top = c.get("window") or [-tall * width / height / 2, tall * width / height / 2, -tall / 2, tall / 2]
    middle = (left + right) / 2 * u + (bottom + top) / 2 * v
    unit_of = SCALE if parallel else 1  # a perspective film may stand at any distance
    location = SCALE * (eye + middle) if parallel else SCALE * eye
    return (f"camera {{ {'orthographic ' if parallel else ''}location {vector(location)} direction {vector(view if parallel else view + middle)} "
            f"right {vector(unit_of * (right - left) * u)} up {vector(unit_of * (top - bottom) * v)} }}\n")


def lamp(light):
    kind, intensity = light["type"], array(colour(light.get("intensity", 1)))
    if kind == "directional":
        return f"light_source {{ {vector(-FAR * unit(light['direction']))} {rgb(intensity)} parallel point_at 0 }}\n"
    position, more = array(light["position"]), ""
    if light.get("falloff", "none") == "inverseSquare":
        # 2 / (1 + (d / f)^2) is 2 f^2 / d^2 but for a relative f^2 / d^2: 1e-12 at a distance of 1.
        intensity, more = intensity / (2 * FADE * FADE), f" fade_distance {number(SCALE * FADE)} fade_power 2"
    if kind == "spot":
        angle, edge = light["angle"], light["angle"] + light.get("penumbra", 0)
        if edge > 90:
            raise Refused("light: a spot wider than 90 degrees")
        more += (f" spotlight radius {number(angle)} falloff {number(edge)} tightness 0 "
                 f"point_at {vector(SCALE * (position + unit(light['direction'])))}")
    return f"light_source {{ {vector(SCALE * position)} {rgb(intensity)}{more} }}\n"


class Translation:
    """What is asked of a translation, and what shapes and surfaces need to know of the scene."""

    def __init__(self, scene, folder, kind, channel):
        self.scene, self.folder, self.kind, self.channel = scene, pathlib.Path(folder), kind, channel
        self.materials, self.files = scene.get("materials", {}), {}
        self.ambient = colour(scene.get("ambient", 0))
        self.count = 0  # objects so far

    def material(self, name):
        return self.materials[name] if name else {}

    def mesh(self, name):
        if name not in self.files:
            self.files[name] = meshes.read(self.folder / self.scene["meshes"][name]["file"])
        return self.files[name]

    def is_clear(self, material):
        return any(colour(material.get("transmission", 0)))

    def objects(self, listed, outer, inherited):
        """The text of objects, with the groups' transforms after their own and the innermost group's material where they name none."""
        for o in listed:
            placed = outer @ transform(o.get("transform", []))
            named = o.get("material", inherited)
            if o["type"] == "group":
                yield from self.objects(o["objects"], placed, named)
                continue
            yield shape(self, o, named is not None, self.material(named), placed)
            self.count += 1


def translate(scene, folder, size, kind="colour", channel=None):
    """The scene as POV-Ray reads it.

    kind: "colour"; "objects", each a flat red of its number. channel: the one that the image is right in, where POV-Ray knows numbers and
    glint colours.
    """
    if scene.get("animation") or isinstance(scene.get("background"), dict):
        raise Refused("animation" if scene.get("animation") else "background: an environment map")
    out = ["#version 3.7;\n", f"global_settings {{ assumed_gamma 1 adc_bailout 0 max_trace_level {scene.get('maxDepth', 5) + 1} }}\n"]
    if kind == "colour":
        out.append(f"background {{ {rgb(colour(scene.get('background', 0)))} }}\n")
    out.append(camera(scene.get("camera", {}), size))
    if kind == "colour":
        out += map(lamp, scene.get("lights", []))
    translation = Translation(scene, folder, kind, channel)
    out += translation.objects(scene.get("objects", []), numpy.eye(4), None)
    return "".join(out)
