#!/usr/bin/env python3
"""Fails on a page, section, case or file that is cited and does not exist.

    check_citations.py REPOSITORY     checks every page and every comment
    check_citations.py --self-test    checks that each kind of fault is found

Checked are: links and images of Markdown pages, with their anchors; repository paths in backquotes on pages; paths of pages, sources and
scenes in comments of code; tests (Suite.WhatHolds, Suite.*) in backquotes on pages; section numbers of docs/design/numerics.md and cases (T01 ...) of tests/stability/cases.md; pages in docs/ that no other page links to.
"""
import fnmatch
import os
import pathlib
import re
import subprocess
import sys
import tempfile

CODE_FOLDERS = ("src", "shaders", "tests", "tools", "bench", "cmake", "scenes")
CODE_SUFFIXES = (".h", ".cpp", ".glsl", ".comp", ".py", ".cmake", ".json", ".txt", ".sh", "")
ROOT_PAGES = ("README.md", "CONTRIBUTING.md", "SECURITY.md", "CHANGELOG.md")
NUMERICS = "docs/design/numerics.md"
CASES = "tests/stability/cases.md"
SOURCE_PATH = re.compile(r"(?<![\w/.<>-])((?:docs|src|shaders|tests|tools|bench|cmake|scenes)/[\w./-]*\w)(#[\w-]+)?")

TEST_NAME = re.compile(r"([A-Z]\w*[a-z]\w*)\.([A-Z]\w*\*?|\*)")


def tracked(root):
    """Files that git tracks or would add; without a repository, every file."""
    done = subprocess.run(["git", "-C", str(root), "ls-files", "--cached", "--others", "--exclude-standard"], capture_output=True, text=True)
    if done.returncode == 0 and done.stdout:
        names = [pathlib.PurePosixPath(name) for name in done.stdout.splitlines()]
        return [name for name in names if (root / name).is_file()]
    return [pathlib.PurePosixPath(p.relative_to(root).as_posix()) for p in root.rglob("*") if p.is_file()]


def slugs(text):
    """Anchors that GitHub gives the headings of a page."""
    found, seen = set(), {}
    for heading in re.findall(r"(?m)^#{1,6} +(.*?) *#*$", re.sub(r"(?ms)^```.*?^```", "", text)):
        heading = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
        slug = re.sub(r"[^\w\- ]", "", re.sub(r"[`*]", "", heading).strip().lower()).replace(" ", "-")
        number = seen.get(slug, 0)
        seen[slug] = number + 1
        found.add(slug if number == 0 else f"{slug}-{number}")
    return found


SLASHES = re.compile(r"^[ \t]*/\*.*?\*/|(?:^|(?<=[\s;{},)]))//[^\n]*", re.M | re.S)
HASHES = r"(?<!\S)#[^\n]*"
# By the suffix of a file; scripts without a suffix and all other files have only #.
COMMENTS = {".py": re.compile(r'""".*?"""|' + HASHES, re.S), **dict.fromkeys((".h", ".cpp", ".glsl", ".comp", ".json"), SLASHES)}


def comments(path, text):
    """(line number, text) of each comment line."""
    for comment in re.finditer(COMMENTS.get(path.suffix, HASHES), text):
        yield from enumerate(comment[0].lstrip("/#").split("\n"), text.count("\n", 0, comment.start()) + 1)


