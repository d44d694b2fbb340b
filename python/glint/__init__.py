"""Casts rays against scenes and renders images, with numpy arrays in and out, on Vulkan 1.1 devices or the processor alone. ::

    import glint
    scene = glint.Scene(vertices, faces)
    hits = scene.cast(rays)                 # (n, 6), or origins and directions
    scene.contains(points)

Arrays of float32 and float64 are passed on without a copy. A device is chosen by its number or a part of its name; without one, the
best is used. "cpu" is the reference: double precision arithmetic on vertices that are rounded to fp32 about the scene's origin.
"""
from __future__ import annotations

import ctypes
import errno
import math
import os
import traceback
import warnings
from collections.abc import Callable, Iterable, Sequence
from typing import Any, Literal, Optional, Protocol, Union

import numpy
from numpy.typing import ArrayLike, DTypeLike, NDArray

from . import _native
from ._native import NONE, Error

__all__ = ["Device", "Error", "Hits", "NONE", "Picture", "Scene", "INSIDE", "ON_SURFACE", "OUTSIDE", "devices", "pinhole_rays", "render", "version"]

OUTSIDE, INSIDE, ON_SURFACE = 0, 1, 2
Cancelled = Optional[Callable[[], bool]]
Progress = Optional[Callable[[float], object]]
Selector = Union["Device", str, int, None]
Path = Union[str, "os.PathLike[str]"]
HitField = Literal["hit", "t", "geometry", "primitive", "material", "uv", "point", "normal", "sure", "t_lower", "t_upper", "origin"]
LayerName = Literal["color", "depth", "position", "normal", "geometry", "primitive", "material"]


def __dir__() -> list[str]:
    return sorted(__all__)


class Hits(Protocol):
    """Result of Scene.cast, Scene.all_hits and Scene.closest_point: a named tuple of the wanted arrays."""
    hit: NDArray[numpy.bool_]
    t: NDArray[Any]
    geometry: NDArray[numpy.uint32]
    primitive: NDArray[numpy.uint32]
    material: NDArray[numpy.uint32]
    uv: NDArray[Any]
    point: NDArray[Any]
    normal: NDArray[Any]
    sure: NDArray[numpy.bool_]
    t_lower: NDArray[Any]
    t_upper: NDArray[Any]
    origin: NDArray[Any]


class Picture(Protocol):
    """Result of Scene.render for other layers than color alone: a named tuple of the wanted arrays."""
    color: NDArray[Any]
    depth: NDArray[Any]
    position: NDArray[Any]
    normal: NDArray[Any]
    geometry: NDArray[numpy.uint32]
    primitive: NDArray[numpy.uint32]
    material: NDArray[numpy.uint32]


_WIDTHS = {"uv": 2, "point": 3, "normal": 3, "origin": 3, "position": 3, "color": 4}
_FLAGS = ("hit", "sure")
_INDICES = ("geometry", "primitive", "material")


def version() -> tuple[int, int, int]:
    """Version of the library, (major, minor, patch)."""
    number = _native.loaded.glint_version()
    return number // 1000000, number // 1000 % 1000, number % 1000


_LARGEST = 65536  # width and height of an image, in pixels; as in libglint


def _described(info: Any) -> dict[str, Any]:
    return {"index": info.index, "name": info.name.decode(), "usable": bool(info.usable), "software": bool(info.software),
            "reference": bool(info.reference), "reason": info.reason.decode()}


def devices() -> list[dict[str, Any]]:
    """All devices, a dictionary each; "cpu" is the last."""
    count = ctypes.c_uint32()
    _native.call("glint_device_count", ctypes.byref(count))
    found = []
    for index in range(count.value):
        info = _native.make(_native.DeviceInfo)
        _native.call("glint_device_describe", index, ctypes.byref(info))
        found.append(_described(info))
    return found


