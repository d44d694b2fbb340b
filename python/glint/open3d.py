"""Open3D's ray queries by glint: only the import changes. Corners and edges count once.

    from glint.open3d import RaycastingScene

Queries return tensors for tensors, and arrays for arrays; these arrays have a method `numpy()`, as tensors have. This module does not
import Open3D.
"""
from __future__ import annotations

from typing import Any

import numpy
from numpy.typing import NDArray

from . import Device, Error, Scene, Selector, _native, pinhole_rays

_BY_MATRICES = ("intrinsic_matrix", "extrinsic_matrix", "width_px", "height_px")
_BY_PLACES = ("fov_deg", "center", "eye", "up", "width_px", "height_px")


class Array(numpy.ndarray):  # type: ignore[type-arg]
    """An array for code that was written for tensors."""

    def numpy(self) -> NDArray[Any]:
        """The same numbers, as a plain array."""
        return self.view(numpy.ndarray)


def _plain(given: Any) -> Any:
    """The numbers of a tensor, without a copy if they are in the processor's memory; anything else unchanged."""
    if not hasattr(given, "numpy"):
        return given
    return (given.cpu() if hasattr(given, "cpu") else given).numpy()


def _like(given: Any, array: NDArray[Any]) -> Any:
    """The array as a tensor of the kind of `given`, without a copy, or as an Array."""
    make = getattr(type(given), "from_numpy", None)
    return array.view(Array) if make is None else make(array)


def _camera_of_places(fov_deg: float, center: Any, eye: Any, up: Any, width: int, height: int) -> tuple[Any, Any]:
    """Intrinsic and extrinsic matrix."""
    middle, place, above = (numpy.asarray(_plain(given), dtype=numpy.float64) for given in (center, eye, up))
    for name, given in (("center", middle), ("eye", place), ("up", above)):
        if given.shape != (3,):
            raise ValueError(f"{name} has the shape {given.shape}; it must be (3,)")
    if not 0 < fov_deg < 180:
        raise ValueError("fov_deg must be above 0 and below 180")
    rows = numpy.empty((3, 3))
    rows[2] = middle - place
    rows[0] = numpy.cross(above, rows[2])
    rows[1] = numpy.cross(rows[2], rows[0])
    sizes = numpy.linalg.norm(rows, axis=1)
    if not (numpy.isfinite(sizes).all() and (sizes > 0).all()):
        raise ValueError("center and eye must be apart, and up must be another way than from one to the other")
    rows /= sizes[:, None]
    extrinsic = numpy.eye(4)
    extrinsic[:3, :3] = rows
    extrinsic[:3, 3] = -rows @ place
    focal = 0.5 * width / numpy.tan(0.5 * numpy.radians(fov_deg))
    return numpy.array([[focal, 0, 0.5 * width], [0, focal, 0.5 * height], [0, 0, 1]]), extrinsic


