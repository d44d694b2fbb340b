#!/usr/bin/env python3
"""Measures the price of rendering by MPI on one machine: `mpirun -n 2` with one driver thread each against one process with two.

    bench/farm_mpi.py [--glint build/bin/glint] [--repeats 5] [--size 1600x1200] [--spp 4] [--ranks 2] SCENE...

Runs alternate, so that other load disturbs both alike. Wall time and processor seconds run from the start of the command to its end, mpirun
included. The images' bits are compared.
"""
import argparse
import os
import pathlib
import resource
import statistics
import subprocess
import tempfile
import time


def measured(command, environment):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    begin = time.monotonic()
    subprocess.run(command, check=True, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    wall = time.monotonic() - begin
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--glint", default="build/bin/glint")
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--size", default="1600x1200")
    parser.add_argument("--spp", default="4")
    parser.add_argument("--ranks", type=int, default=2)
    parser.add_argument("scenes", nargs="+")
    arguments = parser.parse_args()
    base = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    threads = str(arguments.ranks)
    print(f"| {arguments.size}, {arguments.spp} samples | one process: wall, processor | {arguments.ranks} ranks: wall, processor | "
          "speed by wall | by processor |\n|---|---|---|---|---|")
    for scene in arguments.scenes:
        with tempfile.TemporaryDirectory() as folder:
            ask = [arguments.glint, "render", scene, "--size", arguments.size, "--spp", arguments.spp, "-q", "-o"]
            one, several = [*ask, f"{folder}/one.pfm"], [*ask, f"{folder}/several.pfm"]
            launch = ["mpirun", "--oversubscribe", "--bind-to", "none", "-n", threads]
            subprocess.run(one, check=True)  # kernels are compiled
            rows = [(measured(one, dict(base, LP_NUM_THREADS=threads)), measured([*launch, *several], dict(base, LP_NUM_THREADS="1")))
                    for _ in range(arguments.repeats)]
            same = pathlib.Path(f"{folder}/one.pfm").read_bytes() == pathlib.Path(f"{folder}/several.pfm").read_bytes()
            if not same:
                raise SystemExit(f"{scene}: other bits")
            a, b, c, d = (statistics.median(row[i][j] for row in rows) for i in (0, 1) for j in (0, 1))
            wall = statistics.median(row[0][0] / row[1][0] for row in rows)
            processor = statistics.median(row[0][1] / row[1][1] for row in rows)
            print(f"| {pathlib.Path(scene).stem} | {a:.1f}, {b:.1f} | {c:.1f}, {d:.1f} | {wall:.2f} | {processor:.2f} |", flush=True)


main()
