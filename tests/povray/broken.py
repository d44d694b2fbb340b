"""Translations that are wrong by a little: each must be refused, or the comparison is worth nothing."""
import copy


def change(pointer, new):
    """Replaces the value at a JSON pointer by new(value)."""
    def edit(scene):
        *way, last = [int(step) if step.isdigit() else step for step in pointer.split("/")[1:]]
        for step in way:
            scene = scene[step]
        scene[last] = new(scene.get(last) if isinstance(scene, dict) else scene[last])
    return edit


def scale(pointer, factor):
    return change(pointer, lambda value: [x * factor for x in value] if isinstance(value, list) else value * factor)


def put(pointer, value):
    return change(pointer, lambda _: value)


def exchange_lights(scene):
    a, b = scene["lights"][:2]
    a["intensity"], b["intensity"] = b["intensity"], a["intensity"]


def drop_object(number):
    return lambda scene: scene["objects"].pop(number)


# What is wrong, the scene, how.
BROKEN = [
    ("a light 1 % farther away", "spheres", scale("/lights/0/position", 1.01)),
    ("shininess x 1.01", "spheres", scale("/materials/red/shininess", 1.01)),
    ("a radius x 1.001", "spheres", scale("/objects/1/radius", 1.001)),
    ("a mirror x 1.001", "spheres", scale("/materials/mirror/mirror", 1.001)),
    ("ambient light x 1.001", "spheres", scale("/ambient", 1.001)),
    ("diffuse x 1.001", "spheres", scale("/materials/red/diffuse", 1.001)),
    ("index 1.501", "glass", put("/materials/glass/ior", 1.501)),
    ("1 - 0.001 of what passes", "glass", scale("/materials/glass/transmission", 0.999)),
    ("one reflection fewer", "glass", put("/maxDepth", 4)),
    ("a texture upside down", "textures", put("/materials/wall/diffuse/scale", [0.5, -1])),
    ("a texture a hundredth aside", "textures", put("/materials/tiles/diffuse/offset", [0.31, 0.1])),
    ("a ball's image turned by 0.1 degrees", "textures", put("/objects/2/transform/0/rotate", [0, 0, 1, -23.3])),
    ("nearest for bilinear", "textures", put("/materials/wall/diffuse/filter", "nearest")),
    ("a checker's colours exchanged", "checker", put("/materials/ball/diffuse/checker", [[0.7, 0.1, 0.1], 0.9])),
    ("attenuation x 1.01", "veils", scale("/materials/smoke/attenuation", 1.01)),
    ("a cone 0.1 degrees wider", "spots", put("/lights/1/angle", 8.1)),
    ("no falloff", "lights", put("/lights/3/falloff", "none")),
    ("two lights' colours exchanged", "lights", exchange_lights),
    ("a light missing", "discs", lambda scene: scene["lights"].pop()),
    ("a small object missing", "discs", drop_object(6)),
    ("a target 0.001 higher", "polygons", put("/camera/target", [0, 0.951, 0])),
    ("a picture upside down", "polygons", put("/camera/up", [0, -1, 0])),
    ("a film 0.1 % higher", "orthographic", scale("/camera/height", 1.001)),
    ("an upright film", "cabinet", lambda scene: scene["camera"].pop("planeNormal")),
    ("a transform turned by 0.1 degrees", "groups", put("/objects/1/objects/1/transform/1/rotate", [0, 1, 0, 200.1])),
    ("a coefficient x 1.001", "quadrics", scale("/objects/12/coefficients/9", 1.001)),
    ("an open body closed", "quadrics", put("/objects/1/capped", True)),
    ("a triangle's corner moved by 0.01", "triangles", put("/objects/0/vertices/2", [0, 1.41, 0])),
]


# Defects that the object layer shows, too.
OBJECTS = {"a target 0.001 higher", "a film 0.1 % higher", "an upright film"}


def of(stem, scene):
    """(what is wrong, the broken scene) of those that break this one."""
    for name, where, edit in BROKEN:
        if where == stem:
            wrong = copy.deepcopy(scene)
            edit(wrong)
            yield name, wrong
