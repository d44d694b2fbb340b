#!/usr/bin/env python3
"""bench/kernel_profile.py tells the parts of a kernel by its loops, and lays samples over the right code: kernel_profile_test.py SOURCE"""
import pathlib
import sys
import unittest

SOURCE = pathlib.Path(sys.argv[1]).resolve()
sys.path.insert(0, str(SOURCE / "bench"))
import kernel_profile as profile  # noqa: E402

PLAIN, TOGETHER = False, True


class Code:
    """Machine code of plain instructions of four bytes and loops, and which part each instruction is meant to be."""

    def __init__(self):
        self.code, self.meant = [], []

    def add(self, op, rest, part):
        self.code.append((4 * len(self.code), op, rest))
        self.meant.append(part)

    def plain(self, part, count=45):
        for _ in range(count):
            self.add("vaddps", "%ymm0,%ymm1,%ymm2", part)
        return self

    def loop(self, together, part, body):
        """A loop whose own instructions are `part`; what `body` adds stands within."""
        start = 4 * len(self.code)
        if not together:
            self.add("vpermq", "$0x4e,%ymm0,%ymm1", part)  # for something else, far from the end
        self.plain(part)
        body()
        self.plain(part)
        if together:
            self.add("vpermq", "$0x4e,%ymm0,%ymm1", part)
        self.add("jne", f"{start:x} <cs_co_variant+0x{start:x}>", part)
        return self


def nothing():
    pass


def walk(code, ray, outside, leaves):
    """Loops of a walk with leaves of so many kinds; `outside`: what its rays wait for, in a loop around."""
    def inner():
        code.loop(TOGETHER, ray + profile.NODES, nothing)
        for leaf in leaves:
            code.loop(PLAIN, ray + leaf, nothing)

    if outside:
        code.loop(TOGETHER, ray + outside, lambda: code.loop(TOGETHER, ray + profile.BETWEEN, inner))
    else:
        code.loop(TOGETHER, ray + profile.BETWEEN, inner)


def kernel(bounces=True, planes=True, again=False, outside=None, leaves=("leaves of triangles", "leaves of spheres")):
    """What the driver makes of whole.comp."""
    code = Code()
    nearest, shadow = profile.NEAREST, profile.SHADOW

    def find():
        if planes:
            code.loop(PLAIN, nearest + profile.PLANES, nothing)
        walk(code, nearest, outside, leaves)

    def lights():
        if planes:
            code.loop(PLAIN, shadow + profile.PLANES, nothing)
        walk(code, shadow, outside, leaves)
        code.loop(PLAIN, profile.LIGHTS, nothing)

    def step():
        code.loop(TOGETHER, profile.READY, find) if again else find()
        code.plain(profile.SURFACE).loop(PLAIN, profile.SURFACE, nothing)
        code.loop(TOGETHER, profile.LIGHTS, lights)

    def whole_step():
        step()
        code.plain(profile.GOES_ON)
        start = 4 * len(code.code)
        code.plain(profile.WAITING, 15).add("jne", f"{start:x} <cs_co_variant+0x{start:x}>", profile.WAITING)
        code.plain(profile.GOES_ON)

    code.plain(profile.CAMERA)
    if bounces:
        # What stands before the walk makes rays ready, what stands behind the lights is what goes on.
        start = 4 * len(code.code)
        code.plain(profile.READY)
        whole_step()
        code.add("vpermq", "$0x4e,%ymm0,%ymm1", profile.GOES_ON)
        code.add("jne", f"{start:x} <cs_co_variant+0x{start:x}>", profile.GOES_ON)
    else:
        step()
    return code.plain(profile.STORE)


class Parts(unittest.TestCase):
    def check(self, code, features):
        self.assertEqual(profile.parts(code.code, features), code.meant)

    def test_reflections_and_planes(self):
        self.check(kernel(), ["triangles", "spheres", "planes"])

    def test_one_hit(self):
        self.check(kernel(bounces=False), ["triangles", "spheres", "planes"])

    def test_no_planes(self):
        self.check(kernel(planes=False), ["triangles", "spheres"])

    def test_looks_again(self):
        self.check(kernel(again=True), ["triangles", "spheres", "planes"])

    def test_instances_and_holes(self):
        self.check(kernel(outside=profile.OUTSIDE["instances"]), ["triangles", "spheres", "planes", "instances"])
        self.check(kernel(outside=profile.OUTSIDE["holes"], leaves=["leaves of all kinds in one loop"]), ["triangles", "spheres", "planes", "alphaMask"])

    def test_kinds_keep_their_order(self):
        self.check(kernel(leaves=["leaves of spheres", "leaves of polygons"]), ["polygons", "spheres", "planes"])

    def test_other_kernels_are_left_out(self):
        code = Code().plain("")
        walk(code, "", None, ["leaves of triangles"])
        self.assertIsNone(profile.parts(code.code, ["triangles"]))
        walk(code, "", None, ["leaves of triangles"])
        self.assertIsNone(profile.parts(code.code, ["triangles"]))


class Samples(unittest.TestCase):
    CODE = [(0x1b0, "push", ""), (0x1b4, "vaddps", ""), (0x1bd, "ret", "")]
    LATER = (0x7F0000, 0x7F8000, 3)

    def samples(self, offsets, piece, thread="2"):
        return [(float(i), piece[0] + offset, piece, thread) for i, offset in enumerate(offsets)]

    def test_other_code_at_the_same_address_is_not_taken(self):
        for number in range(20):  # whichever of the two is looked at first
            other = (*self.LATER[:2], 10 + number)
            samples = self.samples([0x1b4, 0x1b6] * 40, other) + self.samples([0x1b4, 0x1bd, 0x1bd] * 20, self.LATER)
            self.assertEqual(profile.lay_over(samples, self.CODE), {1: 20, 2: 40})

    def test_what_is_outside(self):
        inside = self.samples([0x1b0] * 60, self.LATER)
        system = [(5.0, 0xFFFFFFFF81000000, None, "2")] * 3
        host = [(6.0, 0xFFFFFFFF81000000, None, "1"), (6.0, 0x561450421000, None, "1"), (6.0, 0x561450421000, None, "2")]
        samples = host + inside[:30] + system + host + inside[30:] + system
        self.assertEqual(profile.lay_over(samples, self.CODE), {0: 60, profile.SYSTEM: 3, profile.HOST: 3})

    def test_none_found(self):
        self.assertIsNone(profile.lay_over(self.samples([0x1b1] * 80, self.LATER), self.CODE))


class Shares(unittest.TestCase):
    def test_all_parts_are_in_a_column(self):
        names = [profile.NEAREST + profile.NODES, profile.SHADOW + "leaves of spheres", profile.READY, profile.SHADOW + profile.PLANES,
                 profile.CAMERA, profile.SURFACE, profile.LIGHTS, profile.GOES_ON, profile.WAITING, profile.STORE, profile.SYSTEM, profile.HOST]
        cells = profile.columns({"parts": profile.collections.Counter({name: 1 + i for i, name in enumerate(names)})})
        self.assertEqual(len(cells) + 3, len(profile.HEADER))
        tracing, away = cells[profile.HEADER.index("**tracing**") - 3], cells[-1]
        self.assertAlmostEqual(tracing + away, 1)
        self.assertAlmostEqual(tracing, (1 + 2 + 3 + 4) / 78)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
