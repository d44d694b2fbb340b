#include "trials.h"

#include <fstream>
#include <sstream>
#include <stdexcept>

#include "core/enum_names.h"
#include "import/load.h"
#include "pack/pack_samples.h"
#include "scene/sampling.h"
#include "support/support.h"

namespace glint::mutation {
namespace {

template <class Enum>
Enum valueOf(const std::string& name) {
    for (const auto& entry : entriesOf(Enum()))
        if (entry.name == name) return entry.value;
    throw std::runtime_error("no such choice: " + name);
}

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
        trial.device.traversal = valueOf<render::Traversal>(value);
    else if (name == "trips")
        trial.device.tripBudget = static_cast<uint32_t>(std::stoul(value));
    else if (name == "triangles")
        methods.triangles = valueOf<TriangleMethod>(value);
    else if (name == "spheres")
        methods.spheres = valueOf<SphereMethod>(value);
    else if (name == "cut")
        trial.options.limits.minContribution = std::stod(value);
    else if (name == "sampler")
        image.sampler = valueOf<Sampler>(value);
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
    const Request request = requestOf(image, read.camera.lensRadius > 0);
    trial.options.width = request.width;
    trial.options.height = request.height;
    trial.options.samples = request.samples;
    read.image = image;
    trial.scene = render::test::makeCase(std::move(read), image.width, image.height);
    return trial;
}

}  // namespace

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

}  // namespace glint::mutation
