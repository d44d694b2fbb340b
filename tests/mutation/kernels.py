"""Kernels of shaders in which one file is broken."""
import os
import re
import shutil
import subprocess
from pathlib import Path

import breaks

SOURCE = Path(__file__).resolve().parent.parent.parent
SHADERS = SOURCE / "shaders"

# name in KernelFolder (judge.cpp): source, defines
KERNELS = {
    "generate": ("generate.comp", ()),
    "intersect": ("intersect.comp", ()),
    "intersect_any": ("intersect.comp", ("GLINT_ANY_HIT=1",)),
    "light": ("light.comp", ()),
    "shade": ("shade.comp", ()),
    "packet_intersect": ("packet_intersect.comp", ()),
    "packet_intersect_any": ("packet_intersect.comp", ("GLINT_ANY_HIT=1",)),
    "packet_light": ("packet_light.comp", ()),
    "adapt": ("adapt.comp", ()),
    "whole": ("whole.comp", ()),
}
PACKET_KERNELS = ("packet_intersect", "packet_intersect_any", "packet_light")
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
        self.files = {kernel: includes(source) for kernel, (source, _) in KERNELS.items()}

    def kernels_of(self, file):
        """The kernels that verify is to judge. whole.comp stays sound with the others: verify compares its images with theirs, and a defect in
        only one of them would be found too easily."""
        if file == "whole.comp":
            return ["whole"]
        if file not in LEFT_OUT and not any(file in files for files in self.files.values()):
            raise ValueError(f"no kernel includes {file}")
        return [k for k in KERNELS if k != "whole" and file in self.files[k] and (file in TRAVERSAL or k not in PACKET_KERNELS)]

    def compile(self, kernel, output):
        """Without the passes of cmake/GlintShaders.cmake: the program does what they do, kernel by kernel (src/gpu/specialize.h)."""
        source, defines = KERNELS[kernel]
        command = ["glslangValidator", f"-I{self.shaders}", *(f"-D{d}" for d in defines), self.shaders / source, "--quiet", "-V", "--target-env", "vulkan1.1",
                   "-o", output]
        return subprocess.run(command, stdout=subprocess.DEVNULL, check=False).returncode == 0

    def compile_all(self, kernels, folder):
        folder.mkdir(parents=True)
        return all(self.compile(k, folder / f"{k}.spv") for k in kernels)

    def break_file(self, site):
        (self.shaders / site.file).write_text(breaks.broken((SHADERS / site.file).read_text(), site))

    def mend(self, site):
        shutil.copyfile(SHADERS / site.file, self.shaders / site.file)
