// Does verify find a defect in the kernels? For tests/mutation/mutation.py:
//
//   mutation_judge CASES SOUND
//
// opens the device, reads the scenes, and answers each line "FOLDER CASE" of standard input with a line:
// "same bits" if the kernels in FOLDER render the bits of the sound ones; "other bits" if verify passes other
// bits; "found: ..." if it does not; "sound: ..." if it does not pass the sound kernels.
//
// CASES has a line for each case: its name, a scene of scenes/, width, height, samples for each pixel, and
// options (readOption). FOLDER holds kernels, such as intersect.spv and packet_intersect_any.spv, that
// replace those of the folder SOUND.
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <list>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "../render/support.h"
#include "core/enum_names.h"
#include "import/load.h"
#include "pack/pack_samples.h"
#include "render/kernels.h"
#include "render/renderer.h"
#include "scene/sampling.h"
#include "support/support.h"
#include "verify/film.h"
#include "verify/verify.h"

namespace glint::mutation {
namespace {

struct Trial {
    render::test::Case scene;
    verify::Options options;
    render::Options device;  // without kernels
};

// 32,0.1
AdaptiveSampling adaptiveOf(const std::string& text) {
    AdaptiveSampling adaptive;
    const size_t comma = text.find(',');
    adaptive.maxSamples = std::stoi(text);
    if (comma != std::string::npos) adaptive.threshold = std::stod(text.substr(comma + 1));
    return adaptive;
}

// own, traversal=packet, triangles=projection, trips=40 ...
void readOption(const std::string& text, Trial& trial, ImageSettings& image) {
    const size_t sign = text.find('=');
    const std::string name = text.substr(0, sign),
                      value = sign == std::string::npos ? "" : text.substr(sign + 1);
    Methods& methods = trial.options.methods;
    if (name == "own")
        trial.device.ownArithmetic = true;
    else if (name == "traversal")
        trial.device.traversal = named<render::Traversal>(value).value();
    else if (name == "trips")
        trial.device.tripBudget = static_cast<uint32_t>(std::stoul(value));
    else if (name == "triangles")
        methods.triangles = named<TriangleMethod>(value).value();
    else if (name == "spheres")
        methods.spheres = named<SphereMethod>(value).value();
    else if (name == "cut")
        trial.options.limits.minContribution = std::stod(value);
    else if (name == "sampler")
        image.sampler = named<Sampler>(value).value();
    else if (name == "adaptive")
        image.adaptive = adaptiveOf(value);
    else
        throw std::runtime_error("no such option: " + text);
}

Trial trialOf(std::istringstream& words) {
    std::string scene;
    Trial trial;
    ImageSettings image;
    if (!(words >> scene >> image.width >> image.height >> image.samplesPerPixel))
        throw std::runtime_error("scene, width, height and samples are missing");
    std::vector<std::string> options;
    LoadOptions load{.allowOutside = true};
    for (std::string option; words >> option;) {
        if (option.starts_with("camera="))
            load.camera = option.substr(7);
        else
            options.push_back(option);
    }
    Scene read = loadScene(glint::test::sourcePath("scenes/" + scene), load);
    image.sampler = read.image.sampler;
    image.filter = read.image.filter;
    image.filterRadius = read.image.filterRadius;
    image.seed = read.image.seed;
    trial.options.verdictAlone = true;
    trial.device.access = gpu::Access::TexelBuffer;
    trial.device.traversal = render::Traversal::Lane;
    for (const std::string& option : options) readOption(option, trial, image);
    const Request request = requestOf(image, read.camera);
    trial.options.camera = request.camera;
    trial.options.width = request.width;
    trial.options.height = request.height;
    trial.options.samples = request.samples;
    read.image = image;
    trial.scene = render::test::makeCase(std::move(read), image.width, image.height);
    return trial;
}

// By name. Throws std::runtime_error for an unknown one.
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

// The given kernels, except those in the folder.
class KernelFolder {
  public:
    KernelFolder(const std::filesystem::path& folder, const render::KernelCode& others) : code_(others) {
        for (const render::KernelId id : render::kKernels) {
            const auto path = folder / (std::string(infoOf(id).module) + ".spv");
            if (!std::filesystem::exists(path)) continue;
            const std::vector<uint8_t> bytes = glint::test::readBytes(path);
            std::vector<uint32_t>& words = words_.emplace_back(bytes.size() / sizeof(uint32_t));
            std::memcpy(words.data(), bytes.data(), words.size() * sizeof(uint32_t));
            code_[id] = words;
        }
    }
    KernelFolder(const KernelFolder&) = delete;
    KernelFolder& operator=(const KernelFolder&) = delete;