class Device(_native.Owner):
    """An open device; scenes keep theirs alive.

    - selector: number or part of the name; "cpu" for the reference; by default the best device.
    - threads: most threads of one call; 0: one for each processor.
    - max_bytes: most bytes that the device and its scenes may hold; 0: no limit. A call that needs more raises Error.
    - memory: called from any thread before an allocation with its bytes, and after memory was freed with a negative number. It
      refuses the allocation by returning false or raising (the exception is printed); the call then raises Error.
    - log: called with lines on what was opened, committed, ignored and fixed.
    """

    _release = "glint_device_release"

    def __init__(self, selector: str | int | None = None, threads: int = 0, max_bytes: int = 0, log: Callable[[str], None] | None = None,
                 memory: Callable[[int], object] | None = None) -> None:
        super().__init__()
        settings = _native.make(_native.Settings)

        def asked(_: int | None, count: int) -> int:
            try:
                return int(bool(memory and memory(count)))
            except BaseException:  # pylint: disable=broad-except
                traceback.print_exc()
                return 0
        self._memory = _native.MEMORY_CALLBACK(asked)
        if memory:
            settings.memory = self._memory
        settings.threads, settings.max_bytes = _native.whole(threads, "threads"), _native.whole(max_bytes, "max_bytes", 64)
        self._log = _native.LOG_CALLBACK(lambda user, level, text: log(text.decode()) if log else None)
        if log:
            settings.log = self._log
        _native.call("glint_device_open_with", _native.text("" if selector is None else str(selector)), ctypes.byref(settings), ctypes.byref(self._handle))

    @property
    def info(self) -> dict[str, Any]:
        """Index and name, whether it is software or the reference, whether it is usable, and the reason if not."""
        info = _native.make(_native.DeviceInfo)
        _native.call("glint_device_info_of", self._handle, ctypes.byref(info))
        return _described(info)

    def __repr__(self) -> str:
        return f"<glint.Device {self.info['name']}>"


def _device(device: Selector) -> Device:
    return device if isinstance(device, Device) else Device(device)


def _transform(matrix: ArrayLike) -> tuple[NDArray[numpy.float64], Any]:
    """Twelve doubles from a (3, 4) or (4, 4) matrix, and a pointer to them."""
    given = numpy.asarray(matrix, dtype=numpy.float64)
    if given.shape not in ((3, 4), (4, 4)):
        raise ValueError(f"a transform is a (3, 4) or (4, 4) matrix, not one of the shape {given.shape}")
    rows = numpy.ascontiguousarray(given[:3])
    return rows, rows.ctypes.data_as(ctypes.POINTER(ctypes.c_double))


class _Options:
    """Callbacks of a long call. An exception in a callback ends the call, which raises it again. `interruptible`: Ctrl-C ends the call
    too; each call of `cancelled` then takes the interpreter's lock."""

    def __init__(self, cancelled: Cancelled, progress: Progress, interruptible: bool = False) -> None:
        self.raised: BaseException | None = None
        self.interrupts = _native.Interrupts()
        self.struct = _native.make(_native.Options)

        def guarded(body: Callable[[], Any], fallback: Any) -> Any:
            try:
                return body()
            except BaseException as error:  # pylint: disable=broad-except
                self.raised = error
                return fallback
        if cancelled or progress or (interruptible and self.interrupts.possible()):
            self.struct.cancelled = _native.CANCELLED_CALLBACK(
                lambda _: 1 if self.raised or self.interrupts.noted else guarded(lambda: int(bool(cancelled and cancelled())), 1))
        if progress is not None:
            told = progress
            self.struct.progress = _native.PROGRESS_CALLBACK(lambda _, part: guarded(lambda: told(part), None))

    def call(self, name: str, *arguments: Any, result: tuple[Any, ...] = ()) -> None:
        try:
            with self.interrupts:
                _native.call(name, *arguments, ctypes.byref(self.struct), *result)
        finally:
            if self.raised is not None:
                raise self.raised


