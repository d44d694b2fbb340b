"""The Python module on the reference and on a Vulkan device: shapes and types of arrays, answers, errors.

GLINT_LIBRARY says where libglint.so.0 is, GLINT_SOURCE where scenes/ is.
"""
import concurrent.futures
import os
import pathlib
import signal
import threading
import time
import tracemalloc

import numpy
import pytest

import glint
from conftest import CUBE, FACES

SCENES = pathlib.Path(os.environ["GLINT_SOURCE"]) / "scenes"


def test_a_known_hit_and_a_miss(cube):
    hits = cube.cast([[0.25, 0.5, 5], [9, 9, 9]], [0, 0, -2], want=("hit", "t", "geometry", "primitive", "material", "uv", "point", "normal"))
    assert hits.hit.tolist() == [True, False]
    assert hits.t[0] == pytest.approx(2) and numpy.isinf(hits.t[1])
    assert hits.geometry.tolist() == [0, glint.NONE]
    assert hits.primitive[0] in (10, 11) and hits.primitive[1] == glint.NONE
    a, b, c = CUBE[FACES[hits.primitive[0]]]
    u, v = hits.uv[0]
    assert (1 - u - v) * a + u * b + v * c == pytest.approx(hits.point[0], abs=1e-6)
    assert hits.normal[0] == pytest.approx([0, 0, 1])


def test_origins_and_directions_as_numpy_broadcasts_them(cube):
    origins = numpy.array([[[0.2, 0.3, 5]], [[0.2, 0.3, -5]]])
    directions = numpy.array([[[0, 0, -1], [0, 0, 1], [0, 0, -2]]], numpy.float32)
    for dtype in (numpy.float32, numpy.float64):
        assert cube.cast(origins.astype(dtype), directions).t.tolist() == [[4, numpy.inf, 2], [numpy.inf, 4, numpy.inf]]
    assert cube.cast(origins, directions[0, 0]).t.tolist() == [[4], [numpy.inf]]
    assert cube.cast(origins[0, 0], directions).t.tolist() == [[4, numpy.inf, 2]]
    assert cube.cast(origins[0], directions[0, 0]).t.tolist() == [4]


def test_only_what_is_wanted(cube):
    assert cube.cast([[0, 0, 5, 0, 0, -1]], want=("t",))._fields == ("t",)
    with pytest.raises(ValueError):
        cube.cast([[0, 0, 5, 0, 0, -1]], want=("colour",))


def test_certified_hits(cube):
    # Through the diagonal of a face, past a corner by less than fp32 resolves, and past everything.
    hits = cube.cast([[0, 0, 5], [1 + 1e-15, 1, 5], [9, 9, 9]], [0, 0, -1], want=("t", "sure", "t_lower", "t_upper"))
    assert hits.sure.dtype == bool and hits.sure.tolist() == [True, True, True]
    assert hits.t.tolist() == [4, numpy.inf, numpy.inf]
    assert hits.t_lower.tolist() == hits.t_upper.tolist() == hits.t.tolist()
    with pytest.raises(glint.Error):
        cube.all_hits([[0, 0, 5, 0, 0, -1]], want=("sure",))


@pytest.mark.parametrize("dtype", [numpy.float32, numpy.float64, int])
@pytest.mark.parametrize("shape", [(), (5,), (2, 3), (0,)])
def test_shapes_and_types(cube, dtype, shape):
    rays = numpy.broadcast_to(numpy.array([0, 0, 5, 0, 0, -1], dtype), shape + (6,))
    assert cube.cast(rays).t.shape == shape
    assert cube.cast(rays).normal.shape == shape + (3,)
    assert numpy.all(cube.cast(rays).t == 4)
    assert cube.occluded(rays).shape == shape and cube.occluded(rays).all()
    assert cube.count(rays).shape == shape and numpy.all(cube.count(rays) == 2)
    assert cube.contains(rays[..., 3:] * 0.5).shape == shape


