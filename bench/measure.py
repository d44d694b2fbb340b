"""Shared by the measuring scripts: running glint, log-log fits and diagrams."""
import argparse
import json
import math
import os
import pathlib
import platform
import re
import resource
import statistics
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
# Told apart with most kinds of colour blindness: Okabe, Ito, "Color Universal Design", 2008.
COLORS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"]


def arguments(description):
    parser = argparse.ArgumentParser(description=description.split("\n")[0])
    parser.add_argument("--glint", default=str(ROOT / "build/bin/glint"), help="the program (default: build/bin/glint)")
    parser.add_argument("--quick", action="store_true", help="few and small measurements, to see that everything runs")
    return parser


def run(command, environment=None, check=True):
    """Seconds of wall clock and of processors that the command took, its standard output and its standard error."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    start = time.perf_counter()
    done = subprocess.run([str(c) for c in command], env={**os.environ, **(environment or {})}, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    wall = time.perf_counter() - start
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if check and done.returncode != 0:
        sys.exit(f"{' '.join(str(c) for c in command)}\nended with {done.returncode}:\n{done.stderr[-2000:]}")
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, done.stdout, done.stderr


def bench(glint, *options, environment=None):
    """What `glint bench` says about one scene."""
    document = json.loads(run([glint, "bench", "--progress", "none", "--stats", "json", *options], environment)[2])
    return {**document["scenes"][0], "commit": document["commit"], "threads": document["threads"]}


def stages(summary):
    """Seconds of each stage, from what `glint render` prints. (--stats json would ask for more of the device than the picture.)"""
    line = next(line for line in summary.splitlines() if line.startswith("times:"))
    found = re.findall(r"(load|packing|upload|compile|trace|readback|write) ([0-9.]+) (ms|s)", line)
    return {name: float(value) * (1e-3 if unit == "ms" else 1) for name, value, unit in found}


def fit(points):
    """Exponent k and factor c of y = c x^k by least squares through the logarithms."""
    xs, ys = [math.log(x) for x, _ in points], [math.log(y) for _, y in points]
    mx, my = statistics.fmean(xs), statistics.fmean(ys)
    spread = sum((x - mx) ** 2 for x in xs)
    if spread == 0:
        return 0.0, math.exp(my)
    k = sum((x - mx) * (y - my) for x, y in zip(xs, ys)) / spread
    return k, math.exp(my - k * mx)


def number(value):
    """Three digits, and k, M for thousands and millions."""
    for size, suffix in ((1e9, " G"), (1e6, " M"), (1e3, " k")):
        if abs(value) >= size:
            return f"{value / size:.3g}{suffix}"
    return f"{value:.3g}"


def seconds(value):
    return f"{value * 1e3:.3g} ms" if value < 1 else f"{value:.3g} s"


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return "\n".join(lines + ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]) + "\n"


def machine(result):
    """Where figures come from, in one line."""
    model = next((line.split(":", 1)[1].strip() for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines() if line.startswith("model name")),
                 platform.machine())
    return f"{result['driver']}, {result['threads']} threads of {model}, commit {result['commit']}"


def diagram(path, title, x_name, y_name, curves):
    """Logarithmic axes; `curves`: (name, points, exponent or None). The fitted line is drawn through each."""
    width, height, left, right, top, bottom = 860, 460, 80, 600, 40, 400
    points = [p for _, series, _ in curves for p in series]
    spans = []
    for axis in (0, 1):
        low, high = (f(math.log10(p[axis]) for p in points) for f in (min, max))
        room = max(0.06 * (high - low), 0.1)
        spans.append((low - room, high + room))
    place_x = lambda v: left + (math.log10(v) - spans[0][0]) / (spans[0][1] - spans[0][0]) * (right - left)
    place_y = lambda v: bottom - (math.log10(v) - spans[1][0]) / (spans[1][1] - spans[1][0]) * (bottom - top)
    escape = lambda s: s.replace("&", "&amp;").replace("<", "&lt;")
    text = lambda x, y, anchor, s, more="": f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"{more}>{escape(s)}</text>\n'
    out = f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="12">\n'
    out += '<rect width="100%" height="100%" fill="white"/>\n' + text(left, 22, "start", title, ' font-size="15" font-weight="bold"')
    for axis, (low, high) in enumerate(spans):
        steps = (1, 2, 5) if high - low < 3 else (1,)
        for decade in range(math.floor(low), math.ceil(high) + 1):
            for step in steps:
                value = step * 10.0**decade
                if not low <= math.log10(value) <= high:
                    continue
                if axis == 0:
                    x = place_x(value)
                    out += f'<line x1="{x:.1f}" y1="{top}" x2="{x:.1f}" y2="{bottom}" stroke="#e4e4e4"/>\n' + text(x, bottom + 16, "middle", number(value))
                else:
                    y = place_y(value)
                    out += f'<line x1="{left}" y1="{y:.1f}" x2="{right}" y2="{y:.1f}" stroke="#e4e4e4"/>\n' + text(left - 6, y + 4, "end", number(value))
    out += f'<rect x="{left}" y="{top}" width="{right - left}" height="{bottom - top}" fill="none" stroke="#888"/>\n'
    out += text((left + right) / 2, bottom + 38, "middle", x_name)
    out += text(0, 0, "middle", y_name, f' transform="translate(18 {(top + bottom) / 2}) rotate(-90)"')
    for i, (name, series, exponent) in enumerate(curves):
        color = COLORS[i % len(COLORS)]
        if exponent is not None and len(series) > 1:
            k, c = fit(series)
            ends = [min(p[0] for p in series), max(p[0] for p in series)]
            spots = " ".join(f"{place_x(x):.1f},{place_y(c * x**k):.1f}" for x in ends)
            out += f'<polyline points="{spots}" fill="none" stroke="{color}" stroke-dasharray="4 3"/>\n'
        for x, y in series:
            out += f'<circle cx="{place_x(x):.1f}" cy="{place_y(y):.1f}" r="4" fill="{color}"><title>{escape(name)}: {number(x)}, {y:.4g}</title></circle>\n'
        out += f'<circle cx="{right + 20}" cy="{top + 14 + 22 * i}" r="4" fill="{color}"/>\n'
        out += text(right + 32, top + 18 + 22 * i, "start", name + ("" if exponent is None else f", exponent {exponent:.2f}"))
    path.write_text(out + "</svg>\n")
