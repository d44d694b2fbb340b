"""Rays that leave their hits, closest points, distances and rays of cameras, from Python."""
import numpy
import pytest

import glint
from glint.open3d import RaycastingScene
from conftest import CUBE, FACES


def test_a_convex_surface_hides_nothing_from_itself(device):
    random = numpy.random.default_rng(1)
    sphere = glint.Scene(device=device)
    sphere.add_spheres([[1e5, 0, 0]], 3.0)
    sphere.commit()
    inwards = random.normal(size=(300, 3))
    hits = sphere.cast([1e5, 0, 0] - 10 * inwards / numpy.linalg.norm(inwards, axis=1, keepdims=True), inwards, want=("point", "origin", "normal"))
    directions = random.normal(size=(300, 20, 3))
    directions *= numpy.sign((directions * hits.normal[:, None]).sum(-1, keepdims=True))
    assert not sphere.occluded(hits.origin[:, None], directions, leave=True).any()
    assert numpy.isinf(sphere.cast(hits.origin[:, None], directions, leave=True).t).all()
    assert sphere.occluded(2 * hits.point[:, None] - hits.origin[:, None], -directions, leave=True).all()
    with pytest.raises(glint.Error, match="certified"):
        sphere.cast(hits.origin, hits.normal, want="sure", leave=True)


def test_closest_points(device):
    cube = glint.Scene(CUBE, FACES, device)
    points = numpy.array([[[0, 0, 0.5], [0, 0, 3]], [[2, 3, 1], [0.5, -0.25, -1]]])
    closest = cube.closest_point(points, want=("point", "t", "geometry", "primitive", "normal"))
    assert closest.t.tolist() == [[0.5, 2], [pytest.approx(numpy.sqrt(5)), 0]]
    assert closest.point.tolist() == [[[0, 0, 1], [0, 0, 1]], [[1, 1, 1], [0.5, -0.25, -1]]]
    assert closest.geometry.tolist() == [[0, 0], [0, 0]] and closest.normal[0, 0].tolist() == [0, 0, 1]
    assert cube.distance(points).tolist() == closest.t.tolist()
    assert cube.signed_distance(points)[0].tolist() == [-0.5, 2]
    assert cube.closest_point(points[:0]).point.shape == (0, 2, 3)
    assert cube.closest_point([0, 0, 3], want="t", dtype=numpy.float32).t.dtype == numpy.float32
    assert numpy.isinf(cube.distance([[numpy.nan, 0, 0]])).all()
    assert numpy.isinf(glint.Scene(device=device).commit().distance([[0, 0, 0]])).all()
    with pytest.raises(glint.Error, match="^hits.sure"):
        cube.closest_point(points, want="sure")


def test_distances_as_open3d_has_them(device):
    scene = RaycastingScene(device)
    scene.add_triangles(CUBE, FACES)
    points = [[0, 0, 0.5], [0, 0, 3]]
    closest = scene.compute_closest_points(points)
    assert closest["points"].tolist() == [[0, 0, 1], [0, 0, 1]] and closest["points"].dtype == numpy.float32
    assert set(closest) == {"points", "geometry_ids", "primitive_ids", "primitive_uvs", "primitive_normals"}
    assert scene.compute_distance(points).tolist() == [0.5, 2]
    assert scene.compute_signed_distance(points).tolist() == [-0.5, 2]


def test_pinhole_rays(device):
    lens = numpy.array([[120, 3, 31.5], [0, 110, 20.25], [0, 0, 1]])
    turn, _ = numpy.linalg.qr(numpy.random.default_rng(2).normal(size=(3, 3)))
    place = numpy.column_stack((turn, [0.3, -0.2, 2]))
    rays = glint.pinhole_rays(lens, place, 64, 40)
    assert rays.shape == (40, 64, 6) and glint.pinhole_rays(lens, place, 8, 4, numpy.float32).dtype == numpy.float32
    # Each point of a ray projects to its pixel's centre, and t is its depth.
    seen = (rays[..., :3] + 7 * rays[..., 3:]) @ turn.T + place[:, 3]
    assert seen[..., 2] == pytest.approx(numpy.full((40, 64), 7))
    pixels = seen @ lens.T / 7
    assert pixels[..., 0] == pytest.approx(numpy.tile(numpy.arange(64) + 0.5, (40, 1)))
    assert pixels[..., 1] == pytest.approx(numpy.tile((numpy.arange(40) + 0.5)[:, None], (1, 64)))
    wall = glint.Scene(numpy.array([[-99, -99, 0], [99, -99, 0], [0, 99, 0.0]]), device=device).prepare()
    looking = glint.pinhole_rays([[50, 0, 16], [0, 50, 12], [0, 0, 1]], [[1, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, 6]], 32, 24)
    assert wall.cast(looking, want="t").t == pytest.approx(numpy.full((24, 32), 6), rel=1e-6)
    for lens, place, size, message in ((numpy.eye(2), place, 4, "shape"), (lens, turn, 4, "matrix"), (lens, place, 0, "width")):
        with pytest.raises(ValueError, match=message):
            glint.pinhole_rays(lens, place, size, 4)
    with pytest.raises(glint.Error, match="focal length"):
        glint.pinhole_rays(numpy.diag([0, 1, 1]), place, 4, 4)
    with pytest.raises(glint.Error, match="committed"):
        glint.Scene(device=device).prepare()


def test_messages_name_no_functions_of_c(device):
    scene = glint.Scene(device=device)
    for ask in (lambda: scene.cast([[0, 0, 0, 0, 0, 1]]), lambda: scene.add_instance(7, numpy.eye(4)), lambda: scene.material("none"),
                lambda: scene.add_spheres([[0, 0, 0]], -1), lambda: scene.commit().render(8, 8, camera="none"),
                lambda: scene.all_hits([[0, 0, 0, 0, 0, 1]], want="sure"), lambda: scene.add_triangles(CUBE[:1], FACES)):
        with pytest.raises(glint.Error) as raised:
            ask()
        assert "glint_" not in str(raised.value)
