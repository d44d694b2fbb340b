#!/usr/bin/env python3
"""Runs the shell examples of a page in a temporary folder.

    run_examples.py GLINT PAGE              runs the page's examples
    run_examples.py GLINT PAGE --pictures   and copies the rendered images of the page to docs/images/guide
    run_examples.py GLINT --help-page       checks that docs/reference/command-line.md names every command and option of --help
    run_examples.py --self-test             checks that wrong examples are found

Fenced blocks of a page, in order:

    ```jsonc scene.json     the block is written to scene.json
    ```sh                   the commands must all end with exit code 0
    ```console              lines behind "$ " are commands; below them stands their output (both streams). There ... stands for
                            anything, on a line by itself for any lines
    ```sh no-run            not run (a window, minutes), but each glint command's options must be in its --help

The folder has a copy of scenes/, and links to the folders build/, src/, tools/, docs/, examples/ of the repository, so that paths on pages hold.
"""
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
LIMIT_SECONDS = 240


def blocks(text):
    """(line number, words behind the backquotes, text) of each fenced block."""
    if len(re.findall(r"(?m)^```", text)) % 2:
        raise ValueError("the last block has no end")
    return [(text.count("\n", 0, block.start()) + 1, block[1].split(), block[2])
            for block in re.finditer(r"(?ms)^```(.*?)\n(.*?)^```", text)]


def run(command, folder, path):
    environment = {**os.environ, "PATH": f"{path}:{os.environ['PATH']}"}
    try:
        done = subprocess.run(["bash", "-c", command], cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, timeout=LIMIT_SECONDS)
    except subprocess.TimeoutExpired:
        return 124, f"no end within {LIMIT_SECONDS} s\n"
    return done.returncode, done.stdout


def matches(printed, expected):
    """True if the output is that on the page, where ... stands for anything."""
    if not expected.strip():
        return not printed.strip()
    pattern = ""
    for line in expected.rstrip("\n").split("\n"):
        if line.strip() == "...":
            pattern += r"(?:.*\n)*?"
        else:
            pattern += "[^\n]*".join(re.escape(part) for part in line.rstrip().split("...")) + r"[ \t]*\n"
    return re.fullmatch(pattern, printed if printed.endswith("\n") or not printed else printed + "\n") is not None


def console(text):
    """(command, output) of a ```console block; a backslash at the end of a line continues the command."""
    found = []
    for line in text.rstrip("\n").split("\n"):
        if line.startswith("$ "):
            found.append([line[2:], ""])
        elif not found:
            raise ValueError("a console block begins with a command: $ ...")
        elif found[-1][0].endswith("\\") and not found[-1][1]:
            found[-1][0] += "\n" + line
        else:
            found[-1][1] += line + "\n"
    return found


def options_of(glint, command, known={}):
    if command not in known:
        text = subprocess.run([glint, *([command] if command else []), "--help"], capture_output=True, text=True, check=False).stdout
        known[command] = set(re.findall(r"(?<![\w-])(--[a-z][\w-]*|-[a-z])\b", text))
    return known[command]


def check_options(glint, text):
    """Faults of the glint commands in a block that is not run."""
    faults = []
    for line in re.sub(r"\\\n", " ", text).split("\n"):
        words = shlex.split(line, comments=True)
        for at, word in enumerate(words):
            if word != "glint" and not word.endswith("/glint"):
                continue
            command = words[at + 1] if at + 1 < len(words) else ""
            if not options_of(glint, command):
                faults.append(f"glint has no command '{command}'")
            for option in words[at + 2:]:
                name = option.split("=")[0]
                if re.match(r"--?[a-z]", name) and name not in options_of(glint, command):
                    faults.append(f"glint {command} has no option '{name}'")
    return faults


