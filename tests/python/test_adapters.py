"""The adapters: names, shapes and meanings of trimesh and of Open3D."""
import pickle
import types

import numpy
import pytest

from glint.open3d import RaycastingScene
from glint.trimesh import RayMeshIntersector
from conftest import CUBE, FACES


@pytest.fixture(params=["cpu", ""], scope="module")
def selector(request):
    return request.param


def test_trimesh(selector):
    rays = RayMeshIntersector(types.SimpleNamespace(vertices=CUBE, faces=FACES), selector, scale_to_box=False)
    origins, directions = numpy.array([[0.25, 0.5, 5], [9, 9, 9], [0.1, 0.2, 0]]), numpy.array([[0, 0, -1.0]] * 3)
    locations, index_ray, index_tri = rays.intersects_location(origins, directions)
    assert index_ray.tolist() == [0, 0, 2]
    assert locations == pytest.approx(numpy.array([[0.25, 0.5, 1], [0.25, 0.5, -1], [0.1, 0.2, -1]]), abs=1e-6)
    assert all(CUBE[FACES[triangle], 2].tolist() == [z] * 3 for triangle, z in zip(index_tri, (1, -1, -1)))
    all_tri = index_tri
    locations, index_ray, _ = rays.intersects_location(origins, directions, multiple_hits=False)
    assert index_ray.tolist() == [0, 2] and locations[:, 2] == pytest.approx([1, -1])
    first = rays.intersects_first(origins, directions)
    assert first[1] == -1 and first[0] == index_tri[0]
    # In trimesh's order, where the third is return_locations.
    assert len(rays.intersects_id(origins, directions)) == 2
    found = rays.intersects_id(origins, directions, True, False)
    assert [part.tolist() for part in found[:2]] == [[all_tri[0], all_tri[2]], [0, 2]] and found[2].shape == (2, 3)
    assert rays.intersects_id(origins, directions)[0].tolist() == all_tri.tolist()
    assert rays.intersects_id(origins, directions, max_hits=1)[0].tolist() == [all_tri[0], all_tri[2]]
    assert rays.intersects_id(origins, directions, max_hits=2)[1].tolist() == [0, 0, 2]
    assert rays.intersects_any(origins, directions).tolist() == [True, False, True]
    assert rays.contains_points([[0, 0, 0], [2, 0, 0]]).tolist() == [True, False]


class Mesh:
    def __init__(self):
        self.vertices, self.faces = CUBE.copy(), FACES.copy()


def test_trimesh_follows_the_mesh(selector):
    mesh = Mesh()
    mesh.ray = RayMeshIntersector(mesh, selector)
    before = mesh.ray.scene
    assert mesh.ray.contains_points([[0, 0, 0]]).tolist() == [True]
    assert mesh.ray.scene is before
    mesh.vertices += [3, 0, 0]  # in place
    assert mesh.ray.contains_points([[0, 0, 0], [3, 0, 0]]).tolist() == [False, True]
    assert mesh.ray.scene.device is before.device
    mesh.faces = numpy.concatenate([mesh.faces, mesh.faces + len(CUBE)])
    mesh.vertices = numpy.concatenate([mesh.vertices, mesh.vertices - [3, 0, 0]])
    assert mesh.ray.contains_points([[0, 0, 0], [3, 0, 0]]).tolist() == [True, True]
    # The mesh and its intersector refer to each other, as trimesh's do.
    other = pickle.loads(pickle.dumps(mesh))
    assert other.ray.mesh is other and other.ray.contains_points([[3, 0, 0], [9, 0, 0]]).tolist() == [True, False]
    with pytest.raises(ValueError, match="vertices"):
        RayMeshIntersector(types.SimpleNamespace(vertices=[1, 2], faces=FACES), selector)


def test_trimesh_trusts_the_hash_of_its_own_meshes(selector):
    asked = []

    class Hashed(Mesh):
        __module__ = "trimesh.base"

        def __hash__(self):
            asked.append(self)
            return hash((self.vertices.tobytes(), self.faces.tobytes()))
    mesh = Hashed()
    rays = RayMeshIntersector(mesh, selector)
    assert rays.contains_points([[0, 0, 0]]).tolist() == [True] and asked
    mesh.vertices += [3, 0, 0]
    assert rays.contains_points([[0, 0, 0]]).tolist() == [False]


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


class Tensor:
    """Stands for open3d.core.Tensor, which numpy.asarray cannot convert."""

    def __init__(self, numbers, place="cpu"):
        self.numbers, self.place = numbers, place

    @staticmethod
    def from_numpy(array):
        assert type(array) is numpy.ndarray
        return Tensor(array)

    def cpu(self):
        return Tensor(self.numbers)

    def numpy(self):
        assert self.place == "cpu"
        return self.numbers

    def __array__(self, *_arguments, **_named):
        raise TypeError("a tensor is no array")


