// Does verify find a defect in the kernels? For tests/mutation/mutation.py: opens the device and reads the
// scenes once, then answers each line of standard input with a line of JSON:
//
//   judge FOLDER CASE          do the kernels in FOLDER pass the case, and what differs in its pictures?
//   write FOLDER CASE OUTPUT   writes what the case makes of the kernels in FOLDER, and of the sound ones
//
//   mutation_judge CASES SOUND
//
// CASES has a line for each case: its name, a scene of scenes/, width, height, samples for each pixel, and
// options (readOption). The folder holds kernels for texel buffers that
// replace those of the folder SOUND: intersect.spv, packet_intersect_any.spv and so on.
//
// What can be known without verify is not asked of it: a case whose kernels do not change, or whose picture
// has the bits of the sound one, passes as that did. So each case is drawn and verified once, when first
// asked for.
#include <exception>
#include <fstream>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "../render/support.h"
#include "core/enum_names.h"
#include "fingerprint.h"
#include "gpu/device_state.h"
#include "gpu/flatten.h"
#include "gpu/specialize.h"
#include "import/load.h"
#include "kernel_folder.h"
#include "pack/pack_samples.h"
#include "support/support.h"
#include "verify/verify.h"

namespace glint::mutation {
namespace {

template <class Enum>
Enum valueOf(const std::string& name) {
    for (const auto& entry : entriesOf(Enum()))
        if (entry.name == name) return entry.value;
    throw std::runtime_error("no such choice: " + name);
}

using Kernel = std::span<const uint32_t> render::KernelCode::*;
constexpr Kernel kMembers[] = {&render::KernelCode::generate,
                               &render::KernelCode::intersect,
                               &render::KernelCode::intersectAny,
                               &render::KernelCode::light,
                               &render::KernelCode::shade,
                               &render::KernelCode::packetIntersect,
                               &render::KernelCode::packetIntersectAny,
                               &render::KernelCode::packetLight,
                               &render::KernelCode::adapt};

// A program that a case runs, and a fingerprint of what its kernel holds for the case.
struct Run {
    std::shared_ptr<const gpu::Program> program;
    uint64_t code = 0;
};

// A case as sound kernels draw it.
struct Sound {
    std::vector<Run> runs;
    std::vector<Picture> pictures;  // of each sample
};

struct Trial {
    render::test::Case scene;
    verify::Options options;
    render::Options device;
    std::optional<Sound> sound;  // once it was asked for
};

// own, traversal=bvh4, triangles=projection, trips=40 ...
void readOption(const std::string& text, Trial& trial) {
    const size_t sign = text.find('=');
    const std::string name = text.substr(0, sign),
                      value = sign == std::string::npos ? "" : text.substr(sign + 1);
    Methods& methods = trial.options.methods;
    if (name == "own")
        trial.device.ownArithmetic = true;
    else if (name == "traversal")
        trial.device.traversal = valueOf<render::Traversal>(value);
    else if (name == "stack")
        trial.device.stack = valueOf<render::StackPlace>(value);
    else if (name == "compaction")
        trial.device.compaction = valueOf<render::Compaction>(value);
    else if (name == "trips")
        trial.device.tripBudget = static_cast<uint32_t>(std::stoul(value));
    else if (name == "triangles")
        methods.triangles = valueOf<TriangleMethod>(value);
    else if (name == "spheres")
        methods.spheres = valueOf<SphereMethod>(value);
    else if (name == "slabs")
        methods.slabs = valueOf<SlabPad>(value);
    else if (name == "offsets")
        methods.offsets = valueOf<OriginOffset>(value);
    else if (name == "cut")
        trial.options.minContribution = std::stod(value);
    else
        throw std::runtime_error("no such option: " + text);
}

Trial trialOf(std::istringstream& words) {
    std::string scene;
    int width = 0, height = 0, samples = 0;
    if (!(words >> scene >> width >> height >> samples)) throw std::runtime_error("what is to be drawn?");
    Trial trial;
    Scene read = loadScene(glint::test::sourcePath("scenes/" + scene), {.allowOutside = true});
    read.image.width = width;
    read.image.height = height;
    read.image.samplesPerPixel = samples;
    static_cast<Request&>(trial.options) = requestOf(read.image, read.camera.lensRadius > 0);
    trial.options.verdictAlone = true;
    trial.device.access = gpu::Access::TexelBuffer;
    trial.device.traversal = render::Traversal::Lane;
    for (std::string option; words >> option;) readOption(option, trial);
    trial.scene = render::test::makeCase(std::move(read), width, height);
    return trial;
}

std::map<std::string, Trial> readTrials(const std::string& path) {
    std::map<std::string, Trial> trials;
    std::ifstream file(path);
    if (!file) throw std::runtime_error("cannot read " + path);
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        std::string name;
        if (!(words >> name) || name[0] == '#') continue;
        try {
            trials[name] = trialOf(words);
        } catch (const std::exception& error) {
            throw std::runtime_error(name + ": " + error.what());
        }
    }
    return trials;
}

// As src/gpu/kernel.cpp makes it, but for decorations that all arithmetic gets.
std::vector<uint32_t> flatCode(std::span<const uint32_t> spirv, const std::vector<uint32_t>& constants) {
    return gpu::flatten(gpu::specialize(spirv, constants));
}

uint64_t codeOf(std::span<const uint32_t> spirv, const std::vector<uint32_t>& constants) {
    return fingerprintOf(flatCode(spirv, constants));
}

void writeWords(const std::string& path, const std::vector<uint32_t>& words) {
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<const char*>(words.data()),
               static_cast<std::streamsize>(words.size() * sizeof(uint32_t)));
    if (!file) throw std::runtime_error("cannot write " + path);
}