def test_arrays_stay_as_they_stand(cube):
    table = numpy.zeros((10, 9), numpy.float32)  # a caller's table: rays in the middle columns, every second row, backwards
    table[:, 2:8] = [0, 0, 5, 0, 0, -1]
    table[:, 2] = numpy.linspace(-2, 2, 10)
    rays = table[::-2, 2:8]
    assert numpy.array_equal(cube.cast(rays).t, cube.cast(rays.copy()).t)
    fortran = numpy.asfortranarray(rays)
    assert numpy.array_equal(cube.cast(fortran).t, cube.cast(rays).t)


@pytest.mark.parametrize("dtype", [numpy.float32, numpy.float64])
def test_no_copies_of_rays(cube, dtype):
    count = 200_000
    table = numpy.zeros((count, 9), dtype)
    table[:, 2:8] = [0, 0, 5, 0, 0, -1]
    origins, directions = table[:, 2:5].copy(), table[:, 5:8].copy()
    batches = {"(n, 6)": (table[:, 2:8].copy(),), "(n, 6) in a table": (table[:, 2:8],), "backwards": (table[::-1, 2:8],),
               "(n, 3), (n, 3)": (origins, directions), "(n, 3) in a table": (table[:, 2:5], table[:, 5:8]),
               "one direction": (origins, directions[0]), "a picture": (origins.reshape(400, 500, 3), directions.reshape(400, 500, 3))}
    for name, batch in batches.items():
        held = glint._RayArrays(*batch, *([None] * (2 - len(batch))), None, None, False)
        assert numpy.shares_memory(held.kept[0], batch[0]) and numpy.shares_memory(held.kept[1], batch[-1]), name
        assert held.struct.origins.data == batch[0].ctypes.data, name
        # tracemalloc counts numpy's arrays: the only ones are the answers, one byte each, and their bools.
        tracemalloc.start()
        assert cube.occluded(*batch).all()
        _, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        assert peak < 3 * count, name


def test_intervals(cube):
    rays = numpy.tile([0.0, 0, 5, 0, 0, -1], (3, 1))
    assert cube.occluded(rays, t_max=[3, 4, 9]).tolist() == [False, True, True]
    assert cube.count(rays, t_min=[0, 5, 7]).tolist() == [2, 1, 0]
    assert cube.count(rays, t_max=4.5).tolist() == [1, 1, 1]


def test_all_hits(cube):
    offsets, hits = cube.all_hits([[0.1, 0.2, 5, 0, 0, -1], [9, 9, 9, 0, 0, 1], [0, 0, 0, 0.3, 0.1, 1]])
    assert offsets.tolist() == [0, 2, 2, 3]
    assert hits.t == pytest.approx([4, 6, 1], abs=1e-5)


def _unit(random, count):
    v = random.normal(size=(count, 3))
    return v / numpy.linalg.norm(v, axis=1)[:, None]


def test_insides(cube):
    points = [[0, 0, 0], [0.99, 0.99, 0.99], [1.01, 0, 0], [1, 0.3, 0.2], [1, 1, 1]]
    assert cube.locate(points).tolist() == [glint.INSIDE, glint.INSIDE, glint.OUTSIDE, glint.ON_SURFACE, glint.ON_SURFACE]
    assert cube.contains(points).tolist() == [True, True, False, False, False]


