#include "app/animated_scene.h"

#include <iostream>
#include <iterator>

#include "app/common.h"
#include "core/available_memory.h"
#include "core/error.h"
#include "core/stopwatch.h"
#include "core/text_file.h"
#include "pack/camera_change.h"

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

AnimatedScene::AnimatedScene(const SceneOptions& options, std::optional<double> time, std::ostream& err,
                             bool quiet)
    : options_(options), err_(quiet ? nullptr : &err) {
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
    // To find a tree again costs as much memory as it has, and a picture that stands still has no use for it.
    TreeMemory* const memory = loaded_.scene.animation ? &memory_ : nullptr;
    loaded_.packed = packScene(loaded_.scene, {options_.buildQuality, true, memory});
    loaded_.packSeconds = watch.seconds();
}

void AnimatedScene::warn() {
    if (!err_) return;
    constexpr size_t kMost = 50;  // a file may name 20,000 others that are not there
    size_t hidden = 0;
    const auto say = [&](const std::string& line) {
        if (!warned_.insert(line).second) return;
        if (warned_.size() > kMost)
            ++hidden;
        else
            *err_ << "glint: warning: " << line << '\n';
    };
    const std::string scene = options_.scene.string();
    if (options_.time && !loaded_.scene.animation)
        say(printable(scene + ": has no animation; --time changes nothing"));
    for (const std::string& w : loaded_.scene.warnings) say(printable(w));
    for (const std::string& w : loaded_.packed.warnings) say(printable(scene + ": " + w));
    if (hidden > 0) *err_ << "glint: warning: " << printable(scene) << ": " << hidden << " warnings more\n";
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

}  // namespace glint::app
