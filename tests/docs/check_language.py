#!/usr/bin/env python3
"""Fails if the language of comments or pages gets worse: more offences of a kind than LIMITS allows.

    check_language.py REPOSITORY          counts offences and compares them with LIMITS
    check_language.py REPOSITORY --list   also prints each offence with its place
    check_language.py --self-test         checks that each kind is found

Lower a limit when its count has fallen. CONTRIBUTING.md has the rules.
"""
import pathlib
import re
import subprocess
import sys

LIMITS = {
    "comment block that starts with What, Of, Where, Whether, Who, As or Since": 0,
    "sentence that starts with What, Of, Where, Whether or Who": 0,
    "sentence of more than 30 words": 0,
    "paragraph of more than 110 words": 0,
    "banned word": 0,
    "table row without a header": 0,
}
COMMENT, SENTENCE, LONG_SENTENCE, LONG_PARAGRAPH, BANNED, LOOSE_ROW = LIMITS
COMMENT_START = re.compile(r"(?:What|Of|Where|Whether|Who|Whoever|As|Since)\b")
SENTENCE_START = re.compile(r"(?:What|Of|Where|Whether|Who|Whoever)\b")
WORDS = re.compile(r"\b(?:mended|anew|whoever|nobody|dearer|walks? by (?:itself|themselves)|nodes of (?:two|four)|(?:says|tells) nothing)\b", re.I)
QUESTION = re.compile(r"\?\s*$")


def comment_blocks(text):
    """(line number, joined text) of each block of // comments."""
    block, first = [], 0
    for number, line in enumerate(text.split("\n") + [""], 1):
        match = re.match(r"\s*// ?(.*)", line)
        if match:
            first = first if block else number
            block.append(match[1])
        elif block:
            yield first, " ".join(block)
            block = []


def paragraphs(text):
    """(line number, joined text) of each paragraph of prose; no code, tables, headings or quotes."""
    text = re.sub(r"(?ms)^```.*?^```[ \t]*$", lambda m: "\n" * m[0].count("\n"), text)
    number = 1
    for part in re.split(r"(\n\s*\n)", text):
        lines = [line for line in part.split("\n") if line.strip() and not re.match(r"\s*(?:[|#<!>]|    )", line)]
        if lines:
            for item in re.split(r"\n(?=\s*(?:[-*]|\d+\.) )", "\n".join(lines)):
                yield number, " ".join(item.split())
        number += part.count("\n")


def loose_rows(text):
    """(line number, text) of each row that a blank line separates from its table."""
    lines = re.sub(r"(?ms)^```.*?^```[ \t]*$", lambda m: "\n" * m[0].count("\n"), text).split("\n")
    for number, (before, line, after) in enumerate(zip([""] + lines, lines, lines[1:] + [""]), 1):
        if line.startswith("|") and not before.startswith("|") and not re.fullmatch(r"\|[-:| ]+\|", after):
            yield number, line


def sentences(paragraph):
    plain = re.sub(r"`[^`]*`", "code", re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", paragraph))
    return [s for s in re.split(r"(?<=[.:?!]) +(?=[A-Z*`])", re.sub(r"^(?:[-*]|\d+\.) +", "", plain)) if s]


def offences_of(name, text):
    """(kind, line, excerpt) of each offence in a file."""
    if name.endswith(".md"):
        for line, row in loose_rows(text):
            yield LOOSE_ROW, line, row[:80]
        for line, paragraph in paragraphs(text):
            if len(paragraph.split()) > 110:
                yield LONG_PARAGRAPH, line, paragraph[:80]
            for sentence in sentences(paragraph):
                if SENTENCE_START.match(sentence.lstrip("*")) and not QUESTION.search(sentence.rstrip("*")):
                    yield SENTENCE, line, sentence[:80]
                if len(sentence.split()) > 30:
                    yield LONG_SENTENCE, line, sentence[:80]
            for word in WORDS.findall(paragraph):
                yield BANNED, line, word
        return
    for line, block in comment_blocks(text):
        if COMMENT_START.match(block):
            yield COMMENT, line, block[:80]
        for word in WORDS.findall(block):
            yield BANNED, line, word


def files_of(root):
    listed = subprocess.run(["git", "-C", str(root), "ls-files", "*.md", "src", "shaders", "include"], capture_output=True, text=True, check=True).stdout
    for name in listed.split("\n"):
        if name.endswith((".md", ".cpp", ".h", ".hpp", ".glsl", ".comp")) and (root / name).is_file():
            yield name, (root / name).read_text(errors="replace")


def self_test():
    cases = {
        COMMENT: ("a.h", "int a;\n// What it is.\n// More.\n"),
        SENTENCE: ("a.md", "It is so. Where it is not, it is not.\n"),
        LONG_SENTENCE: ("a.md", "A " + "word " * 31 + "ends.\n"),
        LONG_PARAGRAPH: ("a.md", "Ten words make a sentence that is short and plain. " * 12 + "\n"),
        BANNED: ("a.glsl", "// The tree is built anew.\n"),
        LOOSE_ROW: ("a.md", "| a | b |\n|---|---|\n| 1 | 2 |\n\n| 3 | 4 |\n"),
    }
    failed = [kind for kind, (name, text) in cases.items() if [found[0] for found in offences_of(name, text)] != [kind]]
    good = "Is it so? What is it?\n\n| What | Of |\n|---|---|\n\n```\nWhere x\n| y |\n```\n"
    return failed + (["a page without offences"] if list(offences_of("a.md", good)) else [])


def main():
    if sys.argv[1:] == ["--self-test"]:
        failed = self_test()
        print("\n".join(failed) or "each kind is found")
        return bool(failed)
    root = pathlib.Path(sys.argv[1])
    found = [(kind, name, line, text) for name, content in files_of(root) for kind, line, text in offences_of(name, content)]
    worse = False
    for kind, limit in LIMITS.items():
        count = sum(1 for offence in found if offence[0] == kind)
        print(f"{count:5d} of at most {limit}: {kind}")
        worse = worse or count > limit
        if "--list" in sys.argv or count > limit:
            for _, name, line, text in (offence for offence in found if offence[0] == kind):
                print(f"    {name}:{line}: {text}")
    return worse


sys.exit(main())
