#!/usr/bin/env python3
"""What many machines would make of one picture: the hand-out of src/farm/hand_out.cpp, played through with workers that vary, die and hang.

    bench/farm_simulation.py --rates rates.json [--workers 10,100,1000,10000] [--pixels P] [--samples S] [--units N] [--seed 1] [--check]

`rates.json` comes from bench/farm_rates.py. What cannot be measured on one machine is assumed, and an option each: the network, how much
units and machines differ, and how often machines die. The same seed gives the same table.

Efficiency is the work of the picture, in worker seconds, over workers times the time from the command to the file. --check exits with 1 if a
picture is not complete, or has a unit twice.
"""
import argparse
import heapq
import json
import math
import random


class Farm:
    """One picture. Times in seconds; worker 0 is rank 0, which draws too."""

    def __init__(self, options, workers, units, unit_seconds, start, result_seconds, deaths, seed):
        self.o, self.workers, self.units, self.start, self.result_seconds = options, workers, units, start, result_seconds
        self.random = random.Random(seed)
        self.cost = [unit_seconds * self.random.lognormvariate(-self.o.spread ** 2 / 2, self.o.spread) for _ in range(units)]
        self.speed = [self.random.lognormvariate(0, self.o.machines) for _ in range(workers)]
        self.done, self.holders, self.free = [False] * units, [dict() for _ in range(units)], list(range(units))
        heapq.heapify(self.free)
        self.outstanding = []  # (since, unit, worker), some of them out of date
        self.finished, self.sum, self.twice, self.duplicates = 0, 0.0, 0, 0
        self.idle, self.events, self.count, self.look = [], [], 0, None
        self.dies = {}
        span = units * unit_seconds / workers
        for worker in self.random.sample(range(1, workers), min(deaths, workers - 1)):
            self.dies[worker] = start + self.random.uniform(0, span)

    def at(self, time, kind, *what):
        self.count += 1
        heapq.heappush(self.events, (time, self.count, kind, what))

    def pick(self, worker, now):
        """HandOut::next."""
        if self.free:
            return heapq.heappop(self.free)
        if self.finished == 0:
            return None
        patience = 3 * self.sum / self.finished
        while self.outstanding:
            since, unit, who = self.outstanding[0]
            if self.done[unit] or len(self.holders[unit]) != 1 or self.holders[unit].get(who) != since:
                heapq.heappop(self.outstanding)
                continue
            if since > now - patience:
                if self.look is None or since + patience < self.look:
                    self.look = since + patience + 1e-9
                    self.at(self.look, "look")
                return None
            heapq.heappop(self.outstanding)
            if who == worker:
                continue
            self.duplicates += 1
            return unit
        return None

    def ask(self, worker, now):
        unit = self.pick(worker, now)
        if unit is None:
            self.idle.append(worker)
            return
        self.holders[unit][worker] = now
        heapq.heappush(self.outstanding, (now, unit, worker))
        seconds = self.cost[unit] * self.speed[worker] * self.random.lognormvariate(0, self.o.noise)
        end = now + self.o.latency + seconds
        if self.dies.get(worker, math.inf) <= end:
            self.at(max(now, self.dies[worker]) + self.o.lease, "lost", worker)
        else:
            self.at(end + self.o.latency, "result", worker, unit)

    def wake(self, now):
        waiting, self.idle = self.idle, []
        for place, worker in enumerate(waiting):
            before = len(self.idle)
            if self.dies.get(worker, math.inf) > now:
                self.ask(worker, now)
            if len(self.idle) > before:  # there is nothing for the others either
                self.idle += waiting[place + 1:]
                return

    def run(self):
        """When the file is there."""
        for worker in range(self.workers):
            self.at(self.start * self.random.uniform(1, 1 + self.o.startup), "ready", worker)
        written = 0.0
        while self.finished < self.units:
            now, _, kind, what = heapq.heappop(self.events)
            if kind == "ready":
                if self.dies.get(what[0], math.inf) > now:
                    self.ask(what[0], now)
            elif kind == "lost":
                for unit in [u for u in range(self.units) if what[0] in self.holders[u]]:
                    del self.holders[unit][what[0]]
                    if not self.holders[unit] and not self.done[unit]:
                        heapq.heappush(self.free, unit)
                self.wake(now)
            elif kind == "look":
                self.look = None if self.look is None or self.look <= now else self.look
                self.wake(now)
            else:
                worker, unit = what
                if not self.done[unit]:
                    self.done[unit] = True
                    self.finished += 1
                    self.sum += now - self.holders[unit].get(worker, now)
                    written = max(written, now) + self.result_seconds
                    self.holders[unit] = {}
                else:
                    self.twice += 1
                self.ask(worker, now)
        return written


