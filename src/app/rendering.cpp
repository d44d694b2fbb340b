#include "app/rendering.h"

#include <algorithm>
#include <iostream>
#include <iterator>
#include <map>

#include "app/commands.h"
#include "core/available_memory.h"
#include "core/enum_names.h"
#include "core/parallel.h"
#include "core/stopwatch.h"
#include "core/text_file.h"
#include "pack/pack_samples.h"
#include "pack/packed_scene.h"
#include "pack/request_environment.h"
#include "reference/render.h"
#include "reference/sensitivity.h"
#include "reference/tracer.h"
#include "reference/truth/truth.h"
#include "scene/sampling.h"

namespace glint::app {

namespace {

// The file "-" in addition to all others.
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
    LoadOptions loading = options.loading;
    loading.memory = availableMemory();
    if (options.scene == "-")
        loading.source = std::make_shared<StandardInput>();
    else if (!loading.source)
        checkScene(options.scene);
    reader_.emplace(options.scene, loading, time);
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
    if (hidden > 0) err_ << warningOf(options_.scene) << hidden << " warnings more\n";
}

AnimatedScene::Change AnimatedScene::moveTo(double time) {
    const Stopwatch watch;
    Change change = reader_->moveTo(time);
    if (change == Change::Nothing) return change;
    if (change == Change::Camera && keepsArrays(loaded_.packed, loaded_.scene, camera())) return change;
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
    std::error_code failed;
    std::map<std::string, std::string, std::less<>> files;  // by their stems
    if (!fs::exists(scene, failed))
        for (const auto& entry : fs::directory_iterator(fs::path(".") / scene.parent_path(), failed))
            if (isSceneFile(entry.path())) files[entry.path().stem()] = entry.path().filename();
    std::vector<std::string_view> stems;
    for (const auto& [stem, file] : files) stems.push_back(stem);
    const auto meant = files.find(nearest(scene.stem().string(), stems));
    if (meant != files.end())
        throw Error(ErrorKind::Scene,
                    printable(scene.string() + ": no such file (did you mean \"" + meant->second + "\"?)"));
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
    const std::string conflict = samplingConflict(image);
    refuseIf(!conflict.empty(), options.scene.string() + ": " + conflict);
    Request request = requestOf(image, loaded.scene.camera);
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

gpu::Device openDevice(const DeviceChoice& choice, bool keepPrograms) {
    return gpu::Device({choice.selector, choice.validation, {}, keepPrograms});
}

void checkValidation(const gpu::Device& device, const DeviceChoice& choice) {
    if (!choice.validation) return;
    const auto messages = device.validationMessages();
    std::string text = "the validation layer found faults:";
    for (const std::string& message : messages) text += "\n  " + message;
    if (!messages.empty()) throw Error(ErrorKind::Device, text);
}

std::optional<converge::Job> jobOf(const converge::Target& target, const LoadedScene& loaded, Backend backend,
                                   Request& request) {
    if (target.error == 0) return std::nullopt;
    refuseIf(target.depthCounts && converge::missesReflections(loaded.scene, depthOf(loaded.packed, request)),
             "--error cannot bound reflections at maxDepth 0: use --max-depth 1 or --within-depth");
    refuseIf(request.region.pixels() == 1,
             "--error cannot bound the error of a single pixel: use a larger --crop");
    converge::Job job = converge::jobFor(loaded.packed, request, target);
    request = job.request;
    job.radianceBound =
        radianceBound(loaded.packed, environmentOf(loaded.packed, request), lightsOf(loaded.packed, request));
    job.inDouble = backend == Backend::Cpu;
    // The condition number times the ulp of the arithmetic, and the rounding error of storing as fp32.
    job.rounding =
        reference::roundingError(loaded.packed, request, job.inDouble ? 0x1p-53 : reference::kFloatUnit);
    return job;
}

Drawing::Drawing(const DeviceChoice& choice) : backend_(choice.backend), choice_(choice) {
    if (backend_ == Backend::Cpu) return;
    opening_ = std::async(std::launch::async | std::launch::deferred, [&choice] {
        gpu::Device device = openDevice(choice);
        device.arithmetic();  // a few milliseconds the first time
        return device;
    });
}

void Drawing::load(const LoadedScene& loaded, const Request& expected, uint64_t cameraRays) {
    loaded_ = &loaded;
    expected_ = expected;
    truth_.reset();
    if (backend_ == Backend::Cpu) return;
    if (!device_) device_.emplace(opening_.get());
    render::Options options;
    options.traversal = choice_.traversal;
    options.ownArithmetic = choice_.reproducible;
    options.expected = &expected;
    options.also = alsoFor(loaded, expected);
    options.cameraRays = cameraRays;
    renderer_.emplace(*device_, loaded.packed, options);
}

Picture Drawing::draw(const Request& request) {
    if (backend_ == Backend::Gpu) return renderer_->render(request);
    const Stopwatch watch;
    const glm::dvec3& origin = loaded_->packed.origin;
    if (!truth_) truth_ = std::make_shared<reference::Model>(reference::truthOf(loaded_->scene, origin));
    const reference::rows::Camera camera =
        reference::truthCamera(request.camera, request.width, request.height, origin);
    reference::setEye(*truth_, camera.eye);
    const reference::Tracer tracer(truth_, request, radianceBoundOf(loaded_->packed, request));
    Picture picture = reference::render(tracer, camera, request);
    hostSeconds_ += watch.seconds();
    return picture;
}

DrawingFacts Drawing::facts() const {
    DrawingFacts facts;
    facts.backend = backend_;
    if (!renderer_ && !truth_) return facts;
    if (backend_ == Backend::Cpu) {
        facts.device = "CPU reference (double precision)";
        facts.driver = counted(defaultThreadCount(), "thread");
        facts.times.trace = hostSeconds_;
        return facts;
    }
    facts.device = device_->info().name;
    facts.driver = device_->info().driver;
    // Whole paths and counts of tests trace single rays.
    const render::KernelTimes& kernels = renderer_->times().kernels;
    const bool single = expected_.cost || (kernels.whole > 0 && kernels.primary == 0);
    facts.traversal = nameOf(single ? render::TraversalChoice() : renderer_->traversal(expected_.methods));
    facts.arithmetic = device_->arithmetic();
    facts.times = renderer_->times();
    return facts;
}

void Drawing::checkValidation() const {
    if (device_) app::checkValidation(*device_, choice_);
}

}  // namespace glint::app
