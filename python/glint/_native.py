"""libglint's C API (include/glint/glint.h) by ctypes. Calls release the interpreter's lock."""
from __future__ import annotations

import collections
import ctypes
import ctypes.util
import functools
import operator
import os
import re
import signal
import threading
from typing import Any

import numpy
from numpy.typing import ArrayLike, NDArray

OK, CANCELLED = 0, 5
NONE = 0xFFFFFFFF
COHERENT, LEAVE = 1, 2
_TYPES = {"float32": 0, "float64": 1, "uint32": 2, "uint8": 3, "uint64": 4}


class Error(RuntimeError):
    """Raised if a call fails; `status` is the name of the C API's status."""

    def __init__(self, status: str, message: str) -> None:
        super().__init__(message)
        self.status = status

    def __reduce__(self) -> tuple[Any, ...]:
        return Error, (self.status, str(self))


class View(ctypes.Structure):
    """Both glint_view and glint_out."""
    _fields_ = [("data", ctypes.c_void_p), ("count", ctypes.c_uint64), ("stride", ctypes.c_int64), ("type", ctypes.c_int32),
                ("reserved", ctypes.c_int32)]


def _struct(name: str, fields: list[tuple[str, Any]]) -> Any:
    made = type(name, (ctypes.Structure,), {"_fields_": [("size", ctypes.c_uint64)] + fields})
    return made


Rays = _struct("Rays", [("origins", View), ("directions", View), ("t_min", View), ("t_max", View), ("flags", ctypes.c_uint32),
                        ("reserved", ctypes.c_uint32)])
HIT_FIELDS = ("hit", "t", "geometry", "primitive", "material", "uv", "point", "normal", "sure", "t_lower", "t_upper", "origin")
Hits = _struct("Hits", [(name, View) for name in HIT_FIELDS])
Triangles = _struct("Triangles", [("vertices", View), ("indices", View), ("material", ctypes.c_uint32), ("reserved", ctypes.c_uint32)])
Spheres = _struct("Spheres", [("centers", View), ("radii", View), ("material", ctypes.c_uint32), ("reserved", ctypes.c_uint32)])
DeviceInfo = _struct("DeviceInfo", [("index", ctypes.c_uint32), ("usable", ctypes.c_int32), ("software", ctypes.c_int32),
                                    ("reference", ctypes.c_int32), ("name", ctypes.c_char * 256), ("reason", ctypes.c_char * 256)])
SceneInfo = _struct("SceneInfo", [("geometries", ctypes.c_uint32), ("warnings", ctypes.c_uint32), ("triangles", ctypes.c_uint64),
                                  ("lower", ctypes.c_double * 3), ("upper", ctypes.c_double * 3), ("width", ctypes.c_uint32),
                                  ("height", ctypes.c_uint32), ("refits", ctypes.c_uint32), ("reserved", ctypes.c_uint32)])
Camera = _struct("Camera", [("eye", ctypes.c_double * 3), ("target", ctypes.c_double * 3), ("up", ctypes.c_double * 3),
                            ("fov_y", ctypes.c_double)])
LAYERS = ("color", "depth", "position", "normal", "geometry", "primitive", "material")
Picture = _struct("Picture", [("width", ctypes.c_uint32), ("height", ctypes.c_uint32), ("samples", ctypes.c_uint32),
                              ("max_depth", ctypes.c_int32), ("camera", ctypes.POINTER(Camera))] + [(name, View) for name in LAYERS]
                  + [("camera_name", ctypes.c_char_p), ("error", ctypes.c_double), ("confidence", ctypes.c_double),
                     ("max_samples", ctypes.c_uint32), ("reserved", ctypes.c_uint32), ("bound", ctypes.POINTER(ctypes.c_double))])
MEMORY_CALLBACK = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_int64)
LOG_CALLBACK = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int32, ctypes.c_char_p)
Settings = _struct("Settings", [("threads", ctypes.c_uint32), ("reserved", ctypes.c_uint32), ("max_bytes", ctypes.c_uint64),
                                ("memory", MEMORY_CALLBACK), ("log", LOG_CALLBACK), ("user", ctypes.c_void_p)])
CANCELLED_CALLBACK = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p)
PROGRESS_CALLBACK = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_double)
Options = _struct("Options", [("cancelled", CANCELLED_CALLBACK), ("progress", PROGRESS_CALLBACK), ("user", ctypes.c_void_p)])


def make(kind: Any) -> Any:
    """A struct with its size set and all else zero."""
    made = kind()
    made.size = ctypes.sizeof(kind)
    return made


def _load() -> ctypes.CDLL:
    chosen = os.environ.get("GLINT_LIBRARY")
    problem: Exception | None = None
    bundled = os.path.join(os.path.dirname(__file__), "libglint.so.0")  # in wheels
    for name in (chosen,) if chosen else (bundled, "libglint.so.0", ctypes.util.find_library("glint")):
        if name:
            try:
                return ctypes.CDLL(name)
            except OSError as error:
                problem = error
    raise ImportError(f"libglint was not found ({problem}): install it, or set GLINT_LIBRARY to the path of libglint.so.0")