def test_open3d_tensors(selector):
    mesh = types.SimpleNamespace(vertex={"positions": Tensor(CUBE.astype(numpy.float32), "gpu")}, triangle={"indices": Tensor(FACES)})
    scene = RaycastingScene(selector, nthreads=1)
    assert scene.add_triangles(mesh) == 0
    assert scene.add_triangles(Tensor(CUBE + [10, 0, 0]), Tensor(FACES)) == 1
    assert scene.add_triangles(mesh=mesh) == 2
    rays = Tensor(numpy.array([[0.25, 0.5, 5, 0, 0, -1], [9, 9, 9, 1, 0, 0]], numpy.float32))
    found = scene.cast_rays(rays, nthreads=2)
    assert {name: type(answer) for name, answer in found.items()} == dict.fromkeys(
        ("t_hit", "geometry_ids", "primitive_ids", "primitive_uvs", "primitive_normals"), Tensor)
    assert found["t_hit"].numpy() == pytest.approx([4, numpy.inf])
    assert scene.count_intersections(rays).numpy().dtype == numpy.int32
    assert scene.test_occlusions(rays).numpy().tolist() == [True, False]
    assert scene.list_intersections(rays)["ray_splits"].numpy().tolist() == [0, 4, 4]
    assert RaycastingScene(selector).compute_occupancy(Tensor(numpy.zeros((1, 3))), nsamples=3).numpy().tolist() == [0]
    # Arrays give arrays, with tensors' method numpy().
    hits = scene.cast_rays(rays.numpy())["t_hit"]
    assert isinstance(hits, numpy.ndarray) and type(hits.numpy()) is numpy.ndarray and hits.numpy() == pytest.approx([4, numpy.inf])
    for wrong in ((CUBE,), ()):
        with pytest.raises(TypeError, match="vertex_positions and triangle_indices"):
            scene.add_triangles(*wrong)


def test_open3d_pinhole():
    # From (2, 3, 4) along -y, x up, 90 degrees horizontally: the image plane at distance 1 is 2 wide and 1 high.
    rays = RaycastingScene.create_rays_pinhole(90, [2, 1, 4], [2, 3, 4], [5, 0, 0], 4, 2)
    assert rays.shape == (2, 4, 6) and rays.dtype == numpy.float32
    assert (rays[..., :3] == [2, 3, 4]).all()
    # To the right: up x forward = x x -y = -z.
    expected = [[[row, -1, -column] for column in (-0.75, -0.25, 0.25, 0.75)] for row in (-0.25, 0.25)]
    assert rays[..., 3:] == pytest.approx(numpy.array(expected), abs=1e-6)
    # The same by matrices: rows are right, up and forward.
    turn = numpy.array([[0, 0, -1.0], [1, 0, 0], [0, -1, 0]])
    place = numpy.eye(4)
    place[:3, :3], place[:3, 3] = turn, -turn @ [2, 3, 4]
    lens = numpy.array([[2, 0, 2], [0, 2, 1.0], [0, 0, 1]])
    same = RaycastingScene.create_rays_pinhole(intrinsic_matrix=Tensor(lens), extrinsic_matrix=place, width_px=4, height_px=2)
    assert isinstance(same, Tensor) and same.numpy() == pytest.approx(rays, abs=1e-6)
    with pytest.raises(TypeError, match="fov_deg"):
        RaycastingScene.create_rays_pinhole(90, [2, 1, 4], [2, 3, 4], 4, 2)
    with pytest.raises(TypeError, match="fov_deg"):
        RaycastingScene.create_rays_pinhole(lens, place, 4, width_px=2)
    for arguments, message in (((0, [2, 1, 4], [2, 3, 4], [5, 0, 0], 4, 2), "fov_deg"), ((90, [2, 3, 4], [2, 3, 4], [5, 0, 0], 4, 2), "apart"),
                               ((90, [2, 1, 4], [2, 3, 4], [0, 1, 0], 4, 2), "another way"), ((90, [2, 1], [2, 3, 4], [5, 0, 0], 4, 2), "center"),
                               ((90, [2, 1, 4], [2, 3, 4], [5, 0, 0], 0, 2), "width"), ((0 * lens, place, 4, 2), "focal length"),
                               ((lens, turn, 4, 2), "matrix")):
        with pytest.raises(ValueError, match=message):
            RaycastingScene.create_rays_pinhole(*arguments)