class Judge {
  public:
    Judge(std::map<std::string, Trial> trials, const std::string& sound)
        : trials_(std::move(trials)), sound_(sound) {}

    // Answers a line.
    std::string answer(const std::string& line) {
        std::istringstream words(line);
        std::string what, folder, name, output, pictures, why;
        words >> what >> folder >> name >> output;
        Trial& trial = trials_.at(name);
        if (!trial.sound) draw(trial);
        const KernelFolder broken(folder, sound_.code());
        try {
            if (what == "write")
                write(*trial.sound, broken.code(), output);
            else if (!runsOther(*trial.sound, broken.code()))
                pictures = "same code";
            else
                why = refusal(trial, broken.code(), pictures);
        } catch (const std::exception&) {
            why = "error";
        }
        return R"({"why": ")" + why + R"(", "pictures": ")" + pictures + "\"}";
    }

  private:
    static render::Options optionsOf(const Trial& trial, const render::KernelCode& code) {
        render::Options options = trial.device;
        options.kernels = &code;
        return options;
    }

    // As verify draws them.
    static std::vector<Picture> picturesOf(render::Renderer& renderer, const Trial& trial) {
        std::vector<Picture> pictures;
        for (uint32_t sample = 0; sample < trial.options.samples.round; ++sample) {
            Request request = trial.options;
            request.samples = trial.options.samples.only(sample);
            request.data = true;
            pictures.push_back(renderer.render(trial.scene.camera, request));
        }
        return pictures;
    }

    static std::string verdict(render::Renderer& renderer, const Trial& trial) {
        const verify::Report report =
            verify::verify(renderer, trial.scene.packed, trial.scene.camera, trial.options);
        if (report.passed()) return "";
        if (report.unexplained > 0) return "unexplained";
        if (report.edges + report.roundings > report.allowedOthers()) return "too many";
        return report.ties > report.allowedTies() ? "too many ties" : "percentile";
    }

    void draw(Trial& trial) {
        auto& programs = device_.state().programs;
        programs.clear();
        render::Renderer renderer(device_, trial.scene.packed, optionsOf(trial, sound_.code()));
        Sound sound;
        sound.pictures = picturesOf(renderer, trial);
        if (!verdict(renderer, trial).empty()) throw std::runtime_error("sound kernels do not pass");
        for (const auto& program : programs)
            sound.runs.push_back({program, codeOf(program->key.spirv, program->key.constants)});
        trial.sound = std::move(sound);
    }

    // Whether one of the kernels that replace sound ones holds other code for the case.
    bool runsOther(const Sound& sound, const render::KernelCode& broken) const {
        for (const Run& run : sound.runs) {
            const std::span<const uint32_t> kernel = replacementOf(run.program->key.spirv, broken);
            if (!kernel.empty() && codeOf(kernel, run.program->key.constants) != run.code) return true;
        }
        return false;
    }

    // The kernels that hold other code, beside the sound ones.
    void write(const Sound& sound, const render::KernelCode& broken, const std::string& folder) const {
        size_t pairs = 0;
        for (const Run& run : sound.runs) {
            const gpu::ProgramKey& key = run.program->key;
            const std::span<const uint32_t> kernel = replacementOf(key.spirv, broken);
            if (kernel.empty() || codeOf(kernel, key.constants) == run.code) continue;
            const std::string name = folder + "/" + std::to_string(pairs++);
            writeWords(name + ".sound.spv", flatCode(key.spirv, key.constants));
            writeWords(name + ".broken.spv", flatCode(kernel, key.constants));
        }
    }

    // What stands in `broken` for a sound kernel; empty if that does.
    std::span<const uint32_t> replacementOf(const std::vector<uint32_t>& kernel,
                                            const render::KernelCode& broken) const {
        for (const auto member : kMembers) {
            const std::span<const uint32_t> sound = sound_.code().*member, other = broken.*member;
            if (std::equal(sound.begin(), sound.end(), kernel.begin(), kernel.end()))
                return other.data() == sound.data() ? std::span<const uint32_t>() : other;
        }
        return {};
    }

    std::string refusal(const Trial& trial, const render::KernelCode& broken, std::string& pictures) {
        auto& programs = device_.state().programs;
        programs.clear();
        for (const Run& run : trial.sound->runs) programs.push_back(run.program);
        render::Renderer renderer(device_, trial.scene.packed, optionsOf(trial, broken));
        const std::vector<Picture> drawn = picturesOf(renderer, trial);
        pictures = "other bits";
        const bool same =
            std::equal(drawn.begin(), drawn.end(), trial.sound->pictures.begin(),
                       [](const Picture& a, const Picture& b) { return bool(render::test::sameBits(a, b)); });
        if (same) pictures = "same bits";
        return same ? "" : verdict(renderer, trial);
    }

    gpu::Device device_;  // outlives the programs
    std::map<std::string, Trial> trials_;
    KernelFolder sound_;
};

}  // namespace
}  // namespace glint::mutation

int main(int count, char** arguments) {
    if (count != 3) return 2;
    try {
        glint::mutation::Judge judge(glint::mutation::readTrials(arguments[1]), arguments[2]);
        std::cout << "ready" << std::endl;
        for (std::string line; std::getline(std::cin, line);) std::cout << judge.answer(line) << std::endl;
    } catch (const std::exception& error) {
        std::cerr << error.what() << '\n';
        return 1;
    }
    return 0;
}