class _RayArrays:
    """Keeps the arrays of a batch alive during a call."""

    def __init__(self, rays: ArrayLike, directions: ArrayLike | None, t_min: ArrayLike | None, t_max: ArrayLike | None,
                 coherent: bool = False, leave: bool = False) -> None:
        if directions is None:
            both = _native.numbers(rays, 6, "rays")
            self.shape = _native.shape_before(rays)
            origins, directions = both[:, :3], both[:, 3:]
        else:
            shapes = [_native.shape_before(given) for given in (rays, directions)]
            try:
                self.shape = numpy.broadcast_shapes(*shapes)
            except ValueError:
                raise ValueError(f"origins of the shape {shapes[0]} and directions of the shape {shapes[1]} cannot be broadcast: "
                                 "give equally many of both, or one of either") from None
            origins, directions = (self._spread(_native.numbers(given, 3, what), shape)
                                   for given, what, shape in zip((rays, directions), ("origins", "directions"), shapes))
        self.count = math.prod(self.shape)
        self.kept = [origins, directions]
        self.struct = _native.make(_native.Rays)
        self.struct.origins = _native.view(origins)
        self.struct.directions = _native.view(directions)
        for name, bound in (("t_min", t_min), ("t_max", t_max)):
            if bound is not None:
                if numpy.size(bound) != 1 and numpy.shape(bound) not in (self.shape, (self.count,)):
                    raise ValueError(f"{name} has the shape {numpy.shape(bound)}; it must be one number, or {self.shape} as the rays")
                array = _native.numbers(bound, None, name)
                self.kept.append(array)
                setattr(self.struct, name, _native.view(array))
        self.struct.flags = (_native.COHERENT if coherent else 0) | (_native.LEAVE if leave else 0)

    def _spread(self, array: NDArray[Any], shape: tuple[int, ...]) -> NDArray[Any]:
        """One element for each ray, by numpy's rules; or one for all, which the library broadcasts."""
        if array.shape[0] in (1, math.prod(self.shape)):
            return array
        return numpy.broadcast_to(array.reshape(shape + (3,)), self.shape + (3,)).reshape(-1, 3)


def _names(wanted: Iterable[str]) -> tuple[str, ...]:
    return (wanted,) if isinstance(wanted, str) else tuple(wanted)


def _real(dtype: DTypeLike) -> Any:
    kind = numpy.dtype(dtype)
    if kind not in (numpy.float32, numpy.float64):
        raise ValueError(f"dtype is {kind}; it must be float32 or float64")
    return kind


def _hit_arrays(want: Iterable[HitField], count: int, dtype: DTypeLike) -> dict[str, NDArray[Any]]:
    arrays: dict[str, NDArray[Any]] = {}
    dtype = _real(dtype)
    for name in _names(want):
        if name in _FLAGS:
            arrays[name] = numpy.empty(count, numpy.uint8)
        elif name in _INDICES:
            arrays[name] = numpy.empty(count, numpy.uint32)
        elif name in _native.HIT_FIELDS:
            width = _WIDTHS.get(name)
            arrays[name] = numpy.empty(count if width is None else (count, width), dtype)
        else:
            raise ValueError(f"{name!r} is not one of {', '.join(_native.HIT_FIELDS)}")
    return arrays


def _hits_struct(arrays: dict[str, NDArray[Any]]) -> Any:
    struct = _native.make(_native.Hits)
    for name, array in arrays.items():
        setattr(struct, name, _native.view(array))
    return struct


def _record(name: str, arrays: dict[str, NDArray[Any]], shape: tuple[int, ...] | None = None) -> Any:
    if shape is not None:
        arrays = {key: array.reshape(shape + array.shape[1:]) for key, array in arrays.items()}
    for flag in arrays.keys() & set(_FLAGS):
        arrays[flag] = arrays[flag].view(numpy.bool_)
    return _native.record(name, tuple(arrays))(**arrays)


def _mesh_arrays(vertices: Any, faces: Any) -> tuple[Any, Any]:
    """Vertices and faces, from arrays or from a mesh of trimesh (vertices, faces) or Open3D (vertices, triangles; vertex, triangle)."""
    if faces is not None:
        return vertices, faces
    if hasattr(vertices, "vertices"):
        for name in ("faces", "triangles"):
            if hasattr(vertices, name):
                return numpy.asarray(vertices.vertices), numpy.asarray(getattr(vertices, name))
    if hasattr(vertices, "vertex") and hasattr(vertices, "triangle"):
        return vertices.vertex["positions"].cpu().numpy(), vertices.triangle["indices"].cpu().numpy()
    return vertices, None


