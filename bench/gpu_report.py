"""Writes the results of bench/gpu as a page and as JSON."""
import json
import re
import time

import gpu_parts
import measure

TITLES = {"devices": "Devices", "hashes": "Hashes of images", "verify": "Against the reference", "tests": "Tests", "traversals": "Ways to find hits",
          "forms": "Forms of kernels"}


def slug(name):
    """llvmpipe of "llvmpipe (LLVM 15.0.6, 256 bits)"."""
    return re.sub(r"[^a-z0-9]+", "-", name.split("(")[0].lower()).strip("-") or "device"


def cell(value):
    return str(value).replace("|", "\\|").replace("\n", " ")


def page(bench):
    info, spent = bench.info, time.monotonic() - bench.start
    text = f"# {info['name']}\n\n**What this page answers:** does glint work on this device, and how fast is it there?\n\n"
    text += f"Written by `bench/gpu`, in {spent:.0f} of {bench.seconds:.0f} seconds"
    text += ", **interrupted**.\n\n" if bench.interrupted else ".\n\n"
    busy = bench.load > 0.3
    facts = [("device", info["name"]), ("driver", info["about"]), ("arithmetic", info["arithmetic"]), ("host", gpu_parts.machine()),
             ("load before it began", f"{bench.load:.1f}" + (": **busy with other work**, so times are too long" if busy else "")), ("glint", info["version"])]
    text += measure.table(["", ""], [[name, cell(value)] for name, value in facts if value]) + "\n"
    rows = [[TITLES[part.name], cell(part.outcome), f"{part.seconds:.0f} s"] for part in bench.parts]
    rows += [[TITLES[name], "not begun: interrupted", ""] for name in bench.not_begun]
    text += measure.table(["part", "result", "took"], rows)
    for part in bench.parts:
        if not (part.rows or part.failures or part.left_out):
            continue
        text += f"\n## {TITLES[part.name]}\n"
        if part.rows:
            text += "\n" + measure.table(part.header, [list(map(cell, row)) for row in part.rows])
        if part.notes:
            text += "\n" + " ".join(part.notes) + "\n"
        if part.failures:
            text += "\nFailed:\n\n" + "".join(f"- {cell(item)}\n" for item in part.failures)
        if part.left_out:
            text += "\nLeft out, as no time was left or as it says: " + ", ".join(map(cell, part.left_out)) + ".\n"
    text += "\nThe driver's own ray tracing (`VK_KHR_ray_query`) is not measured beside: see [the list of devices](README.md).\n"
    return text


def document(bench):
    return {"device": bench.info, "host": gpu_parts.machine(), "load": bench.load, "budget": bench.seconds, "seconds": round(time.monotonic() - bench.start, 1),
            "interrupted": bench.interrupted, "notBegun": list(bench.not_begun),
            "parts": [{"name": part.name, "outcome": part.outcome, "failed": part.failed, "seconds": round(part.seconds, 2), "failures": part.failures,
                       "leftOut": part.left_out, "header": part.header, "rows": part.rows} for part in bench.parts]}


def write(bench, folder):
    """Writes both files; the page's path."""
    folder.mkdir(parents=True, exist_ok=True)
    if not bench.info:
        bench.info = {"name": "no device", "about": "", "arithmetic": "", "processor": True, "version": ""}
    path = folder / (slug(bench.info["name"]) + ".md")
    # First beside, so that whoever interrupts twice keeps what there was.
    for file, text in ((path, page(bench)), (path.with_suffix(".json"), json.dumps(document(bench), indent=1) + "\n")):
        new = file.with_name(file.name + ".new")
        new.write_text(text)
        new.replace(file)
    return path
