"""trimesh's ray queries by glint: only the import changes. Corners and edges count once.

    from glint.trimesh import RayMeshIntersector
    RayMeshIntersector(mesh).contains_points(points)
"""
from __future__ import annotations

from typing import Any

import numpy
from numpy.typing import ArrayLike, NDArray

from . import Scene, Selector, _native

Indices = NDArray[numpy.int64]


def _hashes_its_content(mesh: Any) -> bool:
    return any(kind.__module__.startswith("trimesh.") for kind in type(mesh).__mro__)


class RayMeshIntersector:
    """Method names, parameters and shapes of trimesh.ray.ray_triangle.RayMeshIntersector, for anything with `vertices` and `faces`.

    Queries use the mesh as it is at the call. A change is detected by the hash of a trimesh mesh, of other meshes by comparison with
    copies. Parameters of trimesh's class for embreex are accepted by name: `max_hits`, the number of hits of each ray, nearest first,
    and `scale_to_box`, which has no effect.
    """

    def __init__(self, mesh: Any, device: Selector = None, *, scale_to_box: bool = True) -> None:  # pylint: disable=unused-argument
        self.mesh = mesh
        self._selector = device
        self._made: tuple[Scene, Any] | None = None
        self.scene  # pylint: disable=pointless-statement  # raises errors of the mesh now

    def __getstate__(self) -> dict[str, Any]:
        """Another process builds its own scene."""
        return {**self.__dict__, "_made": None}

    @property
    def scene(self) -> Scene:
        """The committed scene of the mesh as it is now."""
        made = self._made
        if made is not None and self._is_still(made[1]):
            return made[0]
        known = hash(self.mesh) if _hashes_its_content(self.mesh) else (numpy.array(self.mesh.vertices), numpy.array(self.mesh.faces))
        scene = Scene(self.mesh.vertices, self.mesh.faces, self._selector if made is None else made[0].device)
        self._made = scene, known
        return scene

    def _is_still(self, known: Any) -> bool:
        if _hashes_its_content(self.mesh):
            return bool(hash(self.mesh) == known)
        return all(numpy.array_equal(array, given) for array, given in zip(known, (self.mesh.vertices, self.mesh.faces)))

    def intersects_location(self, ray_origins: ArrayLike, ray_directions: ArrayLike, multiple_hits: bool = True, *,
                            max_hits: int | None = None) -> tuple[NDArray[numpy.float64], Indices, Indices]:
        """(locations (m, 3), index_ray (m,), index_tri (m,)): every crossing, or the closest hit of each ray."""
        if not multiple_hits:
            hits = self.scene.cast(ray_origins, ray_directions, want=("hit", "primitive", "point"))
            index_ray = numpy.flatnonzero(hits.hit)
            return hits.point[index_ray], index_ray, hits.primitive[index_ray].astype(numpy.int64)
        offsets, hits = self.scene.all_hits(ray_origins, ray_directions, want=("primitive", "point"))
        firsts = offsets[:-1].astype(numpy.int64)
        index_ray = numpy.repeat(numpy.arange(len(firsts)), numpy.diff(offsets).astype(numpy.int64))
        if max_hits is None:
            return hits.point, index_ray, hits.primitive.astype(numpy.int64)
        kept = numpy.arange(len(index_ray)) - firsts[index_ray] < max_hits
        return hits.point[kept], index_ray[kept], hits.primitive[kept].astype(numpy.int64)

    def intersects_id(self, ray_origins: ArrayLike, ray_directions: ArrayLike, return_locations: bool = False, multiple_hits: bool = True,
                      *, max_hits: int | None = None) -> tuple[Any, ...]:
        """(index_tri (m,), index_ray (m,)) of every crossing; with locations (m, 3) if return_locations."""
        locations, index_ray, index_tri = self.intersects_location(ray_origins, ray_directions, multiple_hits, max_hits=max_hits)
        return (index_tri, index_ray, locations) if return_locations else (index_tri, index_ray)

    def intersects_first(self, ray_origins: ArrayLike, ray_directions: ArrayLike) -> Indices:
        """Index of the first triangle on each ray (n,), -1 without a hit."""
        first = self.scene.cast(ray_origins, ray_directions, want=("primitive",)).primitive
        return numpy.where(first == _native.NONE, -1, first.astype(numpy.int64))

    def intersects_any(self, ray_origins: ArrayLike, ray_directions: ArrayLike) -> NDArray[numpy.bool_]:
        """True for each ray (n,) that hits the mesh."""
        return self.scene.occluded(ray_origins, ray_directions)

    def contains_points(self, points: ArrayLike) -> NDArray[numpy.bool_]:
        """True for each point (n, 3) inside the mesh, which must be closed."""
        return self.scene.contains(points)