def test_scenes_are_filled_and_changed(device):
    scene = glint.Scene(device=device)
    ball = scene.add_spheres([[10, 0, 0], [20, 0, 0]], [1, 2])
    mesh = scene.add_triangles(CUBE, FACES)
    more = scene.add_json('{"materials": {"red": {}}, "objects": [{"type": "disc", "center": [30, 0, 1], "normal": [0, 0, 1], '
                          '"radius": 1, "material": "red"}]}')
    moved = scene.add_instance(mesh, [[1, 0, 0, 40], [0, 1, 0, 0], [0, 0, 1, 0]])
    assert (ball, mesh, more, moved, scene.material("red")) == (0, 2, range(3, 4), 4, 0)
    scene.commit()
    downwards = [[x, 0.1, 9, 0, 0, -1] for x in (10, 20, 0.2, 30, 40.2)]
    assert scene.cast(downwards).geometry.tolist() == [0, 1, 2, 3, 4]
    scene.set_transform(moved, numpy.diag([1, 1, 2, 1]) + numpy.array([[0, 0, 0, 50], [0] * 4, [0] * 4, [0] * 4]))
    scene.set_vertices(mesh, CUBE * [1, 1, 3])
    scene.commit()
    assert scene.cast([[0.2, 0.1, 9, 0, 0, -1], [50.2, 0.1, 9, 0, 0, -1]]).t == pytest.approx([6, 3], abs=1e-5)
    assert scene.bounds[1] == pytest.approx([51, 2, 6], abs=1e-4)
    assert scene.triangles == 24 and scene.warnings == [] and scene.refits == 1
    with pytest.raises(glint.Error, match="vertex 3 is not finite"):
        scene.set_vertices(mesh, numpy.where(numpy.arange(8)[:, None] == 3, numpy.nan, CUBE))


def test_a_device_has_settings():
    lines = []
    device = glint.Device("cpu", threads=1, max_bytes=20000, log=lines.append)
    scene = glint.Scene(CUBE, FACES, device=device)
    assert lines == ["device: cpu", "committed: 1 geometries, 12 triangles, trees built"]
    assert scene.occluded([[0, 0, 9, 0, 0, -1]]).all()
    with pytest.raises(glint.Error, match="max_bytes is 20000"):
        scene.add_triangles(numpy.zeros((3000, 3)))


def test_memory_may_be_refused(capfd):
    held, most = 0, 0

    def ask(count):
        nonlocal held, most
        if count > 10_000_000:
            return False
        held += count
        most = max(most, held)
        return True
    device = glint.Device("cpu", memory=ask)
    scene = glint.Scene(CUBE, FACES, device=device)
    assert 0 < held <= most
    with pytest.raises(glint.Error, match="memory callback refused") as error:
        scene.add_triangles(numpy.zeros((3_000_000, 3)))
    assert error.value.status == "memory"
    assert scene.commit().occluded([[0, 0, 9, 0, 0, -1]]).all()
    del scene, device, error  # the error's frames hold the scene
    assert held == 0
    assert capfd.readouterr().err == ""
    with pytest.raises(glint.Error, match="memory callback refused"):  # what it raises is printed
        glint.Scene(CUBE, FACES, device=glint.Device("cpu", memory=lambda count: 1 / 0))
    assert "ZeroDivisionError" in capfd.readouterr().err


def _sheet(folder):
    """A wavy sheet of 2 * 150^2 triangles in an OBJ file."""
    n = 150
    y, x = numpy.mgrid[0:n + 1, 0:n + 1]
    points = numpy.stack([x, y, numpy.sin(x / 9) * numpy.cos(y / 7)], -1).reshape(-1, 3)
    corner = (y * (n + 1) + x)[:-1, :-1].reshape(-1, 1) + 1
    faces = numpy.concatenate([corner + [0, 1, n + 2], corner + [0, n + 2, n + 1]])
    path = folder / "a.obj"
    path.write_text("\n".join(["v %r %r %r" % tuple(p) for p in points.tolist()] + ["f %d %d %d" % tuple(f) for f in faces]) + "\n")
    return path


