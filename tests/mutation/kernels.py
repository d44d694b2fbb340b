"""Kernels of shaders in which one file is broken."""
import os
import re
import shutil
import subprocess
from pathlib import Path

import breaks

SOURCE = Path(__file__).resolve().parent.parent.parent
SHADERS = SOURCE / "shaders"

# name of KernelFolder: source, defines
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
# Shaders of tests: their defines, and what they include.
PROBES = {
    "tests/render/arithmetic_probe.comp": ((), ("arithmetic.glsl",)),
    "tests/stability/primitive_probe.comp": ((), ("shading/surface.glsl",)),
}
# Files about how rays walk, and what every walk does in its own way. The others' functions are the same for all of them: rays that walk by
# themselves, with a stack, judge those.
WALKS = ("traversal/stack.glsl", "traversal/stackless.glsl", "traversal/state.glsl", "traversal/leaf.glsl", "traversal/instance.glsl", "traversal/ray.glsl", "light.comp", "shading/light.glsl",
         "shading/lighting.glsl", "intersect.comp", "path.glsl", "path_rows.glsl", "shading/optics.glsl", "packet/packet.glsl", "packet/any.glsl", "packet/closest.glsl", "packet_intersect.comp", "packet_light.comp", "whole.comp")
# Cases that are drawn with glint's own quotients and roots judge this file alone.
ARITHMETIC = "arithmetic.glsl"
# spirv-opt -O without what takes 20 s a kernel: functions stay functions.
OPTIMISER = ("--private-to-local --eliminate-local-single-block --eliminate-local-single-store --ssa-rewrite --ccp --simplify-instructions "
             "--eliminate-dead-branches --merge-blocks --eliminate-dead-code-aggressive --redundancy-elimination "
             "--eliminate-dead-code-aggressive --compact-ids").split()
# Shaders that verify never runs: crossing counts are for the library, the probe is for the device.
LEFT_OUT = ("closest_point.comp", "count.comp", "traversal/count.glsl", "traversal/crossings.glsl", "probe.comp")


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


def folded(name, operation, operands):
    """What is known of a constant made of others, of which None is not known."""
    if operation == "Not":
        return {} if operands[0] is None else {name: not operands[0]}
    decides = operation == "Or"
    return {name: decides} if decides in operands else {} if None in operands else {name: not decides}


class Compiler:
    """Kernels of a copy of the shaders in which one file at a time is broken."""

    def __init__(self, folder):
        self.folder = Path(folder)
        self.shaders = self.folder / "shaders"
        shutil.copytree(SHADERS, self.shaders)
        self.files = {kernel: includes(source) for kernel, (source, _) in KERNELS.items()}
        self.spent = 0.0  # processor seconds of the compiler and the optimiser
        self.kept = {}  # what the optimiser leaves of a sound kernel

    def kernels_of(self, file):
        """Those that verify is to judge. whole.comp stays sound with the others: verify compares its pictures with theirs, and a defect
        that only one of them has would tell too easily."""
        if file == "whole.comp":
            return ["whole"]
        return [k for k in KERNELS if k != "whole" and file in self.files[k] and (file in WALKS or k not in PACKET_KERNELS)]

    def call(self, *command):
        """Runs a program; whether it liked what it was given."""
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        self.spent += used.ru_utime + used.ru_stime
        return process.returncode == 0

    def command(self, kernel):
        source, defines = KERNELS[kernel]
        defines = [f"-D{d}" for d in defines]
        return ["glslangValidator", f"-I{self.shaders}", *defines, self.shaders / source]

    def compile(self, kernel, output):
        """Without the passes of cmake/GlintShaders.cmake: the program does what they do, kernel by kernel (src/gpu/specialize.h)."""
        return self.call(*self.command(kernel), "--quiet", "-V", "--target-env", "vulkan1.1", "-o", output)

    def compile_all(self, kernels, folder):
        folder.mkdir(parents=True)
        return all(self.compile(k, folder / f"{k}.spv") for k in kernels)

    def compile_probes(self, file, folder):
        """The tests' own shaders that include the file."""
        for source, (defines, included) in PROBES.items():
            if any(file in includes(name) for name in included):
                self.call("glslangValidator", f"-I{self.shaders}", *defines, SOURCE / source, "--quiet", "-V", "--target-env", "vulkan1.1", "-o",
                          folder / f"{Path(source).stem}.spv")

    def text(self, kernel):
        """The kernel behind the preprocessor, without its lines' numbers."""
        done = subprocess.run([*self.command(kernel), "-E"], text=True, capture_output=True, check=True)
        return re.sub(r"^#line.*\n", "", done.stdout, flags=re.M)

    def break_file(self, site):
        (self.shaders / site.file).write_text(breaks.broken((SHADERS / site.file).read_text(), site))

    def mend(self, site):
        shutil.copyfile(SHADERS / site.file, self.shaders / site.file)

    def optimised(self, module):
        """The module as an optimiser leaves it, without names: equal for equivalent code, if it sees that."""
        output = self.folder / "optimised.spv"
        if not self.call("spirv-opt", "--strip-debug", *OPTIMISER, module, "-o", output):
            raise RuntimeError(f"spirv-opt does not read {module}")
        return output.read_bytes()

    def without_counts(self, module):
        """The module of a pipeline that counts neither rays by class nor tests: with those modes as constants."""
        words = self.folder / "counts.spvasm"
        if not self.call("spirv-dis", "--raw-id", module, "-o", words):
            raise RuntimeError(f"spirv-dis does not read {module}")
        text = words.read_text()
        known = dict.fromkeys(re.findall(r'OpName (%\d+) "MODE_(?:TALLY|COST)"', text), False)
        lines = []
        for line in text.splitlines():
            decorated = re.match(r" *OpDecorate (%\d+) SpecId", line)
            made = re.match(r" *(%\d+) = OpSpecConstant(?:False|Op) (%\d+)(?: Logical(And|Or|Not)((?: %\d+)+))?$", line)
            if made and made[1] not in known and made[3]:
                known |= folded(made[1], made[3], [known.get(operand) for operand in made[4].split()])
            if made and made[1] in known:
                line = f"{made[1]} = OpConstant{known[made[1]]} {made[2]}"
            if not (decorated and decorated[1] in known):
                lines.append(line)
        text = "\n".join(lines)
        words.write_text(text)
        output = self.folder / "counts.spv"
        if not self.call("spirv-as", "--preserve-numeric-ids", "--target-env", "spv1.3", words, "-o", output):
            raise RuntimeError(f"spirv-as does not read {words}")
        return self.optimised(output)

    def same_but_for_counts(self, broken, sound):
        if ("counts", sound) not in self.kept:
            self.kept["counts", sound] = self.without_counts(sound)
        return self.without_counts(broken) == self.kept["counts", sound]

    def same_after_optimisation(self, broken, sound, keep=False):
        if keep and sound not in self.kept:
            self.kept[sound] = self.optimised(sound)
        return self.optimised(broken) == (self.kept[sound] if keep else self.optimised(sound))