class RaycastingScene:
    """Method names, parameters and keys of open3d.t.geometry.RaycastingScene. Rays are (..., 6): origin, direction.

    The parameter `nthreads` of the scene limits the threads of each call; that of a query has no effect.
    """

    INVALID_ID = _native.NONE

    def __init__(self, device: Selector = None, nthreads: int = 0) -> None:
        self._scene = Scene(device=Device(device, threads=nthreads) if nthreads and not isinstance(device, Device) else device)
        self._changed = True

    def add_triangles(self, vertex_positions: Any = None, triangle_indices: Any = None, *, mesh: Any = None) -> int:
        """Adds a mesh, or vertices (n, 3) and vertex indices (m, 3). Returns the number of the geometry."""
        if mesh is None and triangle_indices is None and hasattr(vertex_positions, "vertex"):
            mesh = vertex_positions
        if mesh is not None:
            vertex_positions, triangle_indices = mesh.vertex["positions"], mesh.triangle["indices"]
        if vertex_positions is None or triangle_indices is None:
            raise TypeError("add_triangles takes a mesh of open3d.t.geometry, or vertex_positions and triangle_indices")
        self._changed = True
        return self._scene.add_triangles(_plain(vertex_positions), _plain(triangle_indices))

    def _ready(self) -> Scene:
        if self._changed:
            self._scene.commit()
            self._changed = False
        return self._scene

    def cast_rays(self, rays: Any, nthreads: int = 0) -> dict[str, Any]:  # pylint: disable=unused-argument
        """A dictionary of the closest hits: t_hit (inf without a hit), geometry_ids, primitive_ids, primitive_uvs, primitive_normals."""
        hits = self._ready().cast(_plain(rays), dtype=numpy.float32)
        return {name: _like(rays, array) for name, array in
                (("t_hit", hits.t), ("geometry_ids", hits.geometry), ("primitive_ids", hits.primitive), ("primitive_uvs", hits.uv),
                 ("primitive_normals", hits.normal))}

    def test_occlusions(self, rays: Any, tnear: float = 0.0, tfar: float = numpy.inf,
                        nthreads: int = 0) -> Any:  # pylint: disable=unused-argument
        """True for each ray with a hit between tnear and tfar, in units of the direction."""
        return _like(rays, self._ready().occluded(_plain(rays), t_min=tnear, t_max=tfar))

    def count_intersections(self, rays: Any, nthreads: int = 0) -> Any:  # pylint: disable=unused-argument
        """Number of surfaces that each ray crosses, int32; edges and corners count once."""
        return _like(rays, self._ready().count(_plain(rays)).astype(numpy.int32))

    def list_intersections(self, rays: Any, nthreads: int = 0) -> dict[str, Any]:  # pylint: disable=unused-argument
        """A dictionary of all crossings; those of ray i are at ray_splits[i]:ray_splits[i + 1]."""
        splits, hits = self._ready().all_hits(_plain(rays), dtype=numpy.float32)
        ids = numpy.repeat(numpy.arange(len(splits) - 1), numpy.diff(splits).astype(numpy.int64))
        return {name: _like(rays, array) for name, array in
                (("ray_splits", splits.astype(numpy.int64)), ("ray_ids", ids), ("t_hit", hits.t), ("geometry_ids", hits.geometry),
                 ("primitive_ids", hits.primitive), ("primitive_uvs", hits.uv))}

    def compute_occupancy(self, query_points: Any, nthreads: int = 0, nsamples: int = 1) -> Any:  # pylint: disable=unused-argument
        """1 for each point (..., 3) inside closed surfaces, otherwise 0. `nsamples` has no effect."""
        return _like(query_points, self._ready().contains(_plain(query_points)).astype(numpy.float32))

    def compute_closest_points(self, query_points: Any, nthreads: int = 0) -> dict[str, Any]:  # pylint: disable=unused-argument
        """A dictionary of the closest points of all surfaces: points, geometry_ids, primitive_ids, primitive_uvs, primitive_normals."""
        closest = self._ready().closest_point(_plain(query_points), want=("point", "geometry", "primitive", "uv", "normal"), dtype=numpy.float32)
        return {name: _like(query_points, array) for name, array in
                (("points", closest.point), ("geometry_ids", closest.geometry), ("primitive_ids", closest.primitive),
                 ("primitive_uvs", closest.uv), ("primitive_normals", closest.normal))}

    def compute_distance(self, query_points: Any, nthreads: int = 0) -> Any:  # pylint: disable=unused-argument
        """Distance of each point (..., 3) to the closest surface."""
        return _like(query_points, self._ready().distance(_plain(query_points)).astype(numpy.float32))

    def compute_signed_distance(self, query_points: Any, nthreads: int = 0, nsamples: int = 1) -> Any:  # pylint: disable=unused-argument
        """Distance to the closest surface, negative inside closed surfaces. `nsamples` has no effect."""
        return _like(query_points, self._ready().signed_distance(_plain(query_points)).astype(numpy.float32))

    @staticmethod
    def create_rays_pinhole(*arguments: Any, **named: Any) -> Any:
        """Rays through the centres of a camera's pixels, (height_px, width_px, 6) of float32.

        (intrinsic_matrix, extrinsic_matrix, width_px, height_px): the upper triangular matrix (3, 3) of the lens, in pixels, and the
        rotation and shift (4, 4) from the world to the camera, which looks along its z.
        (fov_deg, center, eye, up, width_px, height_px): a camera at `eye` that looks at `center`, with a horizontal field of view. As
        in Open3D, later rows go the way of `up`.
        """
        names = _BY_MATRICES if len(arguments) + len(named) == len(_BY_MATRICES) else _BY_PLACES
        given = dict(zip(names, arguments))
        if len(arguments) > len(names) or given.keys() & named.keys() or (given.keys() | named.keys()) != set(names):
            raise TypeError(f"create_rays_pinhole takes {', '.join(_BY_MATRICES)}, or {', '.join(_BY_PLACES)}")
        given.update(named)
        width, height = int(given["width_px"]), int(given["height_px"])
        if names is _BY_PLACES:
            lens, place = _camera_of_places(given["fov_deg"], given["center"], given["eye"], given["up"], width, height)
        else:
            lens, place = (numpy.asarray(_plain(given[name]), dtype=numpy.float64) for name in _BY_MATRICES[:2])
        try:
            rays = pinhole_rays(lens, place, width, height, numpy.float32)
        except Error as error:
            raise ValueError(f"intrinsic_matrix: {error}") from None
        return _like(next((one for one in given.values() if hasattr(type(one), "from_numpy")), None), rays)
