// Does verify find a defect in the kernels? For tests/mutation/mutation.py: opens the device and reads the
// scenes once, then answers each line of standard input, a folder of kernels and the names of the cases to
// try, with a line of JSON.
//
//   mutation_judge CASES
//
// CASES has a line for each case: its name, a scene of scenes/, width, height, samples for each pixel,
// traversal, and the methods of triangles and spheres. The folder holds kernels for texel buffers that
// replace the embedded ones: intersect.spv, packet_intersect_any.spv and so on.
#include <exception>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "../render/support.h"
#include "core/enum_names.h"
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

struct Trial {
    render::test::Case scene;
    verify::Options options;
    render::Traversal traversal = render::Traversal::Lane;
};

std::map<std::string, Trial> readTrials(const std::string& path) {
    std::map<std::string, Trial> trials;
    std::ifstream file(path);
    if (!file) throw std::runtime_error("cannot read " + path);
    for (std::string line; std::getline(file, line);) {
        if (line.empty() || line[0] == '#') continue;
        std::istringstream words(line);
        std::string name, scene, traversal, triangles, spheres;
        int width = 0, height = 0, samples = 0;
        if (!(words >> name >> scene >> width >> height >> samples >> traversal >> triangles >> spheres))
            throw std::runtime_error(path + ": " + line);
        Trial trial;
        Scene read = loadScene(glint::test::sourcePath("scenes/" + scene));
        read.image.width = width;
        read.image.height = height;
        read.image.samplesPerPixel = samples;
        static_cast<Request&>(trial.options) = requestOf(read.image, read.camera.lensRadius > 0);
        trial.options.methods.triangles = valueOf<TriangleMethod>(triangles);
        trial.options.methods.spheres = valueOf<SphereMethod>(spheres);
        trial.traversal = valueOf<render::Traversal>(traversal);
        trial.scene = render::test::makeCase(std::move(read), width, height);
        trials[name] = std::move(trial);
    }
    return trials;
}

// Why verify refuses the picture, empty if it does not.
std::string refusal(const gpu::Device& device, const Trial& trial, const render::KernelCode& code) {
    render::Options options;
    options.access = gpu::Access::TexelBuffer;
    options.kernels = &code;
    options.traversal = trial.traversal;
    try {
        render::Renderer renderer(device, trial.scene.packed, options);
        const verify::Report report =
            verify::verify(renderer, trial.scene.packed, trial.scene.camera, trial.options);
        if (report.passed()) return "";
        if (report.unexplained > 0) return "unexplained";
        if (report.edges + report.roundings > report.allowedOthers()) return "too many";
        return report.ties > report.allowedTies() ? "too many ties" : "percentile";
    } catch (const std::exception&) {
        return "error";
    }
}

void judge(const gpu::Device& device, const std::map<std::string, Trial>& trials, const std::string& line) {
    std::istringstream words(line);
    std::string folder, name, why;
    words >> folder;
    const KernelFolder kernels(folder);
    while (why.empty() && words >> name) why = refusal(device, trials.at(name), kernels.code());
    std::cout << R"({"killed": )" << (why.empty() ? "false" : "true") << R"(, "case": ")"
              << (why.empty() ? "" : name) << R"(", "why": ")" << why << "\"}" << std::endl;
}

}  // namespace
}  // namespace glint::mutation

int main(int count, char** arguments) {
    if (count != 2) return 2;
    try {
        const auto trials = glint::mutation::readTrials(arguments[1]);
        const glint::gpu::Device device;
        std::cout << "ready" << std::endl;
        for (std::string line; std::getline(std::cin, line);) glint::mutation::judge(device, trials, line);
    } catch (const std::exception& error) {
        std::cerr << error.what() << '\n';
        return 1;
    }
    return 0;
}
