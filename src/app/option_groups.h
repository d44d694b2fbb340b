// Options that several commands share, with the same names, texts and values in each.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/option_table.h"
#include "bvh/builder.h"
#include "core/file_source.h"
#include "core/progress.h"
#include "render/traversal_choice.h"
#include "scene/frame_model.h"
#include "scene/scene.h"
#include "trace/backend.h"
#include "trace/methods.h"

namespace glint::app {

// The scene, and the wishes of the command line.
struct SceneOptions {
    std::filesystem::path scene;
    bool allowOutside = false;  // files outside the scene's folder may be read
    std::string camera;         // by its name; empty: the scene's own
    std::optional<UpAxis> up;   // of a file without a camera
    std::optional<Size> size;
    std::optional<int> spp;
    std::optional<int> maxDepth;
    BuildQuality buildQuality = BuildQuality::Default;
    Methods methods;
    double minContribution = 0;  // branches that bring less to a pixel's colour are not followed
    std::optional<Sampler> sampler;
    std::optional<FilterChoice> filter;
    std::optional<uint32_t> seed;
    std::optional<AdaptiveSampling> adaptive;
    bool untilError = false;            // --error chooses the number of samples
    std::optional<double> time;         // of the animation, seconds; empty: the scene as its file says it
    std::shared_ptr<FileSource> files;  // that the scene is read from; empty: the file system's
};

struct DeviceChoice {
    std::string selector;
    bool validation = false;
    render::Traversal traversal = render::Traversal::Auto;
    bool reproducible = false;  // render::Options::ownArithmetic
    Fallback fallback = Fallback::None;
};

void addScene(OptionTable& table, SceneOptions& options);                       // one SCENE
void addScenes(OptionTable& table, std::vector<std::filesystem::path>& scenes,  // one or more
               bool& allowOutside);
// --size, --spp, --max-depth, --build-quality, --camera, --up, --time
void addSceneOverrides(OptionTable& table, SceneOptions& options);
void addCamera(OptionTable& table, SceneOptions& options);  // --camera, --up
void addCamera(OptionTable& table, std::string& name);
void addMethods(OptionTable& table, SceneOptions& options);  // --intersector, --sphere
void addMinContribution(OptionTable& table, SceneOptions& options);
void addSampling(OptionTable& table, SceneOptions& options);  // --sampler, --filter, --seed, --adaptive
void addExposure(OptionTable& table, std::optional<double>& stops);
void addBackend(OptionTable& table, Backend& backend);
void addDevice(OptionTable& table, DeviceChoice& device);  // --device, --validation, --threads
void addTraversal(OptionTable& table, DeviceChoice& device);
void addFallback(OptionTable& table, DeviceChoice& device);
void addProgress(OptionTable& table, ProgressMode& mode);
// --stats json; `what` says what it prints.
void addStats(OptionTable& table, const std::string& what, bool& json);

// Throws Error(Argument) for options of a device that the reference, which runs on none, would take no notice
// of: that is never what was meant.
void checkDeviceOptions(Backend backend, const DeviceChoice& device);

}  // namespace glint::app
