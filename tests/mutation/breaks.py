"""Where GLSL can be broken, and how: sites_of() finds the places of each kind of defect in a file's text.

A site is a replacement of a piece of the text. Comments, preprocessor lines and declarations of interfaces are left alone.
"""
import re
from dataclasses import dataclass


@dataclass(frozen=True)
class Site:
    file: str
    kind: str
    start: int
    end: int
    replacement: str


def masked(text):
    """The text with everything that is no code blanked out, position by position."""
    blank = lambda match: re.sub(r"[^\n]", " ", match.group(0))
    text = re.sub(r"//[^\n]*|/\*.*?\*/", blank, text, flags=re.S)
    text = re.sub(r"^[ \t]*#(?:[^\n]*\\\n)*[^\n]*", blank, text, flags=re.M)
    return re.sub(r"^(?:layout|struct)\b[^;{]*(?:\{[^}]*\})?[^;]*;", blank, text, flags=re.M | re.S)


def arguments(text, at):
    """The spans of the arguments of a call whose bracket opens at `at`; none if no bracket closes it."""
    spans, depth, start = [], 0, at + 1
    for i in range(at, len(text)):
        depth += (text[i] in "([{") - (text[i] in ")]}")
        if depth == 0:
            return spans + [(start, i)]
        if text[i] == "," and depth == 1:
            spans.append((start, i))
            start = i + 1
    return []


OPERATORS = {
    "operator": [(r" \+ ", " - "), (r" - ", " + "), (r" \* ", " / "), (r" / ", " * "), (r" \+= ", " -= "), (r" -= ", " += "),
                 (r" & ", " | "), (r" \| ", " & "), (r" << ", " >> "), (r" >> ", " << ")],
    "comparison": [(r" < ", " <= "), (r" <= ", " < "), (r" > ", " >= "), (r" >= ", " > "), (r" == ", " != "), (r" != ", " == ")],
    "turned": [(r" < ", " > "), (r" <= ", " >= "), (r" > ", " < "), (r" >= ", " <= ")],
    "logic": [(r" && ", " || "), (r" \|\| ", " && "), (r"(?<=[( ])!(?=[A-Za-z(])", "")],
    "sign": [(r"(?<=[(=?:,] )-(?=[A-Za-z(0-9])", ""), (r"(?<=\()-(?=[A-Za-z(0-9])", ""), (r"(?<=return )-(?=[A-Za-z(])", "")],
    "abs": [(r"\babs(?=\()", "")],
    "extreme": [(r"\bmax(?=\()", "min"), (r"\bmin(?=\()", "max")],
    "component": [(r"\.x\b", ".y"), (r"\.y\b", ".z"), (r"\.z\b", ".x"), (r"\.xyz\b", ".yzx")],
}
# float, with a point or an exponent; unsigned
FLOAT = re.compile(r"(?<![\w.])(?:\d+\.\d*|\.\d+|\d+(?=e))(?:e[+-]?\d+)?(?![\w.])")
UNSIGNED = re.compile(r"(?<![\w.])(\d+)u\b")
CALL = re.compile(r"\b(?!if\b|for\b|while\b|switch\b|return\b|vec[234]\b|uvec[234]\b|ivec[234]\b|bvec[234]\b|dot\b|max\b|min\b)[a-z]\w*(?=\()")
# `x = ...;`, `x.y += ...;` or a call, alone, or behind a condition
STATEMENT = re.compile(r"(?<=[;{}\)] |[;{}\)]\n)[ \t]*(?:[A-Za-z_][\w.\[\]]*(?: [-+*/|&^]?=(?!=) |\()[^;{}]*;)")


def sites_of(file, text):
    code = masked(text)
    sites = []
    for kind, rules in OPERATORS.items():
        for pattern, replacement in rules:
            sites += [Site(file, kind, m.start(), m.end(), replacement) for m in re.finditer(pattern, code)]
    for m in FLOAT.finditer(code):
        value = float(m.group(0))
        sites.append(Site(file, "constant", m.start(), m.end(), repr(value * 1.001) if value else "0.001"))
    for m in UNSIGNED.finditer(code):
        sites.append(Site(file, "index", m.start(1), m.end(1), str(int(m.group(1)) + 1)))
    for m in CALL.finditer(code):
        spans = arguments(code, m.end())
        # A declaration has types, and is no call.
        if len(spans) < 2 or re.match(r"(?:in |out |inout |const )?\w+ \w+\s*$", code[slice(*spans[0])].strip() + " "):
            continue
        (a, b), (c, d) = spans[0], spans[1]
        first, second = text[a:b].strip(), text[c:d].strip()
        if first != second:
            sites.append(Site(file, "arguments", a, d, f"{second}, {first}"))
    for m in STATEMENT.finditer(code):
        sites.append(Site(file, "statement", m.start(), m.end(), ";"))
    return sites


def broken(text, site):
    return text[:site.start] + site.replacement + text[site.end:]