    const render::KernelCode& code() const { return code_; }

  private:
    std::list<std::vector<uint32_t>> words_;
    render::KernelCode code_;
};

class Judge {
  public:
    Judge(std::map<std::string, Trial> trials, const std::string& sound)
        : trials_(std::move(trials)), sound_(sound, render::embeddedKernels()) {}

    std::string answer(const std::string& line) {
        std::istringstream words(line);
        std::string folder, name;
        words >> folder >> name;
        const Trial& trial = trials_.at(name);
        const KernelFolder broken(folder, sound_.code());
        // Only images without layers are rendered by whole.comp, which is never broken beside other kernels.
        constexpr auto kWhole = render::KernelId::Whole;
        const bool whole = broken.code().at(kWhole).data() != sound_.code().at(kWhole).data();
        const auto [sound, isNew] = images_.try_emplace({name, whole});
        if (isNew) {
            render::Renderer renderer = rendererOf(trial, sound_.code(), whole);
            sound->second = imagesOf(renderer, trial, whole);
            const std::string why = verdict(renderer, trial, whole);
            if (!why.empty()) return "sound: " + why;
        }
        try {
            render::Renderer renderer = rendererOf(trial, broken.code(), whole);
            if (areSame(imagesOf(renderer, trial, whole), sound->second)) return "same bits";
            const std::string why = verdict(renderer, trial, whole);
            return why.empty() ? "other bits" : "found: " + why;
        } catch (const std::exception&) {
            return "found: error";
        }
    }

  private:
    render::Renderer rendererOf(const Trial& trial, const render::KernelCode& code, bool whole) const {
        render::Options options = trial.device;
        options.kernels = &code;
        options.wholePaths = whole ? render::WholePaths::On : render::WholePaths::Off;
        return render::Renderer(device_, trial.scene.packed, options);
    }

    // As verify renders them: sample by sample, and several samples together.
    static std::vector<Picture> imagesOf(render::Renderer& renderer, const Trial& trial, bool whole) {
        std::vector<Picture> images;
        Request request = trial.options;
        const SceneFeatures& features = trial.scene.packed.features;
        request.data = !whole;
        request.ledger = !whole && (features.mirrors || features.transmission);
        for (uint32_t sample = 0; sample < trial.options.samples.round; ++sample) {
            request.samples = trial.options.samples.only(sample);
            images.push_back(renderer.render(request));
        }
        request.data = request.ledger = false;
        request.samples = verify::firstRounds(trial.options.samples);
        if (request.samples.count() > 1) images.push_back(renderer.render(request));
        return images;
    }

    static bool areSame(const std::vector<Picture>& a, const std::vector<Picture>& b) {
        return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Picture& x, const Picture& y) {
            return x.samples == y.samples && bool(render::test::sameBits(x, y)) &&
                   bool(render::test::sameLosses(x, y));
        });
    }

    // Empty if verify passes.
    static std::string verdict(render::Renderer& renderer, const Trial& trial, bool whole) {
        verify::Options options = trial.options;
        options.plainToo = whole;
        const verify::Report report = verify::verify(renderer, trial.scene.packed, options);
        if (report.passed()) return "";
        if (report.unexplained > 0) return "unexplained";
        if (report.plainDiffers > 0) return "other without layers";
        if (report.filmDiffers > 0) return "wrong sum";
        if (report.lossesDiffer) return "wrong account";
        if (report.explained() > report.allowedExplained()) return "too many";
        return "undecided";
    }

    gpu::Device device_;
    std::map<std::string, Trial> trials_;
    std::map<std::pair<std::string, bool>, std::vector<Picture>> images_;  // of sound kernels
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
