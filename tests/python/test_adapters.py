"""The adapters: names, shapes and meanings of trimesh and of Open3D."""
import types

import numpy
import pytest

from glint.open3d import RaycastingScene
from glint.trimesh import RayMeshIntersector
from test_glint import CUBE, FACES


@pytest.fixture(params=["cpu", ""], scope="module")
def selector(request):
    return request.param


def test_trimesh(selector):
    rays = RayMeshIntersector(types.SimpleNamespace(vertices=CUBE, faces=FACES), selector)
    origins, directions = numpy.array([[0.25, 0.5, 5], [9, 9, 9], [0.1, 0.2, 0]]), numpy.array([[0, 0, -1.0]] * 3)
    locations, index_ray, index_tri = rays.intersects_location(origins, directions)
    assert index_ray.tolist() == [0, 0, 2]
    assert locations == pytest.approx(numpy.array([[0.25, 0.5, 1], [0.25, 0.5, -1], [0.1, 0.2, -1]]), abs=1e-6)
    assert all(CUBE[FACES[triangle], 2].tolist() == [z] * 3 for triangle, z in zip(index_tri, (1, -1, -1)))
    locations, index_ray, _ = rays.intersects_location(origins, directions, multiple_hits=False)
    assert index_ray.tolist() == [0, 2] and locations[:, 2] == pytest.approx([1, -1])
    first = rays.intersects_first(origins, directions)
    assert first[1] == -1 and first[0] == index_tri[0]
    assert rays.intersects_id(origins, directions)[0].tolist() == index_tri.tolist()
    assert rays.intersects_any(origins, directions).tolist() == [True, False, True]
    assert rays.contains_points([[0, 0, 0], [2, 0, 0]]).tolist() == [True, False]


def test_open3d(selector):
    scene = RaycastingScene(selector)
    assert scene.add_triangles(CUBE.astype(numpy.float32), FACES.astype(numpy.uint32)) == 0
    assert scene.add_triangles(CUBE + [10, 0, 0], FACES) == 1
    rays = numpy.array([[[0.25, 0.5, 5, 0, 0, -1], [10.25, 0.5, 0, 0, 0, -1]], [[9, 9, 9, 1, 0, 0], [-5, 0.1, 0.2, 1, 0, 0]]], numpy.float32)
    found = scene.cast_rays(rays)
    assert found["t_hit"].dtype == numpy.float32 and found["t_hit"].shape == (2, 2)
    assert found["t_hit"].ravel() == pytest.approx([4, 1, numpy.inf, 4])
    assert found["geometry_ids"].ravel().tolist() == [0, 1, scene.INVALID_ID, 0]
    assert found["primitive_uvs"].shape == (2, 2, 2) and found["primitive_normals"].shape == (2, 2, 3)
    assert scene.test_occlusions(rays, tfar=2).tolist() == [[False, True], [False, False]]
    assert scene.count_intersections(rays).tolist() == [[2, 1], [0, 4]]
    listed = scene.list_intersections(rays)
    assert listed["ray_splits"].tolist() == [0, 2, 3, 3, 7]
    assert listed["ray_ids"].tolist() == [0, 0, 1, 3, 3, 3, 3]
    assert listed["geometry_ids"].tolist() == [0, 0, 1, 0, 0, 1, 1]
    assert scene.compute_occupancy([[0, 0, 0], [5, 0, 0]]).tolist() == [1, 0]
