"""Random scenes for tools/soak: every kind of object, transform, material, texture, light and camera, at sizes from 1e-6 to 1e6.

A *profile* is what the scenes of a batch have in common: which kinds and features they may have. Scenes of one profile need the same
kernels, whose compilation would otherwise take most of the time.
"""
import math
import struct
import zlib

SOLIDS = ["sphere", "box", "ellipsoid", "cylinder", "cone", "quadric", "ball"]  # closed: may be of glass
SURFACES = ["plane", "disc", "triangle", "polygon", "open", "hyperboloid", "paraboloid", "mesh"]
KINDS = SOLIDS + SURFACES


class Profile:
    def __init__(self, dice):
        self.kinds = dice.sample(KINDS, dice.randint(1, 5))
        self.mirror = dice.random() < 0.5
        self.glass = dice.random() < 0.35 and any(kind in SOLIDS for kind in self.kinds)
        self.textures = dice.random() < 0.3
        self.checkers = dice.random() < 0.3
        self.masks = dice.random() < 0.15
        self.transforms = dice.random() < 0.6
        self.uneven = self.transforms and dice.random() < 0.5
        self.groups = dice.random() < 0.3
        self.environment = dice.random() < 0.2
        self.lights = dice.choice([0, 1, 1, 2, 3, 9])
        self.camera = dice.choice(["perspective"] * 4 + ["orthographic", "lens", "oblique", "clipped"])
        self.shadows = dice.choice(["colored", "full"])
        self.depth = dice.choice([0, 1, 3, 5, 8, 16])


def direction(dice):
    while True:
        v = [dice.uniform(-1, 1) for _ in range(3)]
        length = math.hypot(*v)
        if 0.1 < length < 1:
            return [x / length for x in v]


def color(dice, least=0.0, most=1.0):
    grey = dice.uniform(least, most)
    return grey if dice.random() < 0.4 else [dice.uniform(least, most) for _ in range(3)]