def check_page(glint, page, pictures=False):
    faults = []
    with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryDirectory() as path:
        os.symlink(pathlib.Path(glint).resolve(), pathlib.Path(path) / "glint")
        shutil.copytree(ROOT / "scenes", pathlib.Path(folder) / "scenes")
        for name in ("build", "src", "tools", "docs", "examples"):
            if (ROOT / name).exists():
                os.symlink(ROOT / name, pathlib.Path(folder) / name)
        for number, words, text in blocks(page.read_text()):
            where = f"{page}:{number}"
            if words[:1] == ["sh"] and "no-run" in words:
                faults += [f"{where}: {fault}" for fault in check_options(glint, text)]
            elif words[:1] == ["sh"]:
                code, printed = run("set -eo pipefail\n" + text, folder, path)
                if code != 0:
                    faults.append(f"{where}: exit code {code}:\n{printed}")
            elif words[:1] == ["console"]:
                for command, expected in console(text):
                    _, printed = run(command, folder, path)
                    if not matches(printed, expected):
                        faults.append(f"{where}: $ {command}\nprinted:\n{printed}the page says:\n{expected}")
            elif len(words) > 1 and "." in words[1]:
                (pathlib.Path(folder) / words[1]).write_text(text)
        if pictures:
            for name in re.findall(r"\]\([^)]*images/guide/([\w.-]+)\)", page.read_text()):
                if (pathlib.Path(folder) / name).exists():
                    shutil.copyfile(pathlib.Path(folder) / name, ROOT / "docs/images/guide" / name)
    return faults


def check_help_page(glint):
    page = (ROOT / "docs/reference/command-line.md").read_text()
    help_text = subprocess.run([glint, "--help"], capture_output=True, text=True, check=True).stdout
    commands = re.findall(r"(?m)^  (\w+) ", help_text.split("\nCommands:\n")[-1].split("\n\n")[0])
    faults = [] if len(commands) >= 9 else [f"only {commands} were found in glint --help"]
    shared = re.search(r"(?ms)^## Options that several commands share$(.*?)^## ", page)[1]
    for command in commands:
        section = re.search(rf"(?ms)^## {command}$(.*?)(?=^## |\Z)", page)
        if command == "help":
            continue
        if not section:
            faults.append(f"docs/reference/command-line.md has no section on '{command}'")
            continue
        for option in sorted(options_of(glint, command) - {"-h", "--help"}):
            if not re.search(rf"(?<![\w-]){re.escape(option)}\b", section[1] + shared):
                faults.append(f"docs/reference/command-line.md, {command}: '{option}' is not named")
    return faults


def self_test():
    """Checks a page of correct examples, and one wrong example of each kind."""
    good = "```txt a.txt\nx\n```\n```sh\ncat a.txt\n```\n```console\n$ echo one two; echo 3\none ...\n3\n$ seq 9\n1\n...\n9\n```\n"
    bad = {"exit code 1": "```sh\nfalse\ntrue\n```\n", "the page says": "```console\n$ echo one\ntwo\n```\n", "$ echo three": "```console\n$ echo three\n```\n", "no option": "```sh no-run\nglint render --gone\n```\n"}
    with tempfile.TemporaryDirectory() as folder:
        glint = pathlib.Path(folder) / "glint"
        glint.write_text("#!/bin/sh\necho '  --size WxH'\n")
        glint.chmod(0o755)
        page = pathlib.Path(folder) / "page.md"
        page.write_text(good)
        failed = check_page(glint, page)
        for expected, text in bad.items():
            page.write_text(text)
            if not any(expected in fault for fault in check_page(glint, page)):
                failed.append(f"no fault '{expected}' of:\n{text}")
    return failed


def main():
    arguments = [a for a in sys.argv[1:] if not a.startswith("--")]
    flags = set(sys.argv[1:]) - set(arguments)
    if flags == {"--self-test"}:
        faults = self_test()
    elif flags == {"--help-page"} and len(arguments) == 1:
        faults = check_help_page(arguments[0])
    elif flags <= {"--pictures"} and len(arguments) == 2:
        faults = check_page(arguments[0], pathlib.Path(arguments[1]), "--pictures" in flags)
    else:
        sys.exit(__doc__.strip())
    for fault in faults:
        print(fault)
    sys.exit(1 if faults else 0)


main()
