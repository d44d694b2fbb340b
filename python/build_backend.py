"""PEP 517 build back end of the Python package: builds libglint with CMake and packs it with the module into a wheel.

Needs CMake, a C++20 compiler and the libraries of tools/packages.sh, and nothing from a package index. The module calls the
library by ctypes, so one wheel serves every Python from 3.9 on one platform.
"""
import base64
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sysconfig
import tarfile
import tempfile
import zipfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
NAME = "glint_raytracer"


def _version():
    return re.search(r"project\(glint VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text())[1]


def _metadata():
    return "\n".join([
        "Metadata-Version: 2.1", "Name: glint-raytracer", f"Version: {_version()}",
        "Summary: Ray queries and images with numpy arrays, on any Vulkan 1.1 device or the processor", "License: MIT",
        "Requires-Python: >=3.9", "Requires-Dist: numpy", "Description-Content-Type: text/markdown", "",
        (ROOT / "README.md").read_text()])


def _library(folder):
    """Builds libglint.so into the folder and returns its path."""
    def run(*command):
        subprocess.run(list(map(str, command)), check=True)
    # The set-up installs ninja; make, CMake's default, may be missing.
    generator = ["-G", "Ninja"] if shutil.which("ninja") else []
    run("cmake", "-S", ROOT, "-B", folder, *generator, "-DCMAKE_BUILD_TYPE=Release", "-DGLINT_TESTS=OFF", "-DGLINT_WINDOW=OFF", "-DGLINT_MPI=OFF")
    jobs = os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL") or os.cpu_count() or 1
    run("cmake", "--build", folder, "--target", "glint_shared", "--parallel", jobs)
    return (folder / "lib" / "libglint.so.0").resolve()


def _tag():
    return "py3-none-" + re.sub(r"[-.]", "_", sysconfig.get_platform())


def _info():
    """(name, files) of the folder that describes the package in a wheel."""
    return f"{NAME}-{_version()}.dist-info", {
        "METADATA": _metadata().encode(),
        "WHEEL": f"Wheel-Version: 1.0\nGenerator: glint\nRoot-Is-Purelib: false\nTag: {_tag()}\n".encode(),
        "LICENSE": (ROOT / "LICENSE").read_bytes()}


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    """Writes the package's metadata, so that pip finds missing requirements before the build."""
    info, files = _info()
    folder = pathlib.Path(metadata_directory) / info
    folder.mkdir()
    for name, content in files.items():
        (folder / name).write_bytes(content)
    return info


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """Writes glint_raytracer-VERSION-py3-none-PLATFORM.whl. GLINT_WHEEL_LIBRARY names a libglint.so.0 that is built already."""
    info, described = _info()
    name = f"{NAME}-{_version()}-{_tag()}.whl"
    with tempfile.TemporaryDirectory(prefix="glint-wheel-") as folder:
        built = os.environ.get("GLINT_WHEEL_LIBRARY")
        library = pathlib.Path(built).resolve() if built else _library(pathlib.Path(folder))
        files = {f"glint/{path.name}": path.read_bytes() for path in sorted((ROOT / "python/glint").iterdir()) if path.suffix in (".py", ".typed")}
        files["glint/libglint.so.0"] = library.read_bytes()
        files.update({f"{info}/{part}": content for part, content in described.items()})
        records = []
        with zipfile.ZipFile(pathlib.Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
            for path, content in files.items():
                wheel.writestr(path, content)
                digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
                records.append(f"{path},sha256={digest},{len(content)}")
            wheel.writestr(f"{info}/RECORD", "\n".join([*records, f"{info}/RECORD,,", ""]))
    return name


def build_sdist(sdist_directory, config_settings=None):
    """Writes the files of the last commit as glint_raytracer-VERSION.tar.gz. Needs git."""
    top = f"{NAME}-{_version()}"
    name = f"{top}.tar.gz"
    target = pathlib.Path(sdist_directory) / name
    with tempfile.TemporaryDirectory(prefix="glint-sdist-") as folder:
        plain = pathlib.Path(folder) / "tree.tar"
        subprocess.run(["git", "-C", str(ROOT), "archive", f"--prefix={top}/", "-o", str(plain), "HEAD"], check=True)
        (pathlib.Path(folder) / "PKG-INFO").write_text(_metadata())
        with tarfile.open(plain) as tree, tarfile.open(target, "w:gz") as packed:
            for member in tree:
                packed.addfile(member, tree.extractfile(member) if member.isfile() else None)
            packed.add(pathlib.Path(folder) / "PKG-INFO", f"{top}/PKG-INFO")
    return name
