// The options of one command, each declared once: names, form of the value, help text, and the function that
// reads the value. An error that reading throws gets the option's name in front.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/option_values.h"
#include "bvh/bvh.h"
#include "core/file_source.h"
#include "core/progress.h"
#include "render/kernel_choice.h"
#include "scene/frame_model.h"
#include "scene/scene.h"
#include "trace/backend.h"
#include "trace/methods.h"
#include "trace/request.h"

namespace CLI {
class App;
}

namespace glint::app {

class OptionTable {
  public:
    enum class Need { Optional, Required };

    // Declares options of `command`, which must outlive the parsing, as must all targets below.
    explicit OptionTable(CLI::App& command) : command_(command) {}

    // An option, `names` being such as "--size" or "-o,--output"; or, with a name in capitals and no form, an
    // argument known by its place. `parse` turns the text, which may be empty, into the target's value; it
    // throws Error(Argument) for an invalid one.
    template <typename Target, typename Parse>
    void value(const std::string& names, const std::string& form, const std::string& help, Target& target,
               const Parse& parse, Need need = Need::Optional) {
        read(
            names, form, help, [&target, parse](const std::string& text) { target = parse(text); }, need);
    }

    // A text that is not empty: the name of a file (form FILE), a folder (FOLDER), a camera or a device.
    template <typename Target>
    void name(const std::string& names, const std::string& form, const std::string& help, Target& target,
              Need need = Need::Optional) {
        value(names, form, help, target, parseName, need);
    }

    // A whole number from `least` to `greatest`.
    template <typename Target>
    void whole(const std::string& names, const std::string& form, const std::string& help, int least,
               int greatest, Target& target) {
        value(names, form, help, target,
              [least, greatest](const std::string& text) { return parseWhole(text, least, greatest); });
    }

    // A number from `least` to `greatest`.
    template <typename Target>
    void real(const std::string& names, const std::string& form, const std::string& help, double least,
              double greatest, Target& target) {
        value(names, form, help, target,
              [least, greatest](const std::string& text) { return parseReal(text, least, greatest); });
    }

    // One of an enumeration's names.
    template <NamedEnum E, typename Target>
    void choice(const std::string& names, const std::string& help, Target& target) {
        value(names, alternatives<E>(), help, target, parseNamed<E>);
    }

    // Takes no value.
    void flag(const std::string& names, const std::string& help, bool& target);

    // One or more files known by their place.
    void files(const std::string& name, const std::string& help, std::vector<std::filesystem::path>& target);

    // An option whose text goes to a function.
    void read(const std::string& names, const std::string& form, const std::string& help,
              const std::function<void(const std::string& text)>& use, Need need = Need::Optional);

  private:
    CLI::App& command_;
};

// The scene, and the wishes of the command line.
struct SceneOptions {
    std::filesystem::path scene;
    bool allowOutside = false;  // files outside the scene's folder may be read
    std::string camera;         // by its name; empty: the scene's own
    std::optional<UpAxis> up;   // of a file without a camera
    std::optional<Size> size;
    std::optional<int> spp;
    BuildQuality buildQuality = BuildQuality::Default;
    Methods methods;
    PathLimits limits;
    std::optional<Sampler> sampler;
    std::optional<FilterChoice> filter;
    std::optional<uint32_t> seed;
    std::optional<AdaptiveSampling> adaptive;
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

// Options that several commands share, with the same names, texts and values in each.
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
// --stats json; `help` tells what it prints.
void addStats(OptionTable& table, const std::string& help, bool& json);

// Throws Error(Argument) for options of a device that --backend cpu would ignore.
void checkDeviceOptions(Backend backend, const DeviceChoice& device);

}  // namespace glint::app
