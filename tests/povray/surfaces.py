"""Materials of glint's scenes as textures of POV-Ray's.

`where` places (u, v) on an object: a 3x4 matrix that takes points of a flat object to (u, v, height above the surface),
("sphere", center), or None for meshes and for objects whose (u, v) POV-Ray does not have.
"""
import math

import numpy

from language import OBJECT_CODE, SCALE, Refused, array, colour, matrix, number, rgb

IMAGES = {".png": "png", ".jpg": "jpeg", ".jpeg": "jpeg"}


class NeedsChannels(Refused):
    """A coloured highlight: POV-Ray's `specular` is a number, so each channel takes an image of its own."""


def affine(rows):
    return numpy.vstack([rows, [0, 0, 0, 1]])


def pair(value):
    return list(map(float, value)) if isinstance(value, list) else [float(value)] * 2


def to_pattern(where, texture, even):
    """The keyword that POV-Ray needs before the pattern, and the matrix from the pattern's space to the object's."""
    (su, sv), (ou, ov) = pair(texture.get("scale", 1)), pair(texture.get("offset", [0, 0]))
    scaled = array([[su, 0, 0, ou], [0, sv, 0, ov], [0, 0, 1, 0.5], [0, 0, 0, 1]])
    if isinstance(where, numpy.ndarray):
        return "", numpy.linalg.inv(scaled @ affine(where))
    if isinstance(where, tuple):
        # POV-Ray's u of a sphere begins at +x and grows towards +z: ours is 3/4 less that, up to a whole number.
        if su % (2 if even else 1):
            raise Refused("a texture whose ends do not meet round a sphere")
        turned = array([[-1, 0, 0, 0.75], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
        return "uv_mapping ", numpy.linalg.inv(scaled @ turned)
    raise Refused("a texture on this kind of object")


def image(translation, texture, where):
    """The pigment of an image, and the grey that it is multiplied with."""
    tint = colour(texture.get("color", 1))
    if len(set(tint)) > 1:
        raise Refused("an image with a color")
    wraps = texture.get("wrap", "repeat")
    wraps = set(wraps if isinstance(wraps, list) else [wraps])
    plain = texture.get("scale", 1) == 1 and texture.get("offset", [0, 0]) == [0, 0]
    # POV-Ray's `once` repeats the border as far as the image reaches, so it is `clamp` where (u, v) stay within 0 and 1.
    if wraps != {"repeat"} and not (wraps == {"clamp"} and plain and isinstance(where, numpy.ndarray)):
        raise Refused(f"an image with wrap {' and '.join(sorted(wraps))}")
    path = (translation.folder / texture["texture"]).resolve()
    if path.suffix not in IMAGES:
        raise Refused(f"an image {path.suffix}")
    options = f'{IMAGES[path.suffix]} "{path}" gamma srgb{" once" if wraps == {"clamp"} else ""}'
    if texture.get("filter", "bilinear") == "bilinear":
        options += " interpolate 2"
    if isinstance(where, tuple):
        if not plain:
            raise Refused("an image on a sphere with a scale")
        # map_type 1 has u = 0 at +x, growing towards +z; ours is u = 1/2 at +z, growing towards +x.
        x, y, z = where[1]
        turned = array([[0, 0, -1, z], [0, 1, 0, -y], [-1, 0, 0, x], [0, 0, 0, 1]])
        return f"pigment {{ image_map {{ {options} map_type 1 }} {matrix(numpy.linalg.inv(turned))} }}", tint[0]
    mapping, m = to_pattern(where, texture, False)
    return f"pigment {{ {mapping}image_map {{ {options} }} {matrix(m)} }}", tint[0]


def highlight(translation, material):
    shine = colour(material.get("specular", 0))
    if not any(shine):
        return ""
    if len(set(shine)) > 1 and translation.channel is None:
        raise NeedsChannels("a coloured highlight")
    exponent = material.get("shininess", 32)
    if exponent <= 0:
        raise Refused("a highlight of shininess 0")
    return f" specular {number(shine[translation.channel or 0])} roughness {number(1 / exponent)}"


def clear(translation, material):
    """A dielectric: what Fresnel's equations do not reflect passes and is filtered. `conserve_energy` takes 1 - R of it."""
    for key in ("diffuse", "ambient", "mirror"):
        if any(colour(material.get(key, 0))):
            raise Refused(f"a dielectric with {key}")
    if translation.scene.get("transmissiveShadows", "colored") != "colored":
        raise Refused("transmissiveShadows: full")
    passes = colour(material["transmission"])
    return (f"texture {{ pigment {{ rgbf <{','.join(map(number, passes))},1> }} finish {{ ambient 0 diffuse 0{highlight(translation, material)} "
            f"reflection {{ 0, 1 fresnel on }} conserve_energy }} }}")


def interior(translation, material):
    """POV-Ray weakens neither what is reflected inside a body nor shadow rays, nor what lies inside of it: Beer's law only where none is seen."""
    ior, absorbs = material.get("ior", 1.5), colour(material.get("attenuation", 0))
    if "attenuationColor" in material:
        absorbs = [-math.log(c) / material["attenuationDistance"] for c in colour(material["attenuationColor"])]
    if not any(absorbs):
        return f" interior {{ ior {number(ior)} }}"
    if ior != 1 or translation.scene.get("lights"):
        raise Refused("attenuation with reflections or lights")
    # exp(-(1 - fade_color) depth / fade_distance)
    most = max(absorbs)
    return f" interior {{ ior 1 fade_power 1001 fade_distance {number(SCALE / most)} fade_color {rgb([1 - a / most for a in absorbs])} }}"


def ambient(translation, material, diffuse):
    """The factor of POV-Ray's pigment, the diffuse colour, in the ambient light."""
    light = translation.ambient
    if "ambient" not in material or material["ambient"] == material.get("diffuse"):
        return light
    if isinstance(diffuse, dict) or isinstance(material["ambient"], dict):
        raise Refused("an ambient colour beside a texture")
    wanted = colour(material["ambient"])
    if any(w and not d for w, d in zip(wanted, colour(diffuse))):
        raise Refused("an ambient colour without a diffuse one")
    return [l * w / d if d else 0 for l, w, d in zip(light, wanted, colour(diffuse))]


def opaque(translation, material, where):
    diffuse = material.get("diffuse", 0.8)
    glow, amount = ambient(translation, material, diffuse), 1.0
    if isinstance(diffuse, dict):
        pigment, amount = image(translation, diffuse, where)
        glow = [amount * g for g in glow]
    else:
        pigment = f"pigment {{ {rgb(colour(diffuse))} }}"
    mirror = colour(material.get("mirror", 0))
    reflection = f" reflection {{ {rgb(mirror)} }}" if any(mirror) else ""
    return (f"texture {{ {pigment} finish {{ ambient {rgb(glow)} diffuse {number(amount)}"
            f"{highlight(translation, material)}{reflection} }} }}")


def checkers(material):
    """The one pattern of a material's checkers (None: there is none), and the materials of its first and second colours."""
    found = {key: value for key, value in material.items() if isinstance(value, dict) and "checker" in value}
    if not found:
        return None, material, material
    patterns = [{k: v for k, v in value.items() if k not in ("checker", "color")} for value in found.values()]
    if any(p != patterns[0] for p in patterns):
        raise Refused("checkers of several sizes in one material")
    sides = [dict(material), dict(material)]
    for key, value in found.items():
        tint = colour(value.get("color", 1))
        for side, painted in zip(sides, value["checker"]):
            side[key] = [c * t for c, t in zip(colour(painted), tint)]
    return patterns[0], *sides


def texture(translation, material, where):
    if translation.kind == "objects":
        return f"texture {{ pigment {{ {rgb([(translation.count + 1) * OBJECT_CODE / 65535, 0, 0])} }} finish {{ ambient 0 diffuse 0 emission 1 }} }}"
    known = {"ambient", "diffuse", "specular", "shininess", "mirror", "transmission", "ior", "attenuation", "attenuationColor",
             "attenuationDistance", "priority"}
    if set(material) - known:
        raise Refused(f"material: {', '.join(sorted(set(material) - known))}")
    pattern, first, second = checkers(material)
    if isinstance(material.get("transmission"), dict):
        raise Refused("a texture of what passes")
    paint = clear if translation.is_clear(material) else lambda t, m: opaque(t, m, where)
    if pattern is None:
        return paint(translation, material)
    if pattern.get("solid"):
        scale, corner = float(pattern.get("scale", 1)), array(pattern.get("corner", [0, 0, 0]))
        mapping, m = "", numpy.linalg.inv(affine(numpy.column_stack([scale * numpy.eye(3), -scale * corner])))
    else:
        mapping, m = to_pattern(where, pattern, True)
    return f"texture {{ {mapping}checker {paint(translation, first)} {paint(translation, second)} {matrix(m)} }}"