class Checker:
    def __init__(self, root):
        self.root = root
        self.files = tracked(root)
        self.faults = []
        self.pages = {str(f): (root / f).read_text() for f in self.files
                      if f.suffix == ".md" and (f.parts[0] == "docs" or str(f) in (*ROOT_PAGES, CASES))}
        self.anchors = {name: slugs(text) for name, text in self.pages.items()}
        numerics = self.pages.get(NUMERICS, "")
        self.sections = set(re.findall(r"(?m)^#+ (\d+(?:\.\d+)?)\.? ", numerics))
        self.cases = set(re.findall(r"(?m)^\| (T\d\d) \|", self.pages.get(CASES, "")))

        self.tests = {f"{suite}.{name}" for f in self.files if f.parts[0] == "tests" and f.suffix == ".cpp" for suite, name in
                      re.findall(r"\bTEST(?:_[FP])?\(\s*(\w+),\s*(\w+)\s*\)", (root / f).read_text(errors="replace"))}

    def fault(self, where, what):
        self.faults.append(f"{where}: {what}")

    def exists(self, name):
        name = name.rstrip("/")
        if name.startswith("src/pbrt/") or re.search(r"\b[A-Z]{3,}\b", name):  # another program's sources; a placeholder
            return True
        if any(c in name for c in "*<>{}") or name.endswith("..."):
            return bool(list(self.root.glob(re.sub(r"<[^>]*>|\{[^}]*\}", "*", name)))) if "*" in name else True
        return (self.root / name).exists()

    def check_path(self, where, name, anchor):
        if not self.exists(name):
            self.fault(where, f"{name} does not exist")
        elif anchor and anchor[1:] not in self.anchors.get(name, ()):
            self.fault(where, f"{name} has no section {anchor}")

    def check_numerics(self, where, text):
        for number in re.findall(re.escape(NUMERICS) + r",? (?:section )?(\d+(?:\.\d+)?)(?![\d.]*e)", text):
            if number not in self.sections:
                self.fault(where, f"{NUMERICS} has no section {number}")
        for case in re.findall(r"\b(T\d\d)\b", text):
            if case not in self.cases:
                self.fault(where, f"{CASES} has no case {case}")

    def check_page(self, name, text):
        folder = pathlib.PurePosixPath(name).parent
        prose = re.sub(r"(?ms)^```.*?^```[ \t]*$", lambda m: "\n" * m[0].count("\n"), text)
        linked = set()
        for number, line in enumerate(prose.split("\n"), 1):
            where = f"{name}:{number}"
            for target in re.findall(r"\]\(([^)\s]+)\)", line):
                if re.match(r"[a-z]+:", target):
                    continue
                path, _, anchor = target.partition("#")
                full = pathlib.PurePosixPath(os.path.normpath(folder / path) if path else name)
                if not (self.root / full).exists():
                    self.fault(where, f"{target} does not exist")
                    continue
                linked.add(str(full))
                if anchor and str(full) in self.anchors and anchor not in self.anchors[str(full)]:
                    self.fault(where, f"{target}: no such section")
            for quoted in re.findall(r"`([^`]+)`", line):
                match = SOURCE_PATH.fullmatch(quoted)
                if match:
                    self.check_path(where, match[1], match[2])
                match = TEST_NAME.fullmatch(quoted)
                if match and quoted != "Suite.WhatHolds" and not any(fnmatch.fnmatchcase(test, quoted) for test in self.tests):
                    self.fault(where, f"no test {quoted}")
            if name not in (NUMERICS, CASES):
                self.check_numerics(where, line)
        return linked

    def check_code(self, path):
        text = (self.root / path).read_text(errors="replace")
        for number, line in enumerate(text.split("\n"), 1):
            for name, anchor in re.findall(r"(?<![\w/.-])(docs/[\w./-]*\w\.md)(#[\w-]+)?", line):
                self.check_path(f"{path}:{number}", name, anchor)
        before = ""  # a citation may continue in the next line
        for number, comment in comments(path, text):
            where = f"{path}:{number}"
            for name, _ in SOURCE_PATH.findall(comment):
                if not name.startswith("docs/") and "." in name.rsplit("/", 1)[-1]:
                    self.check_path(where, name, "")
            for name in re.findall(r"(?<![\w/.*-])([\w-]+\.md)\b", comment):
                if not self.exists(name):
                    self.fault(where, f"{name} does not exist (pages are cited from the top: docs/...)")
            if re.search(r"\bNUMERICS\b", comment):
                self.fault(where, f"no file NUMERICS: cite {NUMERICS} and its section or case")
            self.check_numerics(where, before + " " + comment.strip() if before.endswith(NUMERICS) else comment)
            before = comment.rstrip()

    def run(self):
        linked = {"README.md"}
        for name, text in self.pages.items():
            linked |= self.check_page(name, text)
        for name in self.pages:
            if name not in linked and name.startswith("docs/"):
                self.fault(name, "no page links here")
        for path in self.files:
            code = path.parts[0] in CODE_FOLDERS or path.name == "CMakeLists.txt"
            if code and path.suffix in CODE_SUFFIXES and path.name != "check_citations.py":
                self.check_code(path)
        return self.faults


