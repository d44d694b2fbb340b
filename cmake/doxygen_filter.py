"""doxygen_filter.py HEADER: the header with its comments as Doxygen wants them.

The headers are written for people: a comment stands above what it tells of, or behind it on the same line. Doxygen sees neither
without its own marks, which this adds. Comments of sections ("---- ... ----") and those before #include lines stay.
"""
import pathlib
import re
import sys


def marked(text):
    lines, out, first = text.splitlines(), [], True
    for number, line in enumerate(lines):
        bare = line.strip()
        if bare.startswith(("/* ----", "// ----")):
            out.append(line)
        elif bare.startswith("/*"):
            out.append(line.replace("/*", "/** \\file\n" if first else "/**", 1))
            first = False
        elif bare.startswith("//"):
            out.append(line.replace("//", "/// \\file\n///" if first else "///", 1))
            first = False
        else:
            # Behind code; a string with two slashes stands in none of these lines.
            line = re.sub(r"(?<=\S)(\s*)/\*(?!\*)", r"\1/**<", line)
            line = re.sub(r"(?<=[;,{])(\s*)//(?!/)", r"\1///<", line)
            # What is the same everywhere is said once, in the conventions.
            line = re.sub(r"^(\s*uint64_t size;)$", r"\1 /**< sizeof of the struct: GLINT_INIT sets it */", line)
            out.append(re.sub(r"^(\s*u?int32_t reserved;)$", r"\1 /**< zero */", line))
    return "\n".join(out) + "\n"


if __name__ == "__main__":
    sys.stdout.write(marked(pathlib.Path(sys.argv[1]).read_text(encoding="utf-8")))
