#!/usr/bin/env python3
"""Measures the price of rendering an image in parts, and how equal the parts are, in processor seconds.

    bench/farm.py [--glint build/bin/glint] [--parts 8] SCENE...

For each scene: the image at once, its parts one after the other, and `glint merge`; medians of three rounds.
"""
import argparse
import json
import pathlib
import resource
import statistics
import subprocess
import tempfile

ROUNDS = 3


def processor_seconds(command):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, done.stdout


def measure(glint, scene, parts, options):
    with tempfile.TemporaryDirectory() as folder:
        whole, drawn, merged = [], [[] for _ in range(parts)], []
        files = [f"{folder}/{k}.part" for k in range(1, parts + 1)]
        render = [glint, "render", scene, *options, "--stats", "json"]
        for _ in range(ROUNDS):
            seconds, out = processor_seconds([*render, "-o", f"{folder}/whole.exr"])
            whole.append(seconds)
            for k, file in enumerate(files):
                drawn[k].append(processor_seconds([*render, "--part", f"{k + 1}/{parts}", "-o", file])[0])
            seconds, merge = processor_seconds([glint, "merge", *files, "-o", f"{folder}/all.exr", "--stats", "json"])
            merged.append(seconds)
            if json.loads(out)["hash"] != json.loads(merge)["hash"]:
                raise SystemExit(f"{scene}: the merged picture has other bits")
        start = processor_seconds([*render, "--crop", "0,0,8,8", "-o", f"{folder}/start.exr"])[0]
    each = [statistics.median(times) for times in drawn]
    return statistics.median(whole), each, statistics.median(merged), start


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--glint", default="build/bin/glint")
    parser.add_argument("--parts", type=int, default=8)
    parser.add_argument("--size", default="1280x960")
    parser.add_argument("--spp", default="1")
    parser.add_argument("scenes", nargs="+")
    arguments = parser.parse_args()
    lines = [f"| {arguments.size}, {arguments.spp} samples, {arguments.parts} parts | at once | all parts | to start one | merging | parts of once, "
             "starts aside | dearest part of the mean |", "|---|---|---|---|---|---|---|"]
    for scene in arguments.scenes:
        options = ["--size", arguments.size, "--spp", arguments.spp]
        whole, each, merge, start = measure(arguments.glint, scene, arguments.parts, options)
        work = [seconds - start for seconds in each]
        lines.append(f"| {pathlib.Path(scene).stem} | {whole:.2f} | {sum(each):.2f} | {start:.2f} | {merge:.2f} | "
                     f"{sum(work) / (whole - start):.3f} | {max(work) / statistics.mean(work):.2f} |")
    print("\n".join(lines))


main()