class Scene(_native.Owner):
    """Geometry that rays are cast at. Geometries are numbered from 0 in the order of the calls that add them.

    - vertices: (n, 3), any unit, or a mesh of trimesh or Open3D. With vertices the scene is one mesh, committed.
    - faces: (m, 3) vertex indices; without them every three vertices are a triangle.
    - device: a Device, its number, a part of its name, or "cpu".
    """

    _release = "glint_scene_release"

    def __init__(self, vertices: Any = None, faces: ArrayLike | None = None, device: Selector = None) -> None:
        super().__init__()
        if isinstance(vertices, (str, bytes, os.PathLike)):
            raise TypeError("vertices is a name; glint.Scene.load reads files")
        self._device = _device(device)
        _native.call("glint_scene_create", self._device._handle, ctypes.byref(self._handle))
        if vertices is not None:
            self.add_triangles(vertices, faces)
            self.commit()

    @classmethod
    def load(cls, path: Path, device: Selector = None, *, cancelled: Cancelled = None, progress: Progress = None) -> Scene:
        """Loads and commits a scene (.json, .gltf, .glb, .nff) or model (.obj, .ply, .stl).

        - cancelled: called repeatedly, ends the call if it returns true.
        - progress: called with the finished part, 0 to 1.

        Raises FileNotFoundError if there is no such file, and Error if it cannot be read.
        """
        name = _native.text(os.fsencode(path))
        if name and not os.path.exists(name):
            raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), os.fspath(path))
        scene = cls.__new__(cls)
        _native.Owner.__init__(scene)
        scene._device = _device(device)
        options = _Options(cancelled, progress, True)
        options.call("glint_scene_load_with", scene._device._handle, name, result=(ctypes.byref(scene._handle),))
        return scene

    # ---- contents ----

    def add_triangles(self, vertices: Any, faces: ArrayLike | None = None, material: int = 0) -> int:
        """Adds a mesh: vertices (n, 3) and faces (m, 3), or a mesh of trimesh or Open3D. Returns the geometry's number."""
        vertices, faces = _mesh_arrays(vertices, faces)
        points = _native.numbers(vertices, 3, "vertices")
        given = _native.make(_native.Triangles)
        given.vertices = _native.view(points)
        given.material = _native.whole(material, "material")
        if faces is not None:
            corners = _native.indices(faces, "faces")
            given.indices = _native.view(corners)
        return self._added("glint_scene_add_triangles", ctypes.byref(given))

    def add_spheres(self, centers: ArrayLike, radii: ArrayLike, material: int = 0) -> int:
        """Adds spheres, one geometry each: centers (n, 3), radii (n,) or one for all. Returns the number of the first."""
        places = _native.numbers(centers, 3, "centers")
        sizes = _native.numbers(radii, None, "radii")
        given = _native.make(_native.Spheres)
        given.centers = _native.view(places)
        given.radii = _native.view(sizes)
        given.material = _native.whole(material, "material")
        return self._added("glint_scene_add_spheres", ctypes.byref(given))

    def add_json(self, text: str, folder: Path | None = None) -> range:
        """Adds the objects, materials and lights of a scene file's text. Returns the numbers of its geometries, as a range."""
        first, count = ctypes.c_uint32(), ctypes.c_uint32()
        _native.call("glint_scene_add_json", self._handle, _native.text(text), None if folder is None else _native.text(os.fsencode(folder)),
                     ctypes.byref(first), ctypes.byref(count))
        return range(first.value, first.value + count.value)

    def add_instance(self, geometry: int, transform: ArrayLike) -> int:
        """Adds an instance of a geometry, by a (3, 4) or (4, 4) matrix applied to it as it was added. Returns the instance's number."""
        rows, pointer = _transform(transform)
        number = self._added("glint_scene_add_instance", _native.whole(geometry, "geometry"), pointer)
        del rows
        return number

    def set_transform(self, geometry: int, transform: ArrayLike) -> None:
        """Replaces the transform of a geometry or an instance: a (3, 4) or (4, 4) matrix applied to it as it was added."""
        rows, pointer = _transform(transform)
        _native.call("glint_scene_set_transform", self._handle, _native.whole(geometry, "geometry"), pointer)
        del rows

    def set_vertices(self, geometry: int, vertices: ArrayLike) -> None:
        """Replaces the vertices of a mesh and its instances; as many as before, all finite."""
        points = _native.numbers(vertices, 3, "vertices")
        _native.call("glint_scene_set_vertices", self._handle, _native.whole(geometry, "geometry"), ctypes.byref(_native.view(points)))

    def material(self, name: str) -> int:
        """Number of the material with this name."""
        found = ctypes.c_uint32()
        _native.call("glint_scene_find_material", self._handle, _native.text(name), ctypes.byref(found))
        return found.value

    def commit(self, *, cancelled: Cancelled = None, progress: Progress = None) -> Scene:
        """Makes all additions and changes visible to queries. If only vertices and transforms changed, the BVH is refitted (see
        `refits`); answers about rays are those of a new scene. If cancelled, queries see the state as before."""
        _Options(cancelled, progress, True).call("glint_scene_commit_with", self._handle)
        return self

    def prepare(self) -> Scene:
        """Compiles the kernels of `cast` and `occluded` for the committed scene; otherwise their first call does. Returns the scene."""
        _native.call("glint_scene_prepare", self._handle)
        return self

    def _added(self, name: str, *arguments: Any) -> int:
        number = ctypes.c_uint32()
        _native.call(name, self._handle, *arguments, ctypes.byref(number))
        return number.value

    def __repr__(self) -> str:
        try:
            info = self._info()
        except Error:  # not committed, or made in another process
            return "<glint.Scene, not committed>"
        return f"<glint.Scene of {info.geometries} geometries, {info.triangles} triangles, on {self._device.info['name']}>"

    def _info(self) -> Any:
        info = _native.make(_native.SceneInfo)
        _native.call("glint_scene_info_of", self._handle, ctypes.byref(info))
        return info

    @property
    def device(self) -> Device:
        """The device of the scene."""
        return self._device

    @property
    def bounds(self) -> NDArray[numpy.float64]:
        """Bounds of everything committed except planes, (2, 3): lower and upper corner."""
        info = self._info()
        return numpy.array([info.lower, info.upper])

    @property
    def triangles(self) -> int:
        """Number of triangles; those of instances count for each instance."""
        return int(self._info().triangles)

    @property
    def refits(self) -> int:
        """Commits since the BVH was last built, each of which refitted it."""
        return int(self._info().refits)

    @property
    def warnings(self) -> list[str]:
        """One line for each thing that was ignored or fixed."""
        texts = []
        for index in range(self._info().warnings):
            text = ctypes.c_char_p()
            _native.call("glint_scene_warning", self._handle, index, ctypes.byref(text))
            texts.append((text.value or b"").decode())
        return texts

    # ---- rays ----

    def cast(self, rays: ArrayLike, directions: ArrayLike | None = None, *, t_min: ArrayLike | None = None,
             t_max: ArrayLike | None = None, want: Iterable[HitField] = ("t", "geometry", "primitive", "uv", "normal"),
             dtype: DTypeLike = numpy.float64, coherent: bool = False, leave: bool = False, cancelled: Cancelled = None,
             progress: Progress = None) -> Hits:
        """The closest hit of each ray, as a named tuple of the arrays in `want`; nothing else is computed.

        - rays: (..., 6), or origins (..., 3) with directions (..., 3) of any length; t is in units of the direction.
        - t_min, t_max: only hits with t_min < t <= t_max count.
        - want: names of results, below.
        - leave: the rays start at the `origin` of hits, and do not hit the surface that they start on or another one in its place;
          not with sure, t_lower and t_upper.
        - coherent: neighbours in the array have similar directions; may be faster.
        - cancelled: called repeatedly, ends the call if it returns true.
        - progress: called with the finished part, 0 to 1.

        Results; on a miss, t is inf, indices are NONE, all others are 0:

        - hit, t, geometry, primitive, material, point.
        - uv: the point of a triangle a, b, c is (1 - u - v) a + u b + v c, with b and c exchanged if a transform mirrors it.
        - normal: geometric, outward, unit.
        - origin: start of rays that leave the hit on the side that the ray came from; 2 * point - origin is on the other side.
        - sure, t_lower, t_upper: with one of these, hits are certified: those of exact arithmetic on the given numbers. sure: the
          hit is proven; the exact t is between t_lower and t_upper. All rays are sure in scenes of triangles and planes.

        Raises ValueError for arrays of another shape, Error if the scene is not committed.
        """
        batch = _RayArrays(rays, directions, t_min, t_max, coherent, leave)
        arrays = _hit_arrays(want, batch.count, dtype)
        hits = _hits_struct(arrays)
        _Options(cancelled, progress, True).call("glint_query_closest", self._handle, ctypes.byref(batch.struct), ctypes.byref(hits))
        made: Hits = _record("Hits", arrays, batch.shape)
        return made

    def _flags(self, name: str, batch: _RayArrays, dtype: DTypeLike, cancelled: Cancelled, progress: Progress) -> NDArray[Any]:
        answers = numpy.empty(batch.count, dtype)
        if batch.count:
            out = _native.view(answers)
            _Options(cancelled, progress, True).call(name, self._handle, ctypes.byref(batch.struct), ctypes.byref(out))
        return answers.reshape(batch.shape)

    def occluded(self, rays: ArrayLike, directions: ArrayLike | None = None, *, t_min: ArrayLike | None = None,
                 t_max: ArrayLike | None = None, coherent: bool = False, leave: bool = False, cancelled: Cancelled = None,
                 progress: Progress = None) -> NDArray[numpy.bool_]:
        """True for each ray that hits anything. leave: the rays start at the `origin` of hits, as in `cast`."""
        batch = _RayArrays(rays, directions, t_min, t_max, coherent, leave)
        return self._flags("glint_query_any", batch, numpy.uint8, cancelled, progress).view(numpy.bool_)

    def count(self, rays: ArrayLike, directions: ArrayLike | None = None, *, t_min: ArrayLike | None = None,
              t_max: ArrayLike | None = None, cancelled: Cancelled = None, progress: Progress = None) -> NDArray[numpy.uint32]:
        """Number of surfaces that each ray crosses, uint32: even for rays that start outside a closed surface, odd inside."""
        batch = _RayArrays(rays, directions, t_min, t_max)
        return self._flags("glint_query_count", batch, numpy.uint32, cancelled, progress)

    def all_hits(self, rays: ArrayLike, directions: ArrayLike | None = None, *, t_min: ArrayLike | None = None,
                 t_max: ArrayLike | None = None, want: Iterable[HitField] = ("t", "geometry", "primitive", "uv"),
                 dtype: DTypeLike = numpy.float64, cancelled: Cancelled = None,
                 progress: Progress = None) -> tuple[NDArray[numpy.uint64], Hits]:
        """All crossings of each ray by t: (offsets (n + 1,), hits); those of ray i are elements offsets[i]:offsets[i + 1] of each array.
        want: as in `cast`, except sure, t_lower and t_upper."""
        batch = _RayArrays(rays, directions, t_min, t_max)
        offsets = numpy.zeros(batch.count + 1, numpy.uint64)
        out, total = _native.view(offsets), ctypes.c_uint64()
        done, most = 0.0, -1.0  # of both calls together

        def halved(part: float) -> None:
            nonlocal most
            if progress and done + part / 2 > most:
                most = done + part / 2
                progress(most)
        options = _Options(cancelled, halved if progress else None, True)

        def query(hits: Any) -> None:
            options.call("glint_query_all", self._handle, ctypes.byref(batch.struct), ctypes.byref(out), hits, ctypes.byref(total))
        query(None)
        done = 0.5
        while True:
            arrays = _hit_arrays(want, total.value, dtype)
            try:
                query(ctypes.byref(_hits_struct(arrays)))
            except Error as error:
                if error.status != "capacity":
                    raise
                continue  # another thread has committed since: `total` is the new number
            arrays = {name: array[:total.value] for name, array in arrays.items()}
            return offsets, _record("Hits", arrays)

    def locate(self, points: ArrayLike, *, cancelled: Cancelled = None, progress: Progress = None) -> NDArray[numpy.uint8]:
        """OUTSIDE, INSIDE or ON_SURFACE for each point (..., 3)."""
        places = _native.numbers(points, 3, "points")
        where = numpy.empty(places.shape[0], numpy.uint8)
        if places.shape[0]:
            given, out = _native.view(places), _native.view(where)
            _Options(cancelled, progress, True).call("glint_query_inside", self._handle, ctypes.byref(given), ctypes.byref(out))
        return where.reshape(_native.shape_before(points))

    def contains(self, points: ArrayLike) -> NDArray[numpy.bool_]:
        """True for each point (..., 3) inside closed surfaces; points on a surface are not inside."""
        return numpy.equal(self.locate(points), INSIDE)

    # ---- distances ----

    def closest_point(self, points: ArrayLike, *, want: Iterable[HitField] = ("point", "t", "geometry", "primitive"),
                      dtype: DTypeLike = numpy.float64, cancelled: Cancelled = None, progress: Progress = None) -> Hits:
        """The closest point of all surfaces to each of `points` (..., 3), as a hit: `t` is its distance, `point` the closest point.

        want: as in `cast`, except sure, t_lower and t_upper. Raises Error if the scene holds other shapes than meshes, spheres and
        their instances. On a device the distance may exceed the least by 2^-20 of the coordinates' size; device "cpu" computes in double.
        """
        places = _native.numbers(points, 3, "points")
        arrays = _hit_arrays(want, places.shape[0], dtype)
        given, hits = _native.view(places), _hits_struct(arrays)
        _Options(cancelled, progress, True).call("glint_query_closest_point", self._handle, ctypes.byref(given), ctypes.byref(hits))
        made: Hits = _record("Hits", arrays, _native.shape_before(points))
        return made

    def distance(self, points: ArrayLike) -> NDArray[numpy.float64]:
        """The distance of each point (..., 3) to the closest surface, inf in an empty scene. See `closest_point`."""
        return self.closest_point(points, want=("t",)).t

    def signed_distance(self, points: ArrayLike) -> NDArray[numpy.float64]:
        """The distance of each point (..., 3) to the closest surface, negative inside closed surfaces (`contains`)."""
        return numpy.where(self.contains(points), -1.0, 1.0) * self.distance(points)

    # ---- images ----

    def render(self, width: int = 0, height: int = 0, samples: int = 0, *, layers: Iterable[LayerName] = ("color",),
               camera: Sequence[Any] | str | None = None, max_depth: int | None = None, dtype: DTypeLike = numpy.float32,
               error: float | None = None, confidence: float = 0.95, max_samples: int = 65536, cancelled: Cancelled = None,
               progress: Progress = None) -> Any:
        """Renders an image: (height, width, 4) of linear RGB and alpha; a named tuple if other `layers` are wanted.

        - width, height in pixels, samples for each pixel; 0: those of the scene.
        - layers: names among color, depth (distance along the ray; for depth along the axis cast `pinhole_rays`), position, normal
          (shading normal, unit), geometry, primitive, material.
        - max_depth: greatest number of reflections and refractions in a row; default: that of the scene.
        - camera: (eye, target), (eye, target, up) or (eye, target, up, fov_y in degrees), or the name of one of the scene's `cameras`.
        - error: instead of `samples`, the target for the error of color: root mean square over all pixels and channels, full scale 1,
          with probability `confidence`. If `max_samples` do not reach it, a RuntimeWarning states the bound.
        """
        layers, dtype = _names(layers), _real(dtype)
        info = self._info()
        width, height = width or info.width, height or info.height
        if not (0 < width <= _LARGEST and 0 < height <= _LARGEST):
            raise ValueError(f"width and height must be 1 to {_LARGEST}, or 0")
        picture = _native.make(_native.Picture)
        picture.width, picture.height, picture.samples = width, height, _native.whole(samples, "samples")
        if max_depth is not None:
            picture.max_depth = max_depth or -1
        if isinstance(camera, str):
            picture.camera_name = _native.text(camera)
        elif camera is not None:
            if not 2 <= len(camera) <= 4:
                raise ValueError("camera is (eye, target), (eye, target, up), (eye, target, up, fov_y) or a name")
            eye, target, up, fov = tuple(camera) + ((0, 1, 0), 40)[len(camera) - 2:]
            view = _native.make(_native.Camera)
            view.eye[:], view.target[:], view.up[:], view.fov_y = eye, target, up, fov
            picture.camera = ctypes.pointer(view)
        bound = ctypes.c_double()
        if error is not None:
            if not error > 0:
                raise ValueError("error must be above 0")
            picture.error, picture.confidence = error, confidence
            picture.max_samples = _native.whole(max_samples, "max_samples")
            picture.bound = ctypes.pointer(bound)
        arrays: dict[str, NDArray[Any]] = {}
        for name in layers:
            if name not in _native.LAYERS:
                raise ValueError(f"{name!r} is not one of {', '.join(_native.LAYERS)}")
            wide = _WIDTHS.get(name)
            kind = numpy.uint32 if name in _INDICES else dtype
            arrays[name] = numpy.zeros((height * width, wide) if wide else height * width, kind)
            setattr(picture, name, _native.view(arrays[name]))
        _Options(cancelled, progress, True).call("glint_render", self._handle, ctypes.byref(picture))
        if error is not None and bound.value > error:
            warnings.warn(f"target {error:.3g} not reached: the error is at most {bound.value:.3g} after max_samples", RuntimeWarning, stacklevel=2)
        made = _record("Picture", arrays, (height, width))
        return made.color if layers == ("color",) else made


