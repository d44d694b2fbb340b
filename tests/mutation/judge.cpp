// Does verify find a defect in the kernels? For tests/mutation/mutation.py: opens the device and reads the
// scenes once, then answers each line of standard input with a line of JSON:
//
//   judge FOLDER CASE          do the kernels in FOLDER pass the case, and what differs in its pictures?
//   write FOLDER CASE OUTPUT   writes what the case makes of the kernels in FOLDER, and of the sound ones
//   hash FOLDER CASE           the bits of the whole picture, of all samples together
//
//   mutation_judge CASES SOUND
//
// CASES has a line for each case: its name, a scene of scenes/, width, height, samples for each pixel, and
// options (readOption in trials.cpp). The folder holds kernels for texel buffers that
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
#include <tuple>
#include <vector>

#include "../render/support.h"
#include "core/picture_hash.h"
#include "fingerprint.h"
#include "gpu/device_state.h"
#include "gpu/flatten.h"
#include "gpu/specialize.h"
#include "kernel_folder.h"
#include "render/path_limits.h"
#include "trials.h"
#include "verify/film.h"

namespace glint::mutation {
namespace {

// A program that a case runs, and a fingerprint of what its kernel holds for the case.
struct Run {
    std::shared_ptr<const gpu::Program> program;
    uint64_t code = 0;
};

// What is drawn of a case: each sample with its data, or without, for what is drawn by other kernels then, as
// verify does both, or the whole picture, for a hash.
enum class Drawn { Data, Plain, Whole };

// A case as sound kernels draw it.
struct Sound {
    std::vector<Run> runs;
    std::vector<Picture> pictures;
    std::string hash;
};

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
        std::string what, folder, name, output, pictures, why, hash;
        words >> what >> folder >> name >> output;
        const Trial& trial = trials_.at(name);
        const KernelFolder broken(folder, sound_.code());
        const bool plain = drawsWholePaths(trial, broken.code());
        const Sound& sound =
            soundOf(trial, name, what == "hash" ? Drawn::Whole : (plain ? Drawn::Plain : Drawn::Data), plain);
        try {
            if (what == "write")
                write(sound, broken.code(), output);
            else if (!runsOther(sound, broken.code()))
                pictures = "same code", hash = sound.hash;
            else if (what == "hash")
                hash = hashOf(trial, sound, broken.code());
            else
                why = refusal(trial, sound, broken.code(), pictures);
        } catch (const std::exception&) {
            why = "error";
        }
        return R"({"why": ")" + why + R"(", "pictures": ")" + pictures + R"(", "hash": ")" + hash + "\"}";
    }

  private:
    static render::Options optionsOf(const Trial& trial, const render::KernelCode& code, bool wholePaths) {
        render::Options options = trial.device;
        options.kernels = &code;
        options.wholePaths = wholePaths ? render::WholePaths::On : render::WholePaths::Off;
        return options;
    }

    // Whether whole.comp is broken, and draws the case without data: with kernels of the caller's, it never
    // does by itself. It is never broken beside others, whose defects it would tell too easily.
    bool drawsWholePaths(const Trial& trial, const render::KernelCode& broken) const {
        constexpr auto kWhole = render::KernelId::Whole;
        if (broken[kWhole].data() == sound_.code()[kWhole].data()) return false;
        const PackedScene& scene = trial.scene.packed;
        const uint32_t trips = render::wholeTripBudget(device_.info(), scene.features,
                                                       scene.polygonTripsPerLeaf, scene.environment);
        return trial.device.traversal == render::Traversal::Lane &&
               render::wholePathsPay(device_.info(), {}, {.furtherRays = true, .tripBudget = trips});
    }

    // As verify draws them: sample by sample, and if there are several, all of them.
    static std::vector<Picture> picturesOf(render::Renderer& renderer, const Trial& trial, bool data) {
        std::vector<Picture> pictures;
        Request request = trial.options;
        const SceneFeatures& features = trial.scene.packed.features;
        request.data = data;
        request.ledger = data && (features.mirrors || features.transmission);
        for (uint32_t sample = 0; sample < trial.options.samples.round; ++sample) {
            request.samples = trial.options.samples.only(sample);
            pictures.push_back(renderer.render(trial.scene.camera, request));
        }
        request.data = request.ledger = false;
        request.samples = verify::firstRounds(trial.options.samples);
        if (request.samples.count() > 1) pictures.push_back(renderer.render(trial.scene.camera, request));
        return pictures;
    }

    static std::string verdict(render::Renderer& renderer, const Trial& trial, bool plainToo) {
        verify::Options options = trial.options;
        options.plainToo = plainToo;
        const verify::Report report =
            verify::verify(renderer, trial.scene.packed, trial.scene.camera, options);
        if (report.passed()) return "";
        if (report.unexplained > 0) return "unexplained";
        if (report.plainDiffers > 0) return "other without data";
        if (report.filmDiffers > 0) return "wrong sum";
        if (report.lossesDiffer > 0) return "wrong account";
        if (report.edges + report.roundings > report.allowedOthers()) return "too many";
        return report.ties > report.allowedTies() ? "too many ties" : "percentile";
    }

    const Sound& soundOf(const Trial& trial, const std::string& name, Drawn drawn, bool wholePaths) {
        const auto [place, isNew] = sounds_.try_emplace({name, drawn, wholePaths});
        Sound& sound = place->second;
        if (!isNew) return sound;
        auto& programs = device_.state().programs;
        programs.clear();
        render::Renderer renderer(device_, trial.scene.packed, optionsOf(trial, sound_.code(), wholePaths));
        if (drawn == Drawn::Whole) {
            sound.hash = pictureHash(renderer.render(trial.scene.camera, trial.options).color);
        } else {
            sound.pictures = picturesOf(renderer, trial, drawn == Drawn::Data);
            const std::string why = verdict(renderer, trial, drawn == Drawn::Plain);
            if (!why.empty()) throw std::runtime_error("sound kernels do not pass: " + why);
        }
        for (const auto& program : programs)
            sound.runs.push_back({program, codeOf(program->key.spirv, program->key.constants)});
        return sound;
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
        for (const render::KernelId id : render::kKernels) {
            const std::span<const uint32_t> sound = sound_.code()[id], other = broken[id];
            if (std::equal(sound.begin(), sound.end(), kernel.begin(), kernel.end()))
                return other.data() == sound.data() ? std::span<const uint32_t>() : other;
        }
        return {};
    }

    // The programs of kernels that are not replaced are found again.
    render::Renderer rendererOf(const Trial& trial, const Sound& sound,
                                const render::KernelCode& broken) const {
        auto& programs = device_.state().programs;
        programs.clear();
        for (const Run& run : sound.runs) programs.push_back(run.program);
        return render::Renderer(device_, trial.scene.packed,
                                optionsOf(trial, broken, drawsWholePaths(trial, broken)));
    }

    std::string hashOf(const Trial& trial, const Sound& sound, const render::KernelCode& broken) const {
        return pictureHash(rendererOf(trial, sound, broken).render(trial.scene.camera, trial.options).color);
    }

    std::string refusal(const Trial& trial, const Sound& sound, const render::KernelCode& broken,
                        std::string& pictures) const {
        render::Renderer renderer = rendererOf(trial, sound, broken);
        const bool plain = drawsWholePaths(trial, broken);
        const std::vector<Picture> drawn = picturesOf(renderer, trial, !plain);
        pictures = "other bits";
        const bool same = std::equal(
            drawn.begin(), drawn.end(), sound.pictures.begin(), [](const Picture& a, const Picture& b) {
                return a.samples == b.samples && bool(render::test::sameBits(a, b)) &&
                       bool(render::test::sameLosses(a, b));
            });
        if (same) pictures = "same bits";
        return same ? "" : verdict(renderer, trial, plain);
    }

    gpu::Device device_;  // outlives the programs
    std::map<std::string, Trial> trials_;
    std::map<std::tuple<std::string, Drawn, bool>, Sound> sounds_;
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
