#!/usr/bin/env python3
"""Kills one of several processes of --join at a random moment, again and again: the picture must have the bits of one that nobody killed.

    bench/farm_trials.py [--glint build/bin/glint] [--trials 100] [--workers 5] [--signal KILL|STOP] [--lease 1] [--log FILE] SCENE [options of render]

Each trial stands between two runs without a death, and is compared with the mean of the two, so that whatever else the machine does
disturbs both alike. Prints how many pictures were complete and equal, and the ratios of elapsed and of processor time. A process that was
stopped is left stopped until the picture is there, and must then end well. With --log each trial is a line of FILE.
"""
import argparse
import os
import pathlib
import random
import resource
import signal
import statistics
import subprocess
import tempfile
import time


def processor_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def run(arguments, folder, victim_signal=None, after=0):
    """Seconds until the picture was there, processor seconds of all processes, and whether all but the victim ended well."""
    command = [arguments.glint, "render", arguments.scene, *arguments.options, "--join", f"{folder}/farm", "--lease", str(arguments.lease),
               "-o", f"{folder}/all.pfm", "-q"]
    before = processor_seconds()
    begin = time.monotonic()
    workers = [subprocess.Popen(command, stderr=subprocess.PIPE) for _ in range(arguments.workers)]
    victim = workers[0]
    if victim_signal:
        time.sleep(after)
        victim.send_signal(victim_signal)
    well = all(worker.wait() == 0 for worker in workers[1:])
    seconds = time.monotonic() - begin
    if victim_signal == signal.SIGSTOP:
        victim.send_signal(signal.SIGCONT)
    code = victim.wait()
    if victim_signal != signal.SIGKILL:
        well = well and code == 0
    return seconds, processor_seconds() - before, well


def drawn(arguments, whole, **options):
    """Seconds, processor seconds, and whether the picture is complete and equal."""
    with tempfile.TemporaryDirectory() as folder:
        seconds, processor, well = run(arguments, folder, **options)
        path = pathlib.Path(f"{folder}/all.pfm")
        return seconds, processor, well and path.exists() and path.read_bytes() == whole


def ratios(name, values):
    values = sorted(values)
    print(f"{name}: median {statistics.median(values):.2f}, nine of ten up to {values[int(0.9 * (len(values) - 1))]:.2f}, worst {values[-1]:.2f}; "
          f"{sum(value <= 1.25 for value in values)} of {len(values)} up to 1.25")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--glint", default="build/bin/glint")
    parser.add_argument("--trials", type=int, default=100)
    parser.add_argument("--workers", type=int, default=5)
    parser.add_argument("--signal", choices=["KILL", "STOP"], default="KILL")
    parser.add_argument("--lease", type=float, default=1)
    parser.add_argument("--log")
    parser.add_argument("scene")
    parser.add_argument("options", nargs=argparse.REMAINDER)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([arguments.glint, "render", arguments.scene, *arguments.options, "-o", f"{folder}/whole.pfm", "-q"], check=True)
        whole = pathlib.Path(f"{folder}/whole.pfm").read_bytes()
    number = getattr(signal, "SIG" + arguments.signal)
    plain = [drawn(arguments, whole)]
    hit = []
    for trial in range(arguments.trials):
        hit.append(drawn(arguments, whole, victim_signal=number, after=random.uniform(0, plain[-1][0])))
        plain.append(drawn(arguments, whole))
        if arguments.log:
            with open(arguments.log, "a", encoding="utf-8") as log:
                log.write(f"{trial + 1}: {plain[-2]}, {hit[-1]}, {plain[-1]}, load {os.getloadavg()[0]:.1f}\n")
    good = sum(equal for *_, equal in hit)
    print(f"{good} of {arguments.trials} pictures with a death complete and equal, {sum(equal for *_, equal in plain)} of {len(plain)} without; "
          f"{statistics.median(p[0] for p in plain):.2f} s without, {statistics.median(h[0] for h in hit):.2f} s with one (medians)")
    for name, i in (("elapsed", 0), ("processor", 1)):
        ratios(name, [2 * h[i] / (a[i] + b[i]) for a, h, b in zip(plain, hit, plain[1:])])
    raise SystemExit(good != arguments.trials)


main()
