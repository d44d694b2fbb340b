#!/usr/bin/env python3
"""Measures what bench/farm_simulation.py reckons with, and writes it as JSON to standard output.

    bench/farm_rates.py [--glint build/bin/glint] [--size 1600x1200] [--spp 4] [--backend gpu] SCENE > rates.json

Processor seconds, so that other work on the machine counts little: to start one process (device, scene, kernels from the cache), to draw the
whole picture beyond that, and to take a pixel into the picture and write it, which is what `glint merge` of 4 parts takes.
"""
import argparse
import json
import resource
import statistics
import subprocess
import tempfile


def seconds(command):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--glint", default="build/bin/glint")
    parser.add_argument("--size", default="1600x1200")
    parser.add_argument("--spp", default="4")
    parser.add_argument("--backend", default="gpu")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("scene")
    arguments = parser.parse_args()
    width, height = map(int, arguments.size.split("x"))

    def draw(size, *more):
        return seconds([arguments.glint, "render", arguments.scene, "--size", size, "--spp", arguments.spp, "--backend", arguments.backend,
                        "-q", *more])

    def median(work):
        return statistics.median(work() for _ in range(arguments.repeats))

    with tempfile.TemporaryDirectory() as folder:
        out = ["-o", f"{folder}/a.exr"]
        draw(arguments.size, *out)  # kernels are compiled
        start = median(lambda: draw("8x8", *out))
        whole = median(lambda: draw(arguments.size, *out)) - start
        parts = [f"{folder}/{k}.part" for k in range(1, 5)]
        for k, part in enumerate(parts, 1):
            draw(arguments.size, "--part", f"{k}/4", "-o", part)
        merge = median(lambda: seconds([arguments.glint, "merge", *parts, "-q", "-o", f"{folder}/m.exr", "--in-bands"]))
    print(json.dumps({"scene": arguments.scene, "pixels": width * height, "samples": int(arguments.spp), "start": round(start, 3),
                      "draw": round(whole, 3), "merge": round(merge, 3)}))


main()
