#!/usr/bin/env python3
"""Kills one of several processes of --join at a random moment, again and again: the picture must have the bits of one that nobody killed.

    bench/farm_trials.py [--glint build/bin/glint] [--trials 100] [--workers 5] [--signal KILL|STOP] [--lease 1] SCENE [options of render]

Prints how many pictures were complete and equal, and the time against a run without a death: the median and the worst of the trials.
A process that was stopped is left stopped until the picture is there, and must then end well.
"""
import argparse
import pathlib
import random
import signal
import statistics
import subprocess
import tempfile
import time


def run(glint, arguments, folder, victim_signal, after):
    """Seconds until the picture was there; whether all other processes ended well."""
    command = [glint, "render", arguments.scene, *arguments.options, "--join", f"{folder}/farm", "--lease", str(arguments.lease),
               "-o", f"{folder}/all.pfm", "-q"]
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
    return seconds, well


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--glint", default="build/bin/glint")
    parser.add_argument("--trials", type=int, default=100)
    parser.add_argument("--workers", type=int, default=5)
    parser.add_argument("--signal", choices=["KILL", "STOP"], default="KILL")
    parser.add_argument("--lease", type=float, default=1)
    parser.add_argument("scene")
    parser.add_argument("options", nargs=argparse.REMAINDER)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([arguments.glint, "render", arguments.scene, *arguments.options, "-o", f"{folder}/whole.pfm", "-q"], check=True)
        whole = pathlib.Path(f"{folder}/whole.pfm").read_bytes()
    undisturbed = []
    for _ in range(5):
        with tempfile.TemporaryDirectory() as folder:
            undisturbed.append(run(arguments.glint, arguments, folder, None, 0)[0])
    plain = statistics.median(undisturbed)
    good, times = 0, []
    for _ in range(arguments.trials):
        with tempfile.TemporaryDirectory() as folder:
            number = getattr(signal, "SIG" + arguments.signal)
            seconds, well = run(arguments.glint, arguments, folder, number, random.uniform(0, plain))
            times.append(seconds)
            good += well and pathlib.Path(f"{folder}/all.pfm").read_bytes() == whole
    print(f"{good} of {arguments.trials} pictures complete and equal; {plain:.2f} s without a death, "
          f"median {statistics.median(times):.2f} s, worst {max(times):.2f} s with one")
    raise SystemExit(good != arguments.trials)


main()
