#!/usr/bin/env python3
"""Measures the time from the shell to a PNG with the driver's shader cache off, by stage, for one or two builds.

    bench/cold_start.py [--against OTHER/bin/glint] [--warm] [--repeat N] [--quick]

Ten spheres and scenes of the repository at 640x480, runs of both builds in turn, medians of N (default 7). The target is 0.3 s for the ten
spheres. About one minute on two idle cores.
"""
import pathlib
import statistics
import sys
import tempfile

import compare_povray
import measure

COLD = {"MESA_SHADER_CACHE_DISABLE": "true"}
SCENES = ["scenes/knot.json", "scenes/showcase.json", "scenes/glass.json", "scenes/instances.json"]
ALSO_WARM = ["scenes/textures.json", "scenes/textured_quadrics.json", "scenes/boxes.json", "scenes/turntable.json", "scenes/stiff/needle_fan.json"]


class Runs:
    def __init__(self, name, glint, scene, picture, warm):
        self.name, self.scene, self.environment = name, scene.stem, {} if warm else COLD
        self.command = [glint, "render", scene, "-o", picture, "--size", "32x24" if warm else "640x480", "--spp", "1", "--progress", "none"]
        self.wall, self.cpu, self.stages = [], [], []

    def once(self):
        wall, cpu, out, _ = measure.run(self.command, self.environment)
        self.wall.append(wall)
        self.cpu.append(cpu)
        self.stages.append(measure.stages(out))

    def stage(self, *names):
        return statistics.median(sum(s[name] for name in names) for s in self.stages)

    def row(self):
        wall = statistics.median(self.wall)
        stages = [self.stage("load", "packing"), self.stage("compile"), self.stage("trace"), self.stage("upload", "readback"), self.stage("write")]
        # Starting the program, opening the device, ending.
        return [self.scene, self.name, measure.seconds(wall), measure.seconds(statistics.median(self.cpu)), measure.seconds(max(wall - sum(stages), 0)),
                *map(measure.seconds, stages)]


def main():
    parser = measure.arguments(__doc__)
    parser.add_argument("--against", help="another build of the program")
    parser.add_argument("--warm", action="store_true", help="with the driver's shader cache, filled by a first run")
    parser.add_argument("--repeat", type=int, default=7)
    options = parser.parse_args()
    if options.quick:
        options.repeat = 1
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        spheres = compare_povray.scene_file("spheres", folder, folder)[0]
        scenes = [spheres] + [measure.ROOT / s for s in (SCENES + (ALSO_WARM if options.warm else []))[: 1 if options.quick else None]]
        builds = [("this build", options.glint)] + ([("other build", options.against)] if options.against else [])
        rows = []
        for scene in scenes:
            runs = [Runs(label, glint, scene, folder / f"{i}.png", options.warm) for i, (label, glint) in enumerate(builds)]
            if options.warm:
                for run in runs:
                    measure.run(run.command)
            for _ in range(options.repeat):
                for run in runs:
                    run.once()
            if len(runs) > 1 and (folder / "0.png").read_bytes() != (folder / "1.png").read_bytes():
                sys.exit(f"{scene}: the two builds draw different pictures")
            rows += [run.row() for run in runs]
    header = ["scene", "", "wall", "processors", "start, device, end", "load, pack", "compile", "trace", "upload, readback", "write"]
    print(measure.table(header, rows))


if __name__ == "__main__":
    main()