loaded = _load()
_handle, _pointer = ctypes.c_void_p, ctypes.POINTER
_SIGNATURES = {
    "glint_device_count": [_pointer(ctypes.c_uint32)],
    "glint_device_describe": [ctypes.c_uint32, _pointer(DeviceInfo)],
    "glint_device_open": [ctypes.c_char_p, _pointer(_handle)],
    "glint_device_open_with": [ctypes.c_char_p, _pointer(Settings), _pointer(_handle)],
    "glint_device_info_of": [_handle, _pointer(DeviceInfo)],
    "glint_scene_create": [_handle, _pointer(_handle)],
    "glint_scene_load_with": [_handle, ctypes.c_char_p, _pointer(Options), _pointer(_handle)],
    "glint_scene_add_triangles": [_handle, _pointer(Triangles), _pointer(ctypes.c_uint32)],
    "glint_scene_add_spheres": [_handle, _pointer(Spheres), _pointer(ctypes.c_uint32)],
    "glint_scene_add_json": [_handle, ctypes.c_char_p, ctypes.c_char_p, _pointer(ctypes.c_uint32), _pointer(ctypes.c_uint32)],
    "glint_scene_add_instance": [_handle, ctypes.c_uint32, _pointer(ctypes.c_double), _pointer(ctypes.c_uint32)],
    "glint_scene_set_transform": [_handle, ctypes.c_uint32, _pointer(ctypes.c_double)],
    "glint_scene_set_vertices": [_handle, ctypes.c_uint32, _pointer(View)],
    "glint_scene_find_material": [_handle, ctypes.c_char_p, _pointer(ctypes.c_uint32)],
    "glint_scene_commit_with": [_handle, _pointer(Options)],
    "glint_scene_prepare": [_handle],
    "glint_scene_info_of": [_handle, _pointer(SceneInfo)],
    "glint_scene_warning": [_handle, ctypes.c_uint32, _pointer(ctypes.c_char_p)],
    "glint_pinhole_rays": [_pointer(ctypes.c_double), _pointer(ctypes.c_double), ctypes.c_uint32, ctypes.c_uint32,
                           _pointer(ctypes.c_double), _pointer(View)],
    "glint_query_closest": [_handle, _pointer(Rays), _pointer(Hits), _pointer(Options)],
    "glint_query_any": [_handle, _pointer(Rays), _pointer(View), _pointer(Options)],
    "glint_query_count": [_handle, _pointer(Rays), _pointer(View), _pointer(Options)],
    "glint_query_all": [_handle, _pointer(Rays), _pointer(View), _pointer(Hits), _pointer(ctypes.c_uint64), _pointer(Options)],
    "glint_query_inside": [_handle, _pointer(View), _pointer(View), _pointer(Options)],
    "glint_query_closest_point": [_handle, _pointer(View), _pointer(Hits), _pointer(Options)],
    "glint_render": [_handle, _pointer(Picture), _pointer(Options)],
}
for _name, _arguments in _SIGNATURES.items():
    getattr(loaded, _name).argtypes = _arguments
    getattr(loaded, _name).restype = ctypes.c_int32
for _name in ("glint_device_release", "glint_scene_release"):
    getattr(loaded, _name).argtypes = [_handle]
    getattr(loaded, _name).restype = None
loaded.glint_last_error.restype = ctypes.c_char_p
loaded.glint_status_name.restype = ctypes.c_char_p
loaded.glint_status_name.argtypes = [ctypes.c_int32]
loaded.glint_version.restype = ctypes.c_uint32


def call(name: str, *arguments: Any) -> None:
    """Calls the function of that name; raises Error if it fails."""
    status = getattr(loaded, name)(*arguments)
    if status != OK:
        message = re.sub(r"^glint_\w+: ", "", loaded.glint_last_error().decode())  # the name of the C function
        raise Error(loaded.glint_status_name(status).decode(), message)


class Owner:
    """Owns a handle of the library, which is valid in the process that made it."""
    _release = ""

    def __init__(self) -> None:
        self._held = ctypes.c_void_p()
        self._process = os.getpid()

    @property
    def _handle(self) -> ctypes.c_void_p:
        if self._process != os.getpid():
            raise Error("state", f"this {type(self).__name__} was made in another process; make it in the one that uses it")
        return self._held

    def __del__(self) -> None:
        if getattr(self, "_process", None) == os.getpid():
            held, self._held = self._held, ctypes.c_void_p()  # a call by hand is followed by the interpreter's
            getattr(loaded, self._release)(held)

    def __reduce_ex__(self, protocol: Any) -> Any:
        raise TypeError(f"a {type(self).__name__} can be neither copied nor pickled; make another one from the same arrays or file")


