"""Which sites are drawn, and how they are named in results: by file and text, so that an edit elsewhere changes nothing."""
import collections
import hashlib
import json
import re

import breaks
from kernels import LEFT_OUT, SHADERS


# Lines that count rays and tests, which are in no image.
COUNTS = re.compile(r"MODE_TALLY|MODE_COST|\.cost\b")


def describe(site, text):
    line = text.count("\n", 0, site.start)
    lines = text.splitlines()
    within = lines[line].strip()
    column = site.start - sum(len(l) + 1 for l in lines[:line]) - (len(lines[line]) - len(lines[line].lstrip()))
    nth = sum(l.strip() == within for l in lines[:line])
    return {"file": site.file, "line": line + 1, "kind": site.kind, "was": " ".join(text[site.start:site.end].split()),
            "is": " ".join(site.replacement.split()), "column": column, "nth": nth, "within": within}


def key(result):
    return tuple(result[k] for k in ("file", "within", "nth", "column", "kind", "is"))


def all_sites():
    """Sites of all files by key, each with its description."""
    found = {}
    for file in sorted(str(f.relative_to(SHADERS)) for f in SHADERS.rglob("*") if f.suffix in (".glsl", ".comp")):
        if file in LEFT_OUT:
            continue
        text = (SHADERS / file).read_text()
        for site in breaks.sites_of(file, text):
            description = describe(site, text)
            if not COUNTS.search(description["within"]):
                found[key(description)] = (site, description)
    return found


def draw(seed, count, files=None):
    """`count` sites, of `files` alone or of all, kinds in turns, so that each has its share. A site's place in its kind is a hash of the seed
    and its name."""
    kinds = collections.defaultdict(list)
    for name, (site, description) in all_sites().items():
        if files and site.file not in files:
            continue
        kinds[site.kind].append((hashlib.sha256(json.dumps([seed, *name]).encode()).digest(), site, description))
    for sites in kinds.values():
        sites.sort(key=lambda entry: entry[0], reverse=True)
    drawn = []
    while len(drawn) < count and any(kinds.values()):
        for kind in sorted(kinds):
            if kinds[kind]:
                drawn.append(kinds[kind].pop()[1:])
    return drawn[:count]