GOOD = {
    "README.md": "# A\n[page](docs/page.md#two-words) `src/a.cpp` `Balls.Are` `Balls.*`\n",
    "tests/a_test.cpp": "TEST_F(Balls,\n       Are) {}\n",
    "docs/page.md": "# Page\n## Two `words`\n[numbers](design/numerics.md)\n```sh\n[no link](nowhere.md)\n```\n",
    "docs/design/numerics.md": "# N\n## 2. Bounds\n### 2.3 Boxes\n",
    "tests/stability/cases.md": "| T01 | a |\n",
    "src/a.cpp": "// docs/design/numerics.md 2.3, T01 and docs/page.md#page; src/a.cpp\nint a;  // see docs/design/numerics.md\n// T01\n",
}
BAD = {
    "a link to no page": ("README.md", "[x](docs/gone.md)", "docs/gone.md"),
    "a link to no section": ("README.md", "[x](docs/page.md#gone)", "no such section"),
    "a picture that is not there": ("docs/page.md", "![x](images/gone.png)", "images/gone.png"),
    "a source in backquotes": ("docs/page.md", "`src/gone.cpp`", "src/gone.cpp"),
    "a test": ("README.md", "`Balls.AreGone`", "no test Balls.AreGone"),
    "a suite": ("README.md", "`Gone.*`", "no test Gone.*"),
    "a page that nobody links": ("docs/lonely.md", "# Lonely", "no page links here"),
    "a page in a comment": ("src/b.cpp", "// docs/gone.md", "docs/gone.md"),
    "a page without its folder": ("src/b.cpp", "// gone.md", "gone.md"),
    "a section of numerics": ("src/b.cpp", "// docs/design/numerics.md 2.4", "no section 2.4"),
    "a section in the next line": ("src/b.cpp", "// docs/design/numerics.md\n// 7", "no section 7"),
    "a case": ("src/b.cpp", "int b;  // T02", "no case T02"),
    "a source in a comment": ("src/b.cpp", "// src/gone.h", "src/gone.h"),
    "a scene in a comment": ("tests/c.cmake", "# scenes/gone.json", "scenes/gone.json"),
    "a docstring": ("tools/d.py", '"""Writes docs/gone.md."""', "docs/gone.md"),
    "the file that never was": ("src/b.cpp", "// NUMERICS section 1", "no file NUMERICS"),
}


def faults_of(files):
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name, text in files.items():
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text)
        return Checker(root).run()


def self_test():
    failed = [f"faults in a tree without any: {faults}"] if (faults := faults_of(GOOD)) else []
    for kind, (name, text, expected) in BAD.items():
        faults = faults_of({**GOOD, name: GOOD.get(name, "") + text + "\n"})
        if len(faults) != 1 or expected not in faults[0]:
            failed.append(f"{kind}: expected one fault with '{expected}', found {faults}")
    return failed


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__.strip())
    faults = self_test() if sys.argv[1] == "--self-test" else Checker(pathlib.Path(sys.argv[1])).run()
    for fault in faults:
        print(fault)
    sys.exit(1 if faults else 0)


main()
