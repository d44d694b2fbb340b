#!/usr/bin/env python3
"""abi_test.py SOURCE [--store | --self-test]: the ABI of libglint is still the one described in tests/library/libglint.abi.

What callers are compiled against is include/glint/glint.h, so a library of empty functions made from it stands for libglint
(that libglint exports those functions is installed_test.py's to check), and takes a second to build. abidiff compares. A
function that is gone or has other types, a struct's member that moved, and any change of a struct without `size` in front are
faults; new functions are not, and neither are new members at the end of a struct that begins with its size, as old callers
say how much of it they have. Needs abidw and abidiff (Debian's abigail-tools) and a C compiler.

--store: takes the ABI as it is now for the one to keep. At a release, or with a reason that the commit says.
--self-test: finds the faults that are put into a copy of the header.
"""
import pathlib
import re
import subprocess
import sys
import tempfile

SUPPRESSIONS = """[suppress_type]
type_kind = struct
name_regexp = ^({structs})$
has_data_member_inserted_at = end
has_size_change = yes
"""


def library(header, folder):
    """A shared library with an empty function for each declaration of the header."""
    text = header.read_text(encoding="utf-8")
    functions = re.findall(r"^GLINT_API ((?:[^;{])*?\));", text, re.M | re.S)
    if len(functions) < 20:
        sys.exit(f"{header}: only {len(functions)} functions were found")
    include = folder / "glint"
    include.mkdir(parents=True, exist_ok=True)
    (include / "glint.h").write_text(text, encoding="utf-8")
    source = folder / "stubs.c"
    bodies = [function + (" {}" if function.startswith("void ") else " { return 0; }") for function in functions]
    source.write_text("#include <glint/glint.h>\n" + "\n".join(bodies) + "\n", encoding="utf-8")
    made = folder / "libglint.so.0"
    subprocess.run(["cc", "-g", "-shared", "-fPIC", "-Wl,-soname,libglint.so.0", f"-I{folder}", "-o", made, source], check=True)
    return made


def describe(made):
    options = ["--no-corpus-path", "--no-comp-dir-path", "--no-show-locs", "--no-elf-needed"]
    return subprocess.run(["abidw", *options, made], check=True, capture_output=True, text=True).stdout


def sized_structs(header):
    return re.findall(r"^typedef struct (\w+) \{\n    uint64_t size;", header.read_text(encoding="utf-8"), re.M)


def faults(header, stored, folder):
    """abidiff's report, or "" if callers of the stored ABI can use this one."""
    now = folder / "now.abi"
    now.write_text(describe(library(header, folder)), encoding="utf-8")
    suppressions = folder / "suppressions"
    suppressions.write_text(SUPPRESSIONS.format(structs="|".join(sized_structs(header))), encoding="utf-8")
    found = subprocess.run(["abidiff", "--no-added-syms", "--suppressions", suppressions, stored, now], capture_output=True,
                           text=True)
    return found.stdout + found.stderr if found.returncode != 0 else ""


def self_test(header, stored):
    text = header.read_text(encoding="utf-8")
    changes = [
        (True, "uint32_t geometry,\n", "uint64_t geometry,\n", "a parameter's type"),
        (True, "GLINT_API uint32_t glint_version(void);", "", "a function that is gone"),
        (True, "    glint_view origins;", "    uint32_t more;\n    glint_view origins;", "a member in front of others"),
        (True, "    int32_t reserved;\n} glint_view;", "    int32_t reserved;\n    int64_t more;\n} glint_view;",
         "a member of a struct without size"),
        (False, "} glint_rays;", "    uint64_t more;\n} glint_rays;", "a member at the end of a struct with size"),
        (False, "GLINT_API uint32_t glint_version(void);", "GLINT_API uint32_t glint_version(void);\nGLINT_API int glint_more(void);",
         "a function more"),
        (False, "", "", "nothing"),
    ]
    wrong = 0
    for fault, before, after, what in changes:
        if before not in text:
            sys.exit(f"{header}: \"{before}\" is not in it, which the test changes")
        with tempfile.TemporaryDirectory() as folder:
            changed = pathlib.Path(folder) / "changed.h"
            changed.write_text(text.replace(before, after, 1), encoding="utf-8")
            report = faults(changed, stored, pathlib.Path(folder))
        if bool(report) != fault:
            print(f"{what}: {'not found' if fault else 'taken for a fault'}\n{report}")
            wrong += 1
    return wrong


def main():
    source = pathlib.Path(sys.argv[1])
    header, stored = source / "include/glint/glint.h", source / "tests/library/libglint.abi"
    if "--self-test" in sys.argv:
        sys.exit(1 if self_test(header, stored) else 0)
    with tempfile.TemporaryDirectory() as folder:
        if "--store" in sys.argv:
            stored.write_text(describe(library(header, pathlib.Path(folder))), encoding="utf-8")
            return
        report = faults(header, stored, pathlib.Path(folder))
    if report:
        sys.exit(f"libglint's ABI is not what it was ({stored.relative_to(source)}):\n{report}")


if __name__ == "__main__":
    main()
