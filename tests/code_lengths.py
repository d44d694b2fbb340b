#!/usr/bin/env python3
"""Fails on functions of more than 60 lines and on files of more than 500, in C++ and GLSL.

Usage: code_lengths.py FOLDER...

A function's lines are those from the start of its declaration to its closing brace. Braces are counted, no
more: comments, strings, characters and preprocessor lines are left out, and outside of functions a brace
opens a function if the text before it has a parenthesis and is no class, namespace or initializer.
"""
import pathlib
import re
import sys

MAX_FUNCTION_LINES = 60
MAX_FILE_LINES = 500
SUFFIXES = {".h", ".cpp", ".glsl", ".comp"}

BLANKED = re.compile(
    r'R"(?P<end>\w*)\(.*?\)(?P=end)"'  # raw string
    r"|//[^\n]*|/\*.*?\*/"
    r'|"(?:\\.|[^"\\\n])*"'
    r"|(?<![0-9a-zA-Z])'(?:\\.|[^'\\\n])+'"
    r"|^[ \t]*#(?:\\\n|[^\n])*"
    r"|^[A-Z][A-Z0-9_]+\([^;{}\n]*\)[ \t]*$",  # a macro that stands for declarations
    re.DOTALL | re.MULTILINE,
)
SCOPE = re.compile(r'^(?:template\s*<.*>\s*)?(?:inline\s+)?(?:namespace|class|struct|union|enum|extern)\b', re.DOTALL)


def blank(match):
    return re.sub(r"[^\n]", " ", match.group(0))


def functions(text):
    """(first line, last line, head) of every function, lines from 1."""
    text = BLANKED.sub(blank, text)
    line, depth, inside, scopes = 1, 0, None, []
    head, head_line = "", None
    for c in text:
        if inside is not None:
            depth += (c == "{") - (c == "}")
            if depth == 0:
                yield inside[0], line, inside[1]
                inside, head, head_line = None, "", None
        elif c == "{":
            declared = head.strip()
            is_scope = SCOPE.match(declared) and not re.search(r"\)\s*(const|noexcept|override|\s)*$", declared)
            if "(" in declared and not is_scope and not re.search(r"=\s*$", declared):
                inside, depth = (head_line, " ".join(declared.split())), 1
            else:
                scopes.append(declared)
                head, head_line = "", None
        elif c in ";}":
            if c == "}" and scopes:
                scopes.pop()
            head, head_line = "", None
        else:
            if head_line is None and not c.isspace():
                head_line = line
            head += c
        line += c == "\n"


def faults(path):
    text = path.read_text(encoding="utf-8")
    lines = text.count("\n")
    if lines > MAX_FILE_LINES:
        yield f"{path}: {lines} lines, {MAX_FILE_LINES} are allowed"
    for first, last, head in functions(text):
        if last - first + 1 > MAX_FUNCTION_LINES:
            yield f"{path}:{first}: {last - first + 1} lines, {MAX_FUNCTION_LINES} are allowed: {head[:90]}"


def check_oneself():
    """The count itself: a test that finds nothing must have looked."""
    body = "    x = 1;\n" * 59
    assert list(functions("int f(int a) {\n" + body + "}\n")) == [(1, 61, "int f(int a)")]
    assert list(functions("namespace n {\nclass C {\n  int f() const {\n    if (a) {\n    }\n  }\n};\n}\n")) == [
        (3, 6, "int f() const")
    ]
    assert list(functions('int a[] = {1};\n// f() {\nvoid g(\n    int b) { h("}"); }\n')) == [(3, 4, "void g( int b)")]


def main():
    check_oneself()
    found = [
        path
        for folder in sys.argv[1:]
        for path in sorted(pathlib.Path(folder).rglob("*"))
        if path.suffix in SUFFIXES
    ]
    if not found:
        sys.exit(f"no sources in {sys.argv[1:]}")
    wrong = [fault for path in found for fault in faults(path)]
    for fault in wrong:
        print(fault)
    sys.exit(1 if wrong else 0)


main()