@functools.lru_cache(maxsize=None)
def record(name: str, fields: tuple[str, ...]) -> Any:
    """A type of named tuples that can be pickled; equal names give the same type."""
    make_kind: Any = collections.namedtuple  # type checkers require literals as fields
    kind = make_kind(name, fields)

    def missing(_: Any, asked: str) -> Any:
        raise AttributeError(f"{name} has no {asked!r}: only {', '.join(fields) or 'nothing'} was requested")
    kind.__getattr__ = missing
    kind.__reduce__ = lambda self: (_restored, (name, fields, tuple(self)))
    return kind


def _restored(name: str, fields: tuple[str, ...], arrays: tuple[Any, ...]) -> Any:
    return record(name, fields)(*arrays)


class Interrupts:
    """Delays KeyboardInterrupt until a call of the library has ended. Acts in the main thread only, and not if the program has its own
    handler."""

    def __init__(self) -> None:
        self.noted = False
        self._active = False

    def possible(self) -> bool:
        """True if Ctrl-C would raise KeyboardInterrupt in this thread."""
        return (threading.current_thread() is threading.main_thread()
                and signal.getsignal(signal.SIGINT) is signal.default_int_handler)

    def __enter__(self) -> Interrupts:
        self._active = self.possible()
        if self._active:
            signal.signal(signal.SIGINT, self._note)
        return self

    def _note(self, *_: Any) -> None:
        self.noted = True

    def __exit__(self, *_: Any) -> None:
        if self._active:
            signal.signal(signal.SIGINT, signal.default_int_handler)
        if self.noted:
            raise KeyboardInterrupt


def view(array: NDArray[Any] | None) -> View:
    """A view of an array. The last of several axes holds the numbers of an element."""
    if array is None:
        return View()
    stride = array.strides[0] if array.size else 0
    return View(array.ctypes.data_as(ctypes.c_void_p), array.shape[0], stride, _TYPES[array.dtype.name], 0)


def text(given: str | bytes) -> bytes:
    """The text for C, which ends at the first null character; ValueError if it has one."""
    encoded = given.encode() if isinstance(given, str) else given
    if b"\0" in encoded:
        raise ValueError("there is a null character in the text")
    return encoded


def whole(given: Any, what: str, bits: int = 32) -> int:
    """A whole number that so many bits hold, of which ctypes would drop the others; ValueError for all else."""
    number = operator.index(given)
    if not 0 <= number < 1 << bits:
        raise ValueError(f"{what} is {number}; it must be 0 to {(1 << bits) - 1}")
    return number


def indices(given: ArrayLike, what: str) -> NDArray[numpy.uint32]:
    """An array (n, 3) of uint32; ValueError for numbers that are no indices."""
    array = numpy.asarray(given)
    if array.shape == (0,):  # an empty list
        array = array.reshape(0, 3)
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"{what} has the shape {array.shape}; it must be (n, 3)")
    if array.dtype != numpy.uint32 and array.size:
        if array.dtype.kind not in "iu" and not (array.dtype.kind == "f" and (array == numpy.floor(array)).all()):
            raise ValueError(f"{what} has numbers that are not whole")
        if array.min() < 0:
            raise ValueError(f"{what} has a negative index")
        if array.max() >= NONE:
            raise ValueError(f"{what} has an index that 32 bits do not hold")
    return numpy.ascontiguousarray(array, dtype=numpy.uint32)


def shape_before(given: ArrayLike) -> tuple[int, ...]:
    """The shape without the last axis, which holds the numbers of an element."""
    shape = numpy.shape(given)
    return shape if shape == (0,) else shape[:-1]


def numbers(given: ArrayLike, width: int | None, what: str) -> NDArray[Any]:
    """An array of float32 or float64, (n, width) or, for width None, (n,); a copy only if necessary."""
    array = numpy.asarray(given)
    if array.dtype not in (numpy.float32, numpy.float64):
        if array.dtype.kind == "c":
            raise ValueError(f"{what} has complex numbers")
        try:
            if array.dtype == object and any(number is None for number in array.flat):
                raise ValueError("None")
            array = array.astype(numpy.float64)
        except (TypeError, ValueError) as error:
            raise ValueError(f"{what} has something that is not a number: {error}") from None
    if width is not None and array.shape == (0,):  # an empty list
        array = array.reshape(0, width)
    if width is None:
        array = array.reshape(-1) if array.ndim != 1 else array
    else:
        if array.shape[-1:] != (width,):
            raise ValueError(f"{what} has the shape {array.shape}; its last axis must be {width}")
        if array.ndim != 2:
            array = array.reshape(-1, width)
        if array.strides[1] != array.itemsize:
            array = numpy.ascontiguousarray(array)
    # A stride of 0 means "packed" in glint and "all equal" in numpy.
    if array.shape[0] > 1 and array.strides[0] == 0:
        array = numpy.ascontiguousarray(array)
    return array