def pinhole_rays(intrinsics: ArrayLike, extrinsics: ArrayLike, width: int, height: int, dtype: DTypeLike = numpy.float64) -> NDArray[Any]:
    """Rays through the centres of a camera's pixels, (height, width, 6), for `cast`: the t of hits is depth along the camera's axis.

    - intrinsics: (3, 3), [[fx, skew, cx], [0, fy, cy], [0, 0, 1]] in pixels; (0, 0) is the upper left corner of the image,
      (0.5, 0.5) the centre of its first pixel.
    - extrinsics: (3, 4) or (4, 4), rotation and shift from the world to the camera, which looks along its z with y down.

    Raises ValueError for other shapes, and Error if a focal length is 0.
    """
    lens, place = numpy.ascontiguousarray(intrinsics, numpy.float64), _transform(extrinsics)
    if lens.shape != (3, 3):
        raise ValueError(f"intrinsics has the shape {lens.shape}; it must be (3, 3)")
    if not (0 < width <= _LARGEST and 0 < height <= _LARGEST):
        raise ValueError(f"width and height must be 1 to {_LARGEST}")
    rays, origin = numpy.empty((height, width, 6), _real(dtype)), numpy.empty(3)
    doubles = ctypes.POINTER(ctypes.c_double)
    out = _native.view(rays.reshape(-1, 6)[:, 3:])
    _native.call("glint_pinhole_rays", lens.ctypes.data_as(doubles), place[1], width, height, origin.ctypes.data_as(doubles),
                 ctypes.byref(out))
    rays[..., :3] = origin
    return rays


def render(scene: Scene | Path, *arguments: int, device: Selector = None, **options: Any) -> Any:
    """Scene.render for a Scene or for the name of a file: glint.render("scene.json", error=1e-3)."""
    if not isinstance(scene, Scene):
        scene = Scene.load(scene, device)
    return scene.render(*arguments, **options)
