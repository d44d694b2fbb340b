#include "app/loading.h"

#include <algorithm>
#include <iostream>
#include <iterator>

#include "core/available_memory.h"
#include "core/enum_names.h"
#include "core/error.h"
#include "core/stopwatch.h"
#include "core/text_file.h"
#include "pack/pack_samples.h"
#include "pack/packed_scene.h"
#include "pack/request_environment.h"
#include "scene/sampling.h"

namespace glint::app {

namespace {

// The file "-" beside all others.
class StandardInput : public FileSource {
  public:
    std::string read(const std::filesystem::path& path, const Context& context) override {
        if (path != "-") return files_->read(path, context);
        return {std::istreambuf_iterator<char>(std::cin), {}};
    }
    FileStatus status(const std::filesystem::path& path) override { return files_->status(path); }
    std::filesystem::path real(const std::filesystem::path& path) override { return files_->real(path); }

  private:
    std::shared_ptr<FileSource> files_ = fileSystem();
};

}  // namespace

AnimatedScene::AnimatedScene(const SceneOptions& options, std::optional<double> time, std::ostream& err)
    : options_(options), err_(err) {
    const Stopwatch watch;
    std::shared_ptr<FileSource> files = options.files;
    if (options.scene == "-")
        files = std::make_shared<StandardInput>();
    else if (!files)
        checkScene(options.scene);
    reader_.emplace(options.scene,
                    LoadOptions{options.allowOutside, availableMemory(), options.camera, options.up, files},
                    time);
    loaded_.scene = reader_->scene();
    loaded_.loadSeconds = watch.seconds();
    pack();
    warn();
}

void AnimatedScene::pack() {
    const Stopwatch watch;
    // To find a tree again costs as much memory as it has, and an image that stands still has no use for it.
    TreeMemory* const memory = loaded_.scene.animation ? &memory_ : nullptr;
    loaded_.packed = packScene(loaded_.scene, {options_.buildQuality, true, memory});
    loaded_.packSeconds = watch.seconds();
}

void AnimatedScene::warn() {
    constexpr size_t kMost = 50;  // a file may name 20,000 others that are not there
    size_t hidden = 0;
    const auto say = [&](const std::string& line) {
        if (!warned_.insert(line).second) return;
        if (warned_.size() > kMost)
            ++hidden;
        else
            err_ << "glint: warning: " << line << '\n';
    };
    const std::string scene = options_.scene.string();
    if (options_.time && !loaded_.scene.animation)
        say(printable(scene + ": has no animation; --time changes nothing"));
    for (const std::string& w : loaded_.scene.warnings) say(printable(w));
    for (const std::string& w : loaded_.packed.warnings) say(printable(scene + ": " + w));
    if (hidden > 0) err_ << "glint: warning: " << printable(scene) << ": " << hidden << " warnings more\n";
}

AnimatedScene::Change AnimatedScene::moveTo(double time) {
    const Stopwatch watch;
    Change change = reader_->moveTo(time);
    if (change == Change::Nothing) return change;
    if (change == Change::Camera) {
        const Camera& camera = reader_->scene().camera;
        if (keepsArrays(loaded_.packed, loaded_.scene, camera)) {
            setEye(loaded_.packed, camera.eye);
            loaded_.scene.camera = camera;
            return change;
        }
    }
    loaded_.scene = reader_->scene();
    loaded_.loadSeconds = watch.seconds();
    pack();
    warn();
    return Change::Scene;
}

LoadedScene loadAndPack(const SceneOptions& options, std::ostream& err) {
    return AnimatedScene(options, options.time, err).take();
}

void checkScene(const std::filesystem::path& scene) {
    namespace fs = std::filesystem;
    constexpr std::string_view kKinds[] = {".json", ".gltf", ".glb", ".nff", ".obj", ".ply", ".stl"};
    std::error_code failed;
    std::string nearest;
    const std::string stem = scene.stem().string();
    size_t best = stem.size() / 3 + 1;
    if (!fs::exists(scene, failed) && stem.size() < 64) {
        for (const auto& entry : fs::directory_iterator(fs::path(".") / scene.parent_path(), failed)) {
            const fs::path& path = entry.path();
            if (std::find(std::begin(kKinds), std::end(kKinds), lowerExtension(path)) == std::end(kKinds))
                continue;
            const size_t distance = editDistance(stem, path.stem().string());
            if (distance >= best) continue;
            best = distance;
            nearest = path.filename().string();
        }
    }
    if (!nearest.empty())
        throw Error(ErrorKind::Scene,
                    printable(scene.string() + ": no such file (did you mean \"" + nearest + "\"?)"));
    checkFile(scene);
}

Request requestOf(const LoadedScene& loaded, const SceneOptions& options, bool untilError) {
    ImageSettings image = loaded.scene.image;
    if (options.size) {
        image.width = options.size->width;
        image.height = options.size->height;
    }
    if (options.spp) image.samplesPerPixel = *options.spp;
    if (options.sampler) image.sampler = *options.sampler;
    if (options.filter) {
        image.filter = options.filter->filter;
        image.filterRadius = options.filter->radius.value_or(defaultRadius(image.filter));
    }
    if (options.seed) image.seed = *options.seed;
    if (options.adaptive) image.adaptive = options.adaptive;
    // --error ignores the scene's number of samples.
    if (untilError)
        image.samplesPerPixel = std::max(image.samplesPerPixel, static_cast<int>(leastSamples(image.filter)));
    if (const std::string wrong = samplingConflict(image); !wrong.empty())
        throw Error(ErrorKind::Argument, options.scene.string() + ": " + wrong);
    Request request = requestOf(image, loaded.scene.camera.lensRadius > 0);
    request.methods = options.methods;
    request.limits = options.limits;
    return request;
}

SceneFeatures alsoFor(const LoadedScene& loaded, const Request& request) {
    const auto& materials = loaded.scene.materials;
    SceneFeatures also;
    also.mirrors = depthOf(loaded.packed, request) > 0 &&
                   std::any_of(materials.begin(), materials.end(),
                               [](const Material& m) { return m.mirror != Color(0); });
    return also;
}

}  // namespace glint::app