class Maker:
    def __init__(self, dice, profile, folder, name):
        self.dice, self.profile, self.folder, self.name = dice, profile, folder, name
        # The scene's own unit, and where it lies: single precision has 7 digits, whatever they stand for.
        self.unit = 10.0 ** dice.choice([0, 0, 0, 0, dice.uniform(-6, 6)])
        self.middle = [0.0, 0.0, 0.0]
        if dice.random() < 0.25:
            self.middle = [dice.uniform(-1, 1) * self.unit * 10.0 ** dice.uniform(0, 5) for _ in range(3)]
        self.meshes, self.files = {}, 0

    def at(self, spread=2.0):
        return [m + self.unit * self.dice.uniform(-spread, spread) for m in self.middle]

    def size(self):
        """Of an object, mostly near the unit; now and then a grain, or a planet."""
        dice = self.dice
        return self.unit * dice.choice([dice.uniform(0.2, 1)] * 6 + [10.0 ** dice.uniform(-4, 0), 10.0 ** dice.uniform(0, 3)])

    def path(self, ending):
        self.files += 1
        return self.folder / f"{self.name}-{self.files}.{ending}"

    def image(self, alpha):
        """A PNG of a few random texels."""
        dice = self.dice
        width, height = dice.randint(1, 9), dice.randint(1, 9)
        rows = b"".join(b"\0" + bytes(dice.randrange(256) if channel < 3 or alpha else 255 for _ in range(width) for channel in range(4))
                        for _ in range(height))

        def chunk(kind, data):
            return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        path = self.path("png")
        path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)) +
                         chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))
        return path.name

    def textured(self, plain):
        dice, profile = self.dice, self.profile
        if profile.checkers and dice.random() < 0.5:
            made = {"checker": [color(dice), color(dice)], "scale": dice.uniform(0.5, 5)}
            if dice.random() < 0.3:
                made.update(solid=True, scale=dice.uniform(0.5, 3) / self.unit, corner=self.at())
            return made
        if profile.textures and dice.random() < 0.5:
            return {"texture": self.image(False), "wrap": dice.choice(["repeat", "clamp", "mirror"]),
                    "filter": dice.choice(["bilinear", "nearest"]), "scale": [dice.uniform(-4, 4) or 1, dice.uniform(0.2, 4)],
                    "offset": [dice.uniform(-2, 2), dice.uniform(-2, 2)], "color": color(dice)}
        return plain

    def material(self, solid):
        dice, profile = self.dice, self.profile
        if profile.glass and solid and dice.random() < 0.6:
            made = {"transmission": self.textured(color(dice, 0.3)), "ior": dice.choice([1, 1.33, 1.5, 2.4, dice.uniform(0.5, 3)]),
                    "priority": dice.randint(0, 3)}
            if dice.random() < 0.5:
                made["attenuation"] = color(dice, 0, 2 / self.unit)
            if dice.random() < 0.3:
                made["diffuse"] = color(dice, 0, 0.3)
        else:
            made = {"diffuse": self.textured(color(dice))}
            if profile.mirror and dice.random() < 0.5:
                made["mirror"] = self.textured(color(dice, 0, 0.9))
            if profile.masks and dice.random() < 0.5:
                made["diffuse"] = {"texture": self.image(True)}
                made["alphaCutoff"] = dice.uniform(0.1, 0.9)
        if dice.random() < 0.4:
            made["specular"] = color(dice)
            made["shininess"] = 10.0 ** dice.uniform(0, 4)
        return made

    # ---- objects ----

    def axis(self):
        base, way, length = self.at(), direction(self.dice), self.size()
        if self.dice.random() < 0.3:
            way = [0.0, self.dice.choice([-1.0, 1.0]), 0.0]
        return base, [b + length * w for b, w in zip(base, way)], length

    def sphere(self):
        return {"type": "sphere", "center": self.at(), "radius": self.size()}

    def box(self):
        corner = self.at()
        return {"type": "box", "min": corner, "max": [c + self.size() for c in corner]}

    def ellipsoid(self):
        size = self.size()
        return {"type": "ellipsoid", "center": self.at(), "radii": [size * 10 ** self.dice.uniform(-1.5, 0) for _ in range(3)]}

    def cylinder(self, capped=True):
        base, top, length = self.axis()
        return {"type": "cylinder", "base": base, "top": top, "radius": length * 10 ** self.dice.uniform(-2, 0.5), "capped": capped}

    def cone(self, capped=True):
        base, apex, length = self.axis()
        radius = length * 10 ** self.dice.uniform(-2, 0.5)
        made = {"type": "cone", "base": base, "apex": apex, "radius": radius, "capped": capped}
        if self.dice.random() < 0.4:
            made["topRadius"] = radius * self.dice.choice([0.3, 0.999, 2.5])
        return made

    def open(self):
        return self.dice.choice([self.cylinder, self.cone])(False)

    def hyperboloid(self):
        base, top, length = self.axis()
        radius = length * self.dice.uniform(0.1, 1)
        return {"type": "hyperboloid", "base": base, "top": top, "radius": radius, "waist": radius * self.dice.uniform(0.05, 0.99),
                "capped": self.dice.random() < 0.5}

    def paraboloid(self):
        vertex, top, length = self.axis()
        return {"type": "paraboloid", "vertex": vertex, "top": top, "radius": length * self.dice.uniform(0.05, 2),
                "capped": self.dice.random() < 0.5}

    def quadric(self):
        """x^2 A + ... - J < 0 about the object's own middle; a transform takes it to its place."""
        dice, size = self.dice, self.size()
        squares = [dice.uniform(0.3, 2) / size ** 2 for _ in range(3)]
        products = [dice.uniform(-0.2, 0.2) / size ** 2 for _ in range(3)]
        linear = [dice.uniform(-0.3, 0.3) / size for _ in range(3)]
        reach = size * dice.uniform(0.5, 2)
        return {"type": "quadric", "coefficients": squares + products + linear + [-1.0], "bounds": [[-reach] * 3, [reach] * 3],
                "transform": [{"translate": self.at()}]}

    def plane(self):
        normal = direction(self.dice) if self.dice.random() < 0.3 else [0, 1, 0]
        point = [m - self.unit * (0 if i != 1 else self.dice.uniform(1, 3)) for i, m in enumerate(self.middle)]
        return {"type": "plane", "point": point, "normal": normal}

    def disc(self):
        return {"type": "disc", "center": self.at(), "normal": direction(self.dice), "radius": self.size()}

    def triangle(self):
        place, size = self.at(), self.size()
        corners = [[p + size * self.dice.uniform(-1, 1) for p in place] for _ in range(3)]
        if self.dice.random() < 0.2:  # a needle
            corners[2] = [a + 0.5 * (b - a) + 1e-4 * size * d for a, b, d in zip(corners[0], corners[1], direction(self.dice))]
        return {"type": "triangle", "vertices": corners}

    def polygon(self):
        """In the plane z = 0 of its own, a star or what chance makes of a few corners."""
        dice, size = self.dice, self.size()
        count = dice.randint(3, 12)
        radii = [size * dice.uniform(0.2, 1) for _ in range(count)]
        order = list(range(count)) if dice.random() < 0.7 else dice.sample(range(count), count)
        corners = [[radii[i] * math.cos(2 * math.pi * i / count), radii[i] * math.sin(2 * math.pi * i / count), 0.0] for i in order]
        return {"type": "polygon", "vertices": corners,
                "transform": [{"rotate": direction(dice) + [dice.uniform(0, 360)]}, {"translate": self.at()}]}

    def ball(self):
        """A closed mesh: a bumpy sphere of triangles."""
        dice, size = self.dice, self.size()
        rings, around = dice.randint(3, 9), dice.randint(3, 12)
        bumps = dice.uniform(0, 0.3)

        def point(ring, step):
            polar, turn = math.pi * ring / rings, 2 * math.pi * step / around
            r = size * (1 + dice.uniform(-bumps, bumps))
            return [r * math.sin(polar) * math.cos(turn), r * math.cos(polar), -r * math.sin(polar) * math.sin(turn)]
        corners = [point(0, 0)] + [point(ring, step) for ring in range(1, rings) for step in range(around)] + [point(rings, 0)]
        faces = []
        for step in range(around):
            beside = (step + 1) % around
            faces.append((0, 1 + step, 1 + beside))
            for ring in range(rings - 2):
                a, b = 1 + ring * around + step, 1 + ring * around + beside
                faces += [(a, a + around, b), (b, a + around, b + around)]
            last = 1 + (rings - 2) * around
            faces.append((len(corners) - 1, last + beside, last + step))
        return self.of_mesh(corners, faces)

    def mesh(self):
        """A piece of ground, whose triangles share edges and vertices, or triangles anywhere."""
        dice, size = self.dice, self.size()
        if dice.random() < 0.3:
            corners = [[size * dice.uniform(-1, 1) for _ in range(3)] for _ in range(3 * dice.randint(1, 60))]
            return self.of_mesh(corners, [(i, i + 1, i + 2) for i in range(0, len(corners), 3)])
        count, height = dice.randint(2, 12), dice.choice([0.0, 0.1, 1.0]) * size
        corners = [[size * (2 * x / (count - 1) - 1), dice.uniform(-height, height), size * (2 * z / (count - 1) - 1)]
                   for z in range(count) for x in range(count)]
        faces = []
        for z in range(count - 1):
            for x in range(count - 1):
                a = z * count + x
                faces += [(a, a + count, a + 1), (a + 1, a + count, a + count + 1)]
        return self.of_mesh(corners, faces)

    def of_mesh(self, corners, faces):
        path = self.path("obj")
        path.write_text("".join(f"v {x!r} {y!r} {z!r}\n" for x, y, z in corners) +
                        "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in faces))
        self.meshes[path.stem] = {"file": path.name}
        return {"type": "mesh", "mesh": path.stem, "transform": [{"translate": self.at()}]}

    def transform(self):
        """About the scene's middle, so that what it moves stays in sight."""
        dice = self.dice
        steps = [{"translate": [-m for m in self.middle]}]
        for _ in range(dice.randint(1, 3)):
            scale = dice.uniform(0.5, 2) * dice.choice([1, 1, -1])
            if self.profile.uneven:
                scale = [scale * 10 ** dice.uniform(-1, 0.5) for _ in range(3)]
            steps.append(dice.choice([{"scale": scale}, {"rotate": direction(dice) + [dice.uniform(-360, 360)]},
                                      {"rotate": dice.choice([[1, 0, 0, 90], [0, 1, 0, 45], [0, 0, 1, 180]])},
                                      {"translate": [self.unit * x for x in direction(dice)]}]))
        return steps + [{"translate": self.middle}]

    def object(self, materials):
        dice, profile = self.dice, self.profile
        kind = dice.choice(profile.kinds)
        made = getattr(self, kind)()
        if profile.transforms and kind != "plane" and dice.random() < 0.6:
            made["transform"] = made.get("transform", []) + self.transform()
        name = f"m{len(materials)}"
        if materials and dice.random() < 0.3:
            name = dice.choice([known for known in materials if kind in SOLIDS or "transmission" not in materials[known]] or [name])
        materials.setdefault(name, self.material(kind in SOLIDS))
        made["material"] = name
        if profile.groups and dice.random() < 0.4:
            made = {"type": "group", "transform": self.transform(), "objects": [made]}
        return made

    # ---- what is around them ----

    def light(self, kind=None):
        dice = self.dice
        kind = kind or dice.choice(["point", "directional", "spot"])
        made = {"type": kind, "intensity": color(dice, 0.1, 1)}
        if kind == "directional":
            return {**made, "direction": direction(dice)}
        made["position"] = self.at(dice.choice([4, 4, 4, 0.5, 100]))
        if dice.random() < 0.3:
            made["falloff"] = "inverseSquare"
            made["intensity"] = color(dice, 0, 4 * self.unit ** 2)
        if kind == "spot":
            angle = dice.uniform(5, 80)
            made.update(direction=[m - p + self.unit * 0.1 for m, p in zip(self.middle, made["position"])], angle=angle,
                        penumbra=dice.choice([0, dice.uniform(0, 40)]))
        return made

    def camera(self):
        dice, kind = self.dice, self.profile.camera
        way, distance = direction(dice), self.unit * dice.choice([6, 6, 4, 2, 30])
        made = {"eye": [m + distance * w for m, w in zip(self.middle, way)], "target": self.at(0.5),
                "up": [0, 1, 0] if abs(way[1]) < 0.95 else [1, 0, 0], "fovY": dice.choice([40, 40, 20, 90, 2])}
        if kind == "orthographic":
            made.update(type="orthographic", height=self.unit * dice.uniform(2, 6))
            del made["fovY"]
        if kind == "lens":
            made["lensRadius"] = self.unit * 10 ** dice.uniform(-3, -0.5)
            made["focusDistance"] = distance * dice.uniform(0.5, 2)
        if kind == "oblique":
            made["planeNormal"] = [w + 0.3 * d for w, d in zip(way, direction(dice))]
        if kind == "clipped":
            made["near"] = distance * dice.uniform(0.2, 0.9)
            made["far"] = distance * dice.uniform(1, 3)
        return made

    def scene(self):
        dice, profile = self.dice, self.profile
        materials = {}
        objects = [self.object(materials) for _ in range(dice.choice([1, 2, 4, 8, 8, 16, 40]))]
        background = color(dice)
        if profile.environment:
            background = {"environment": self.image(False), "rotation": dice.uniform(0, 360)}
        return {"camera": self.camera(), "background": background, "ambient": color(dice, 0, 0.3), "maxDepth": profile.depth,
                "transmissiveShadows": profile.shadows, "lights": [self.light() for _ in range(profile.lights)],
                "materials": materials, "meshes": self.meshes, "objects": objects}

    def seen_otherwise(self, dice, scene):
        """The scene from elsewhere, under other lights of the same kinds: what it is made of, and so what kernels it needs, stays."""
        self.dice = dice
        return {**scene, "camera": self.camera(), "ambient": color(dice, 0, 0.3),
                "lights": [self.light(light["type"]) for light in scene["lights"]]}

    def crowd(self, dice, scene):
        """Adds a mesh of a few thousand triangles with texture coordinates that several objects share, some of them mirrored: instances.
        What else chance makes of the scene stays as it is without."""
        self.dice, around = dice, 40
        bumps = dice.uniform(0, 0.2)
        lines, faces = [], []
        for ring in range(around + 1):
            for step in range(around):
                polar, turn = math.pi * ring / around, 2 * math.pi * step / around
                r = 1 + bumps * math.sin(3 * turn) * math.sin(polar) * math.sin(5 * polar)
                x, y, z = r * math.sin(polar) * math.cos(turn), r * math.cos(polar), -r * math.sin(polar) * math.sin(turn)
                lines.append(f"v {x!r} {y!r} {z!r}\nvt {0.5 + x / 3!r} {0.5 + z / 3!r}\n")
                a, b = ring * around + step + 1, ring * around + (step + 1) % around + 1
                faces += [f"f {a}/{a} {a + around}/{a + around} {b}/{b}\n",
                          f"f {b}/{b} {a + around}/{a + around} {b + around}/{b + around}\n"] if ring < around else []
        path = self.path("obj")
        path.write_text("".join(lines) + "".join(faces))
        self.meshes[path.stem] = {"file": path.name}
        scene["materials"]["crowd"] = self.material(True)
        for _ in range(dice.randint(4, 9)):
            size = self.unit * dice.uniform(0.1, 0.6)
            scales = [size * dice.uniform(0.5, 1.5) * dice.choice([1, -1]) for _ in range(3)]
            scene["objects"].append({"type": "mesh", "mesh": path.stem, "material": "crowd", "transform": [
                {"scale": scales}, {"rotate": direction(dice) + [dice.uniform(-360, 360)]}, {"translate": self.at()}]})
        return scene
