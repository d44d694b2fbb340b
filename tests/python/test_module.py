"""The module as a whole: names, types, files, meshes, processes, wheels."""
import copy
import inspect
import multiprocessing
import os
import pathlib
import pickle
import subprocess
import sys
import typing
import zipfile
from types import SimpleNamespace

import pytest

import glint
import glint.open3d
import glint.trimesh
from conftest import CUBE, FACES


def test_everything_public_has_types_and_a_docstring():
    assert (pathlib.Path(glint.__file__).parent / "py.typed").exists()
    things = [getattr(glint, name) for name in glint.__all__] + [glint.open3d.RaycastingScene, glint.trimesh.RayMeshIntersector]
    for thing in things:
        if not callable(thing):
            continue
        assert inspect.getdoc(thing), thing
        members = [m for n, m in vars(thing).items() if not n.startswith("_")] if inspect.isclass(thing) else [thing]
        for member in members:
            function = member.fget if isinstance(member, property) else getattr(member, "__func__", member)
            if inspect.isfunction(function):
                assert inspect.getdoc(function), function
                hints = typing.get_type_hints(function)
                assert set(inspect.signature(function).parameters) - {"self", "cls"} <= set(hints) and "return" in hints, function


def test_what_can_be_pickled(cube):
    hits = pickle.loads(pickle.dumps(cube.cast([[0.2, 0.3, 5, 0, 0, -1]])))
    assert hits.t == 4 and hits._fields == ("t", "geometry", "primitive", "uv", "normal")
    error = pickle.loads(pickle.dumps(glint.Error("scene", "why")))
    assert error.status == "scene" and str(error) == "why"
    for held in (cube, cube._device):  # two owners would release one handle twice
        for way in (pickle.dumps, copy.copy, copy.deepcopy):
            with pytest.raises(TypeError, match="neither copied nor pickled"):
                way(held)


def _in_child(queue, scene, device):
    try:
        scene.cast([[0.2, 0.3, 5, 0, 0, -1]])
        queue.put("answered")
    except glint.Error as error:
        queue.put(error.status)
    queue.put(glint.Scene(CUBE, FACES, device).cast([[0.2, 0.3, 5, 0, 0, -1]]))


def test_a_forked_process_makes_its_own(device, cube):
    queue = multiprocessing.get_context("fork").SimpleQueue()
    child = multiprocessing.get_context("fork").Process(target=_in_child, args=(queue, cube, "cpu" if device.info["reference"] else ""))
    child.start()
    assert queue.get() == "state" and queue.get().t == 4
    child.join()
    assert child.exitcode == 0


def test_devices_and_version():
    assert glint.version() == (0, 1, 0)
    found = glint.devices()
    assert found[-1]["name"] == "cpu" and found[-1]["reference"]
    assert glint.Device("cpu").info["reference"]
    with pytest.raises(glint.Error):
        glint.Device("no such device")


def test_meshes_are_accepted(device):
    ray = [[0.2, 0.3, 5, 0, 0, -1]]
    # The attributes of trimesh's and of Open3D's meshes.
    for mesh in (SimpleNamespace(vertices=CUBE, faces=FACES), SimpleNamespace(vertices=CUBE.tolist(), triangles=FACES.tolist())):
        assert glint.Scene(mesh, device=device).cast(ray).t == 4


def test_a_missing_file_is_a_file_not_found_error(device):
    with pytest.raises(FileNotFoundError) as caught:
        glint.Scene.load("nowhere.json", device)
    assert caught.value.filename == "nowhere.json"


def test_none_is_no_number(cube):
    with pytest.raises(ValueError, match="None"):
        cube.cast([[0.2, 0.3, 5, 0, 0, None]])


def test_dir_shows_the_public_names():
    assert dir(glint) == sorted(glint.__all__)


def test_the_module_prints_version_and_devices():
    done = subprocess.run([sys.executable, "-m", "glint"], capture_output=True, text=True, check=True)
    lines = done.stdout.splitlines()
    assert lines[0] == "glint " + ".".join(map(str, glint.version()))
    assert len(lines) == 1 + len(glint.devices()) and "double precision" in lines[-1]


def test_a_wheel_holds_module_and_library(tmp_path):
    backend = pathlib.Path(os.environ["GLINT_SOURCE"]) / "python"
    library = os.environ["GLINT_LIBRARY"]
    make = f"""import sys; sys.path.insert(0, {str(backend)!r}); import build_backend
print(build_backend.prepare_metadata_for_build_wheel({str(tmp_path)!r}), build_backend.build_wheel({str(tmp_path)!r}))"""
    done = subprocess.run([sys.executable, "-c", make], capture_output=True, text=True, check=True,
                          env={**os.environ, "GLINT_WHEEL_LIBRARY": library})
    info, name = done.stdout.split()
    with zipfile.ZipFile(tmp_path / name) as wheel:
        assert (tmp_path / info / "METADATA").read_bytes() == wheel.read(f"{info}/METADATA")
        names = wheel.namelist()
        recorded = [line.split(",")[0] for line in wheel.read(next(n for n in names if n.endswith("RECORD"))).decode().splitlines()]
        assert sorted(names) == sorted(recorded)
        wheel.extractall(tmp_path / "site")
    where = "import glint; print(glint._native.loaded._name)"
    environment = {name: value for name, value in os.environ.items() if name != "GLINT_LIBRARY"}
    done = subprocess.run([sys.executable, "-c", where], capture_output=True, text=True, check=True,
                          env={**environment, "PYTHONPATH": str(tmp_path / "site")})
    assert done.stdout.strip() == str(tmp_path / "site/glint/libglint.so.0")
