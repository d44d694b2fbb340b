#!/usr/bin/env python3
"""Machine code that lavapipe made of the kernels a command ran: instructions in all and in each loop.

    bench/kernel_code.py [--dump FOLDER] -- COMMAND...

Runs COMMAND with an empty shader cache, takes the compiled objects out of it (each file holds a zstd frame with an ELF object)
and disassembles them. A loop is a jump backwards; `own` are its instructions without those of loops within it. Counts do not depend on
how busy the machine is. Needs zstd and objdump.
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

FRAME = b"\x28\xb5\x2f\xfd"
LINE = re.compile(r"^\s*([0-9a-f]+):\s+(\S+)\s*(.*)$")


def objects(folder):
    for path in sorted(pathlib.Path(folder).rglob("*"), key=lambda p: p.stat().st_mtime):
        if not path.is_file():
            continue
        data = path.read_bytes()
        start = data.find(FRAME)
        if start < 0:
            continue
        done = subprocess.run(["zstd", "-dcq"], input=data[start:], capture_output=True)
        elf = done.stdout.find(b"\x7fELF")
        if elf >= 0:
            yield path.name, done.stdout[elf:]


def functions(elf):
    with tempfile.NamedTemporaryFile(suffix=".o") as file:
        file.write(elf)
        file.flush()
        text = subprocess.run(["objdump", "-d", "--no-show-raw-insn", file.name], capture_output=True, text=True).stdout
    name, code = None, []
    for line in text.splitlines():
        if line.endswith(">:"):
            if code:
                yield name, code
            name, code = line.split("<")[1][:-2], []
        elif match := LINE.match(line):
            code.append((int(match[1], 16), match[2], match[3]))
    if code:
        yield name, code


def loops(code):
    index = {address: i for i, (address, _, _) in enumerate(code)}
    ranges = {}
    for i, (address, op, rest) in enumerate(code):
        target = re.match(r"([0-9a-f]+) <", rest)
        if op.startswith("j") and target:
            to = index.get(int(target[1], 16))
            if to is not None and to <= i:
                ranges[to] = max(i, ranges.get(to, 0))
    return sorted(ranges.items())


def report(name, code):
    print(f"{name}: {len(code)} instructions")
    found = loops(code)
    for first, last in found:
        inner = [(a, b) for a, b in found if (a, b) != (first, last) and first <= a and b <= last]
        covered = {i for a, b in inner for i in range(a, b + 1)}
        own = last - first + 1 - len(covered)
        depth = sum(1 for a, b in found if a <= first and last <= b) - 1
        if own >= 40:
            print(f"  {'  ' * depth}loop at {code[first][0]:#x}: {last - first + 1} instructions, own {own}")


def main():
    arguments = sys.argv[1:]
    dump = None
    if arguments[:1] == ["--dump"]:
        dump, arguments = pathlib.Path(arguments[1]), arguments[2:]
        dump.mkdir(parents=True, exist_ok=True)
    if arguments[:1] == ["--"]:
        arguments = arguments[1:]
    if not arguments:
        sys.exit(__doc__)
    with tempfile.TemporaryDirectory() as cache:
        environment = dict(os.environ, MESA_SHADER_CACHE_DIR=cache)
        subprocess.run(arguments, env=environment, check=True, stdout=subprocess.DEVNULL)
        for number, (name, elf) in enumerate(objects(cache)):
            if dump:
                (dump / f"{number:02}_{name[:8]}.o").write_bytes(elf)
            for function, code in functions(elf):
                if len(code) > 300:
                    report(f"{name[:8]} {function}", code)


if __name__ == "__main__":
    main()
