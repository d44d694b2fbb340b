"""Kernels of shaders in which one file is broken."""
import os
import re
import shutil
import subprocess
from pathlib import Path

import breaks

SOURCE = Path(__file__).resolve().parent.parent.parent
SHADERS = SOURCE / "shaders"

# Names in KernelFolder (judge.cpp). Kernels whose names end in _any are compiled with GLINT_ANY_HIT.
KERNELS = ("generate", "intersect", "intersect_any", "light", "shade", "packet_intersect", "packet_intersect_any", "packet_light", "adapt",
           "whole")
# Files about traversal, and what every traversal does in its own way. The functions of the other files are the same for all of them: single
# rays, with a stack, judge those.
TRAVERSAL = ("traversal/stack.glsl", "traversal/stackless.glsl", "traversal/state.glsl", "traversal/lanes.glsl", "traversal/leaf.glsl",
             "traversal/ray.glsl", "storage.glsl", "primitives/robust.glsl", "light.comp",
             "shading/light.glsl", "shading/lighting.glsl", "intersect.comp", "path_rows.glsl", "shading/material.glsl", "packet/packet.glsl",
             "packet/hits.glsl", "packet_intersect.comp", "packet_light.comp", "whole.comp")
# Cases that are rendered with glint's own quotients and roots judge this file alone.
ARITHMETIC = "arithmetic.glsl"
# Shaders that verify never runs: crossing counts are for the library, the probe is for the device.
LEFT_OUT = ("closest_point.comp", "count.comp", "packet_count.comp", "traversal/count.glsl", "probe.comp")


def source_of(kernel):
    return kernel.removesuffix("_any") + ".comp"


def includes(name, seen=None):
    """All files that a shader is made of."""
    seen = set() if seen is None else seen
    if name in seen or not (SHADERS / name).exists():
        return seen
    seen.add(name)
    for included in re.findall(r'^\s*#\s*include "([^"]+)"', (SHADERS / name).read_text(), re.M):
        near = os.path.normpath(os.path.join(os.path.dirname(name), included))
        includes(near if (SHADERS / near).exists() else included, seen)
    return seen


class Compiler:
    """Kernels of a copy of the shaders in which one file at a time is broken."""

    def __init__(self, folder):
        self.folder = Path(folder)
        self.shaders = self.folder / "shaders"
        shutil.copytree(SHADERS, self.shaders)
        self.files = {kernel: includes(source_of(kernel)) for kernel in KERNELS}

    def kernels_of(self, file):
        """The kernels that verify is to judge. whole.comp stays sound with the others: verify compares its images with theirs, and a defect in
        only one of them would be found too easily."""
        if file == "whole.comp":
            return ["whole"]
        if file not in LEFT_OUT and not any(file in files for files in self.files.values()):
            raise ValueError(f"no kernel includes {file}")
        return [k for k in KERNELS if k != "whole" and file in self.files[k] and (file in TRAVERSAL or not k.startswith("packet_"))]

    def compile(self, kernel, output):
        """Without the passes of cmake/GlintShaders.cmake: the program does what they do, kernel by kernel (src/gpu/specialize.h)."""
        defines = ["-DGLINT_ANY_HIT=1"] if kernel.endswith("_any") else []
        command = ["glslangValidator", f"-I{self.shaders}", *defines, self.shaders / source_of(kernel), "--quiet", "-V", "--target-env", "vulkan1.1",
                   "-o", output]
        return subprocess.run(command, stdout=subprocess.DEVNULL, check=False).returncode == 0

    def compile_all(self, kernels, folder):
        folder.mkdir(parents=True)
        return all(self.compile(k, folder / f"{k}.spv") for k in kernels)

    def break_file(self, site):
        (self.shaders / site.file).write_text(breaks.broken((SHADERS / site.file).read_text(), site))

    def mend(self, site):
        shutil.copyfile(SHADERS / site.file, self.shaders / site.file)
