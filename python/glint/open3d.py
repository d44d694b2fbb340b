"""Open3D's way of asking, answered by glint, with numpy arrays for tensors.

    from glint.open3d import RaycastingScene
"""
from __future__ import annotations

from typing import Any

import numpy
from numpy.typing import ArrayLike, NDArray

from . import Scene, Selector, _native


class RaycastingScene:
    """Method names and keys of open3d.t.geometry.RaycastingScene. Rays are (..., 6): origin, direction."""

    INVALID_ID = _native.NONE

    def __init__(self, device: Selector = None) -> None:
        self._scene = Scene(device=device)
        self._changed = True

    def add_triangles(self, vertex_positions: ArrayLike, triangle_indices: ArrayLike) -> int:
        """The number of the geometry."""
        self._changed = True
        return self._scene.add_triangles(vertex_positions, triangle_indices)

    def _ready(self) -> Scene:
        if self._changed:
            self._scene.commit()
            self._changed = False
        return self._scene

    def cast_rays(self, rays: ArrayLike) -> dict[str, NDArray[Any]]:
        """t_hit, geometry_ids, primitive_ids, primitive_uvs, primitive_normals of the nearest hits."""
        hits = self._ready().cast(rays, dtype=numpy.float32)
        return {"t_hit": hits.t, "geometry_ids": hits.geometry, "primitive_ids": hits.primitive, "primitive_uvs": hits.uv,
                "primitive_normals": hits.normal}

    def test_occlusions(self, rays: ArrayLike, tnear: float = 0.0, tfar: float = numpy.inf) -> NDArray[numpy.bool_]:
        """Whether there is a hit between tnear and tfar."""
        return self._ready().occluded(rays, t_min=tnear, t_max=tfar)

    def count_intersections(self, rays: ArrayLike) -> NDArray[numpy.int32]:
        """How many surfaces each ray crosses, edges and corners counted right."""
        return self._ready().count(rays).astype(numpy.int32)

    def list_intersections(self, rays: ArrayLike) -> dict[str, NDArray[Any]]:
        """All of them: those of ray i at ray_splits[i]:ray_splits[i + 1]."""
        splits, hits = self._ready().all_hits(rays, dtype=numpy.float32)
        ids = numpy.repeat(numpy.arange(len(splits) - 1), numpy.diff(splits).astype(numpy.int64))
        return {"ray_splits": splits.astype(numpy.int64), "ray_ids": ids, "t_hit": hits.t, "geometry_ids": hits.geometry,
                "primitive_ids": hits.primitive, "primitive_uvs": hits.uv}

    def compute_occupancy(self, query_points: ArrayLike) -> NDArray[numpy.float32]:
        """1 inside, 0 elsewhere."""
        return self._ready().contains(query_points).astype(numpy.float32)