def test_loads_are_watched_and_cancelled(device, tmp_path):
    path = _sheet(tmp_path)
    parts, asked = [], 0

    def count():
        nonlocal asked
        asked += 1
        return False
    scene = glint.Scene.load(path, device, cancelled=count, progress=parts.append)
    assert scene.triangles == 2 * 150 ** 2
    assert parts == sorted(set(parts)) and parts[-1] == 1
    assert sum(part < 0.5 for part in parts) > 2 and sum(0.5 < part < 1 for part in parts) > 2  # during reading, and during building
    for at in {1, asked // 3, 2 * asked // 3}:
        left = iter(range(at))
        with pytest.raises(glint.Error) as error:
            glint.Scene.load(path, device, cancelled=lambda: next(left, None) is None)
        assert error.value.status == "cancelled"
    with pytest.raises(ZeroDivisionError):
        glint.Scene.load(path, device, progress=lambda part: part > 0.3 and 1 / 0)
    with pytest.raises(glint.Error, match="cancelled"):
        scene.commit(cancelled=lambda: True)
    parts.clear()
    assert scene.commit(progress=parts.append).occluded([[70, 70, 9, 0, 0, -1]]).all()
    assert parts == sorted(set(parts)) and parts[-1] == 1


def test_pictures(device):
    picture = glint.render(SCENES / "spheres.json", 32, 24, 1, device=device)
    assert picture.shape == (24, 32, 4) and picture.dtype == numpy.float32
    layers = glint.Scene.load(SCENES / "spheres.json", device).render(32, 24, 1, layers=("color", "depth", "geometry"))
    assert numpy.array_equal(layers.color, picture)
    assert numpy.array_equal(numpy.isfinite(layers.depth), layers.geometry != glint.NONE)
    assert 0.1 < numpy.isfinite(layers.depth).mean() < 1
    above = glint.Scene.load(SCENES / "spheres.json", device).render(32, 24, 1, layers=("depth",), camera=((0, 900, 0), (0, 0, 0), (0, 0, 1)))
    assert above.depth[12, 16] > 800


def test_cameras_by_name(device, tmp_path):
    scene = '{"camera": %s, "cameras": {"top": {"type": "orthographic", "eye": [0, 9, 1], "height": 5}}, "objects": [{"type": "box", "min": [-1, -1, -1], "max": [1, 1, 1]}]}'
    (tmp_path / "own.json").write_text(scene % '{"type": "orthographic", "eye": [0, 9, 1], "height": 5}')
    (tmp_path / "named.json").write_text(scene % '{"eye": [0, 0, 5]}')
    own = glint.render(tmp_path / "own.json", 32, 24, 1, device=device, layers=("depth",))
    named = glint.render(tmp_path / "named.json", 32, 24, 1, device=device, layers=("depth",), camera="top")
    assert numpy.array_equal(own.depth, named.depth) and numpy.isfinite(own.depth).any()
    with pytest.raises(glint.Error, match='no camera "tip" .there are "top".'):
        glint.render(tmp_path / "named.json", 32, 24, 1, device=device, camera="tip")


def test_pictures_to_an_error(device):
    scene = glint.Scene.load(SCENES / "lights.json", device)
    truth = scene.render(32, 24, 4096).astype(float)
    for error in (0.02, 0.005):
        picture = glint.render(scene, 32, 24, error=error)
        assert picture.shape == (24, 32, 4)
        off = numpy.sqrt(numpy.mean((picture - truth)[..., :3] ** 2))
        assert off <= error
    with pytest.warns(RuntimeWarning, match="target 0.001 not reached"):
        scene.render(32, 24, error=0.001, max_samples=2)
    for wrong in ({"error": 0.01, "samples": 4}, {"error": 0.01, "confidence": 1.5}, {"error": 0.01, "max_samples": 1},
                  {"error": numpy.inf}, {"error": 1e-12}):
        with pytest.raises(glint.Error) as refused:
            scene.render(32, 24, **wrong)
        assert refused.value.status == "argument"
    with pytest.raises(ValueError):
        scene.render(32, 24, error=-1)
    parts = []
    scene.render(32, 24, error=0.005, progress=parts.append)
    assert parts and parts == sorted(parts)


def test_errors(device, cube):
    with pytest.raises(glint.Error) as error:
        glint.Scene.load(__file__, device)
    assert error.value.status == "scene" and __file__ in str(error.value)
    with pytest.raises(glint.Error):
        glint.Scene(CUBE, FACES + 1, device)
    with pytest.raises(ValueError):
        glint.Scene(CUBE, FACES - 1, device)
    with pytest.raises(ValueError):
        cube.cast(numpy.zeros((4, 5)))
    with pytest.raises(ValueError, match=r"origins of the shape \(4,\) and directions of the shape \(3,\)"):
        cube.cast(numpy.zeros((4, 3)), numpy.zeros((3, 3)))
    with pytest.raises(ValueError, match="origins has something that is not a number"):
        cube.cast([["a", 0, 0]], [0, 0, 1])
    with pytest.raises(TypeError, match="glint.Scene.load reads files"):
        glint.Scene("scene.json", device=device)
    with pytest.raises(glint.Error, match="the file name is empty"):
        glint.Scene.load("", device)
    with pytest.raises(glint.Error):
        glint.Scene(device=device).cast(numpy.zeros((1, 6)))
    with pytest.raises(glint.Error) as error:
        cube.cast(numpy.ones((10, 6)), cancelled=lambda: True)
    assert error.value.status == "cancelled"
    with pytest.raises(ZeroDivisionError):  # of a callback
        cube.cast(numpy.ones((10, 6)), cancelled=lambda: 1 / 0)
    parts = []
    cube.cast(numpy.ones((5000, 6)), progress=parts.append)
    assert parts == sorted(parts) and parts[-1] == 1


def test_what_people_pass_by_mistake(device, cube):
    ray = numpy.array([[0.2, 0.3, 5, 0, 0, -1]])
    for empty in ([], numpy.zeros((0, 6))):
        assert cube.cast(empty).t.shape == cube.count(empty).shape == (0,)
    assert cube.contains([]).shape == (0,) and cube.cast([], []).uv.shape == (0, 2)
    for faces in (FACES + 2**32, FACES + 0.5, FACES * numpy.nan, FACES[:, :2], FACES.ravel()):
        with pytest.raises(ValueError):
            glint.Scene(CUBE, faces, device)
    assert glint.Scene(CUBE, FACES.astype(float), device).cast(ray).t == 4
    for wrong in (int, numpy.float16):
        with pytest.raises(ValueError):
            cube.cast(ray, dtype=wrong)
    with pytest.raises(ValueError):
        cube.cast(ray * 1j)
    for matrix in (numpy.eye(3), numpy.zeros(12)):
        with pytest.raises(ValueError):
            cube.add_instance(0, matrix)
    with pytest.raises(ValueError):
        cube.render(4, 4, 1, camera=((0, 0, 5),))
    for size in ((-3, 4, 1), (4, -3, 1), (2**32 + 4, 4, 1), (10**6, 10**6)):
        with pytest.raises(ValueError, match="width and height"):
            cube.render(*size)
    with pytest.raises(AttributeError, match="Hits has no 'normal': only t, uv was requested"):
        _ = cube.cast(ray, want=("t", "uv")).normal
    for call in (lambda: cube.render(4, 4, -1), lambda: cube.render(4, 4, 2**32 + 1), lambda: cube.set_transform(2**32, numpy.eye(4)),
                 lambda: cube.set_vertices(2**32, CUBE), lambda: cube.add_instance(2**32, numpy.eye(4)),
                 lambda: cube.add_triangles(CUBE, FACES, 2**32), lambda: cube.cast(numpy.zeros((2, 3, 6)), t_min=numpy.zeros((3, 2)))):
        with pytest.raises(ValueError):
            call()
    for wrong in ({"threads": -1}, {"max_bytes": -1}, {"max_bytes": 2**64}, {"selector": "cpu\0"}):
        with pytest.raises(ValueError):
            glint.Device(**wrong)
    for call in (cube.add_json, cube.material, lambda name: glint.Scene.load(name, device)):
        with pytest.raises(ValueError, match="null character"):
            call("{}\0")
    assert glint.Device(None).info["usable"]
    other = glint.Scene(CUBE, FACES, device)
    other.__del__()
    with pytest.raises(glint.Error, match="scene is NULL"):
        other.cast(ray)
    assert cube.cast(ray, want="normal").normal.tolist() == [[0, 0, 1]]
    ray.setflags(write=False)
    for odd in (ray, ray.astype(">f8"), ray.astype(">f4"), numpy.repeat(ray, 3, 0)[::-1], numpy.asfortranarray(ray)):
        assert numpy.allclose(cube.cast(odd).t, 4)
    for nowhere in (numpy.nan, numpy.inf, 0):  # such rays miss
        assert cube.cast([[0.2, 0.3, 5, 0, 0, nowhere]]).t == numpy.inf


def test_what_is_printed(device, cube):
    name = device.info["name"]
    assert repr(device) == f"<glint.Device {name}>"
    assert repr(cube) == f"<glint.Scene of 1 geometries, 12 triangles, on {name}>"
    assert repr(glint.Scene(device=device)) == "<glint.Scene, not committed>"


def test_ctrl_c_ends_a_call(device):
    scene = glint.Scene.load(SCENES / "knot.json", device)
    rays = numpy.random.default_rng(3).normal(size=(100_000 if device.info["reference"] else 1_500_000, 6))
    scene.count(rays[:1000])  # the first call compiles kernels
    parts = []

    def press(part):
        if not parts:
            os.kill(os.getpid(), signal.SIGINT)
        parts.append(part)
    with pytest.raises(KeyboardInterrupt):
        scene.count(rays, progress=press)
    assert parts[-1] < 1
    assert scene.count(rays[:10]).shape == (10,)
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


@pytest.mark.parametrize("selector", ["cpu", ""])
def test_ctrl_c_ends_commits_and_loads(selector, tmp_path):
    """Interrupts at the first allocation, so that no clock decides the moment."""
    path = _sheet(tmp_path)
    taken, presses = [], []

    def memory(count):
        taken.append(count)
        if presses:
            presses.pop()
            os.kill(os.getpid(), signal.SIGINT)
        return True
    device, ray = glint.Device(selector, memory=memory), [[70, 70, 9, 0, 0, -1]]
    whole = glint.Scene.load(path, device)
    asked = sum(count > 0 for count in taken)
    taken.clear()
    presses.append(True)
    with pytest.raises(KeyboardInterrupt):
        glint.Scene.load(path, device)
    assert not presses and sum(taken) == 0 and sum(count > 0 for count in taken) < asked
    vertices = numpy.array([[0, 0, 0], [200, 0, 0], [0, 200, 0]] * 20_000, numpy.float32)
    scene = glint.Scene(device=device)
    scene.add_triangles(vertices)
    presses.append(True)
    with pytest.raises(KeyboardInterrupt):
        scene.commit()
    assert not presses
    with pytest.raises(glint.Error, match="has not been committed"):
        scene.count(ray)
    assert scene.commit().count(ray) == 20_000 and whole.occluded(ray).all()
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_threads_share_a_scene(cube):
    random = numpy.random.default_rng(2)
    rays = numpy.hstack([5 * _unit(random, 3000), random.normal(size=(3000, 3))])
    expected = cube.cast(rays).t
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        for answer in pool.map(lambda _: cube.cast(rays).t, range(4)):
            assert numpy.array_equal(answer, expected)


def test_others_run_meanwhile(device):
    scene = glint.Scene.load(SCENES / "knot.json", device)
    rays = numpy.random.default_rng(3).normal(size=(400_000, 6))
    thread = threading.Thread(target=scene.count, args=(rays,))
    thread.start()
    beats = 0
    while thread.is_alive():
        time.sleep(0.001)
        beats += 1
    assert beats > 10  # a call that held the interpreter's lock would leave a handful
