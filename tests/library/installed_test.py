#!/usr/bin/env python3
"""Installs libglint into a folder of its own, and uses it from there as projects of others do.

    installed_test.py BUILD SOURCE CMAKE [--strict]

Checks what the libraries show, builds examples/ with gcc against the CMake package, shared and static, and with pkg-config;
compiles and runs the programs in README.md and docs/guide/library.md; and looks at what each prints.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

BUILD, SOURCE, CMAKE = (pathlib.Path(argument) for argument in sys.argv[1:4])
IS_STRICT = "--strict" in sys.argv[4:]  # with clang too, and warnings as errors: a check of CI
STRICT = ["-Wall", "-Wextra", "-Wpedantic"] + (["-Werror"] if IS_STRICT else [])
EXPECTED = {
    "nearest_hit": ["ray 0: geometry 1 at 7.000", "ray 1: geometry 0 at 9.000", "ray 2: nothing"],
    "sun_hours": ["x = -4: 2.75 h", "x = -2: 3.00 h", "x =  0: 3.25 h", "x =  2: 3.00 h", "x =  4: 2.75 h"],
}
COMPILERS = [("gcc", "g++")] + ([("clang", "clang++")] if IS_STRICT else [])
PAGES = ["README.md", "docs/guide/library.md"]


def run(*command, **options):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, **options)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}\nended with {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def check_symbols(library, *options):
    """Only glint_... and what C++ shares between all programs (weak) may be seen."""
    strangers = []
    for line in run("nm", "-C", "--defined-only", *options, library).splitlines():
        found = re.match(r"[0-9a-f]+ ([A-Z]) (.*)", line)
        if found and found[1] not in "WVu" and not found[2].startswith("glint_"):
            strangers.append(line)
    if strangers:
        sys.exit(f"{library} shows more than glint_...:\n" + "\n".join(strangers[:20]))


def check_output(program, environment):
    name = program.name.removesuffix("_static")
    for device in ("cpu", ""):
        printed = run(program, *([device] if device else []), env=environment).rstrip("\n").split("\n")
        if printed != EXPECTED[name]:
            sys.exit(f"{program} {device} printed\n{printed}\ninstead of\n{EXPECTED[name]}")


def build_examples(prefix, folder, c, cxx, environment):
    flags = " ".join(STRICT)
    run(CMAKE, "-G", "Ninja", "-S", SOURCE / "examples", "-B", folder, f"-DCMAKE_PREFIX_PATH={prefix}", f"-DCMAKE_C_COMPILER={c}",
        f"-DCMAKE_CXX_COMPILER={cxx}", f"-DCMAKE_C_FLAGS={flags}", f"-DCMAKE_CXX_FLAGS={flags}", "-DGLINT_EXAMPLES_STATIC=ON")
    run(CMAKE, "--build", folder, "-j2")
    for name in ("nearest_hit", "sun_hours", "sun_hours_static"):
        check_output(folder / name, environment)


def refuses_other_versions(prefix, folder):
    for version in ("0.2", "1.0"):
        (folder / "CMakeLists.txt").write_text(
            f"cmake_minimum_required(VERSION 3.16)\nproject(other NONE)\nfind_package(glint {version} CONFIG QUIET)\n"
            "if(glint_FOUND)\n  message(FATAL_ERROR \"found\")\nendif()\n")
        run(CMAKE, "-G", "Ninja", "-S", folder, "-B", folder / f"build-{version}", f"-DCMAKE_PREFIX_PATH={prefix}")


def names_the_standard(folder, flags):
    """The first error in C++17, the default of GCC 12, states the remedy."""
    source = folder / "old.cpp"
    source.write_text("#include <glint/glint.hpp>\n")
    done = subprocess.run(["g++", "-std=c++17", "-fsyntax-only", source, *flags], capture_output=True, text=True)
    if "-std=c++20" not in done.stderr.partition("error")[2].partition("\n")[0]:
        sys.exit(f"in C++17 glint.hpp should ask for C++20, not\n{done.stderr}")


def programs_of(page):
    """(language, text, what it prints) of each ```c or ```cpp block that has a main, and the ```text block behind it."""
    found = re.findall(r"```(c|cpp)\n(.*?)```(?:\s*It prints\s*```text\n(.*?)```)?", page.read_text(), re.DOTALL)
    return [block for block in found if "main(" in block[1]]


def check_pages(prefix, folder, flags, environment):
    for name in PAGES:
        programs = programs_of(SOURCE / name)
        if {"c", "cpp"} != {language for language, _, _ in programs}:
            sys.exit(f"{name} should hold programs in C and in C++")
        for number, (language, text, printed) in enumerate(programs):
            program = folder / f"{pathlib.Path(name).stem}_{number}"
            source = program.with_suffix(f".{language}")
            source.write_text(text)
            # Here the headers are not the system's, so that what they are warned of is seen.
            for c, cxx in COMPILERS:
                compiler = [c, "-std=c99"] if language == "c" else [cxx, "-std=c++20"]
                run(*compiler, *STRICT, source, "-o", program, *flags)
            got = run(program, env=environment, cwd=SOURCE)
            if printed and got != printed:
                sys.exit(f"a program of {name} printed\n{got}instead of\n{printed}")


def main():
    folder = pathlib.Path(tempfile.mkdtemp(prefix="glint-installed-"))
    try:
        prefix = folder / "prefix"
        for component in ("library", "development"):
            run(CMAKE, "--install", BUILD, "--prefix", prefix, "--component", component)
        shared = next(prefix.rglob("libglint.so"))
        check_symbols(shared, "-D")
        check_symbols(shared.parent / "libglint.a", "--extern-only")
        if not re.search(r"SONAME\s+libglint\.so\.0\n", run("objdump", "-p", shared)):
            sys.exit("the SONAME is not libglint.so.0")
        environment = {**os.environ, "LD_LIBRARY_PATH": str(shared.parent), "PKG_CONFIG_PATH": str(shared.parent / "pkgconfig")}
        for c, cxx in COMPILERS:
            if shutil.which(cxx) is None:
                sys.exit(f"{cxx} is missing: install the Debian package {'clang' if c == 'clang' else 'g++'}")
            build_examples(prefix, folder / c, c, cxx, environment)
        refused = folder / "refused"
        refused.mkdir()
        refuses_other_versions(prefix, refused)
        compiling = run("pkg-config", "--cflags", "glint", env=environment).split()
        if len(compiling) != 1:
            sys.exit(f"pkg-config --cflags glint names more than glint's own headers: {compiling}")
        flags = run("pkg-config", "--cflags", "--libs", "glint", env=environment).split()
        program = folder / "nearest_hit"
        run("gcc", "-std=c99", *STRICT, SOURCE / "examples/c/nearest_hit.c", "-o", program, *flags)
        check_output(program, environment)
        names_the_standard(folder, flags)
        check_pages(prefix, folder, flags, environment)
    finally:
        shutil.rmtree(folder)


main()
