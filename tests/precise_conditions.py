#!/usr/bin/env python3
"""Finds sums and products that a condition of an intersection test compares directly.

    precise_conditions.py FOLDER [--self-test]

`precise` does not reach an expression inside `if (...)` or `? :` (glslang issue 1449), so every compared number of an intersection
test has to be a named `precise` variable, an argument or a stored value. Looks at shaders/primitives/*.glsl and at the file that
tests boxes; an operator +, - or * next to <, <=, >, >=, == or != within one comparison is a fault, constants apart.
"""
import pathlib
import re
import sys

FILES = ["shaders/primitives/*.glsl", "shaders/traversal/ray.glsl"]
# Products with powers of two are exact.
ALLOWED = [
    "longest > 32.0 * length(n)",
    "16.0 * near < far",
]
NUMBER = r"[A-Za-z_][\w.\[\]]*(?:\([^()]*\))?|\d+\.?\d*(?:e-?\d+)?u?|\((?:[^()]|\([^()]*\))*\)"
TERM = r"-?(?:%s)" % NUMBER
CHAIN = r"%s(?:\s*[-+*]\s*%s)*" % (TERM, TERM)
COMPARISON = re.compile(r"(%s)\s*(<=|>=|==|!=|<|>)\s*(%s)" % (CHAIN, CHAIN))


def faults_of(text):
    text = re.sub(r"//[^\n]*", "", text)
    text = re.sub(r"^\s*#.*(?:\\\n.*)*$", "", text, flags=re.M)
    found = []
    for match in COMPARISON.finditer(text):
        sides = (match.group(1), match.group(3))
        if not any(re.search(r"[\w)\]]\s*[-+*]\s*[\w(]", re.sub(r"\de-?\d+", "1", side)) for side in sides):
            continue
        # Whole numbers have no rounding.
        if any(re.search(r"\du\b|index|trips|count|Bits", side) for side in sides):
            continue
        whole = " ".join(match.group(0).split())
        if not any(allowed in whole for allowed in ALLOWED):
            found.append((text.count("\n", 0, match.start()) + 1, whole))
    return found


def main():
    if "--self-test" in sys.argv:
        assert faults_of("bool b = x * y > z;") and faults_of("if (t <= a + b) c();")
        assert not faults_of("bool b = t > ray.tMin && near <= ray.tMax; float y = a - b;")
        assert not faults_of("// a + b > c\nbool b = dot(a, b) > c;")
        return 0
    root = pathlib.Path(sys.argv[1])
    count = 0
    for pattern in FILES:
        for path in sorted(root.glob(pattern)):
            for line, text in faults_of(path.read_text()):
                print("%s:%d: %s" % (path.relative_to(root), line, text))
                count += 1
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main())