def broadcast(options, workers):
    """Down a tree of two branches, in pieces of 1 MiB, each of which a rank hands on twice."""
    piece = min(options.scene_bytes, 2 ** 20)
    depth = math.ceil(math.log2(workers + 1)) - 1 if workers > 1 else 0
    return 2 * options.scene_bytes / options.network + depth * (2 * piece / options.network + options.latency) if workers > 1 else 0


def simulate(options, rates, workers, units_each, deaths):
    pixels = options.pixels
    work = rates["draw"] * options.samples / rates["samples"] * pixels / rates["pixels"]
    units = options.units or min(max(units_each * workers, 16), 2 ** 20)
    spread_over = broadcast(options, workers)
    result = rates["merge"] / rates["pixels"] * pixels / units
    farm = Farm(options, workers, units, work / units, rates["start"] + spread_over, result, deaths, options.seed)
    seconds = farm.run()
    bad = farm.finished != units or not all(farm.done)
    return {"workers": workers, "units": units, "unit": work / units, "broadcast": spread_over, "writer": result * units / seconds,
            "seconds": seconds, "efficiency": work / (workers * seconds), "twice": farm.duplicates / units, "bad": bad}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--rates", required=True)
    parser.add_argument("--workers", default="10,100,1000,10000")
    parser.add_argument("--pixels", type=int, default=2 ** 28, help="of the picture (default: 16,384 x 16,384)")
    parser.add_argument("--samples", type=int, default=256, help="of a pixel")
    parser.add_argument("--scene-bytes", type=float, default=1e9)
    parser.add_argument("--network", type=float, default=1.25e9, help="bytes a second out of one machine")
    parser.add_argument("--latency", type=float, default=0.004, help="seconds of a message, with the time until somebody looks for it")
    parser.add_argument("--spread", type=float, default=0.3, help="of units, as they are estimated: sigma of the logarithm")
    parser.add_argument("--machines", type=float, default=0.1, help="of the speeds of machines")
    parser.add_argument("--noise", type=float, default=0.05, help="of the same work on the same machine")
    parser.add_argument("--startup", type=float, default=0.5, help="how much longer the last worker takes to start")
    parser.add_argument("--units", type=int, help="in all, whatever the number of workers (default: 2, 8 and 32 for each)")
    parser.add_argument("--lease", type=float, default=15)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    rates = json.load(open(options.rates))
    work = rates["draw"] * options.samples / rates["samples"] * options.pixels / rates["pixels"]
    print(f"{options.pixels:,} pixels, {options.samples} samples each: {work / 3600:.1f} hours of work for one worker; the writer alone takes "
          f"{rates['merge'] * options.pixels / rates['pixels']:.0f} s\n")
    print("| workers | units each | seconds of a unit | deaths | broadcast, s | picture, s | efficiency | writer busy | units drawn twice |\n"
          "|---|---|---|---|---|---|---|---|---|")
    bad = False
    for workers in map(int, options.workers.split(",")):
        for units_each, deaths in [(options.units / workers, 0)] if options.units else [(2, 0), (8, 0), (8, workers // 100), (32, 0)]:
            r = simulate(options, rates, workers, units_each, deaths)
            bad = bad or r["bad"]
            print(f"| {workers:,} | {units_each:.3g} | {r['unit']:.1f} | {deaths} | {r['broadcast']:.1f} | {r['seconds']:,.0f} | {r['efficiency']:.2f} | "
                  f"{r['writer']:.2f} | {r['twice']:.3f} |", flush=True)
    raise SystemExit(bad and options.check)


main()
