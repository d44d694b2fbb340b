// The options of a command, each declared once, and their values.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bvh/bvh.h"
#include "converge/converge.h"
#include "core/enum_names.h"
#include "core/progress.h"
#include "import/scene_files.h"
#include "pack/packed_scene.h"
#include "render/kernel_choice.h"
#include "scene/scene.h"
#include "trace/methods.h"
#include "trace/picture.h"
#include "trace/request.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace glint::app {

struct Size {
    int width = 0, height = 0;
};

// One of several parts of an image, 1 <= number <= of.
struct PartChoice {
    int number = 1, of = 1;
};

// Frames of an animation, both ends among them: 0 <= first <= last.
struct FrameRange {
    int first = 0, last = 0;
};

struct FilterChoice {
    Filter filter = Filter::Box;
    std::optional<double> radius;  // pixels; empty: the filter's own
};

// Values from text. All throw Error(Argument) with one line that names the accepted values and the given
// value; OptionTable puts the option's name in front.
int parseWhole(const std::string& text, int least, int greatest);
double parseReal(const std::string& text, double least, double greatest);
double parsePositive(const std::string& text);            // finite
double parseNotNegative(const std::string& text);         // finite
Size parseSize(const std::string& text);                  // "640x480"
PartChoice parsePart(const std::string& text);            // "3/8"
FrameRange parseFrames(const std::string& text);          // "0:240" or "17"
Region parseCrop(const std::string& text);                // "x0,y0,x1,y1", not empty
std::pair<int, int> parsePixel(const std::string& text);  // "x,y"
std::vector<Aov> parseAovs(const std::string& text);      // "color, depth": each once
// "depth,offset": words that names of the settings of `glint report` start with.
std::vector<std::string> parseFamilies(const std::string& text);
SceneFeatures parseFeatures(const std::string& text);   // by the names that `glint info` prints
const std::string& parseName(const std::string& text);  // not empty

[[noreturn]] void refuse(const std::string& wanted, const std::string& text);

// Throws Error(Argument) with this line if the command line is `wrong`.
void refuseIf(bool wrong, const std::string& line);

template <NamedEnum E>
E parseNamed(const std::string& text) {
    const std::optional<E> found = named<E>(text);
    if (!found) refuse(choices<E>(), text);
    return *found;
}

class OptionTable {
  public:
    // Declares options of `command`, which must outlive the parsing, as must all targets below.
    explicit OptionTable(CLI::App& command) : command_(command) {}

    // An option, `names` being such as "--size" or "-o,--output"; or, with a name in capitals and no form, an
    // argument that is required at its place. `parse` turns the text, which may be empty, into the target's
    // value; it throws Error(Argument) for an invalid one.
    template <typename Target, typename Parse>
    void value(const std::string& names, const std::string& form, const std::string& help, Target& target,
               const Parse& parse) {
        read(names, form, help, [&target, parse](const std::string& text) { target = parse(text); });
    }

    // A text that is not empty: the name of a file (form FILE), a folder (FOLDER), a camera or a device.
    template <typename Target>
    void name(const std::string& names, const std::string& form, const std::string& help, Target& target) {
        value(names, form, help, target, parseName);
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

    // Takes no value: `target` becomes `value`.
    void flag(const std::string& names, const std::string& help, bool& target, bool value = true);

    // One or more files without an option's name.
    void files(const std::string& name, const std::string& help, std::vector<std::filesystem::path>& target);

    // An option whose text goes to a function.
    void read(const std::string& names, const std::string& form, const std::string& help,
              const std::function<void(const std::string& text)>& use);

    // Accepts, and ignores, words and options that are not declared.
    void acceptAll();

    // The command requires `option`, which is declared before.
    void require(const std::string& option);
    // Each of `options`, all of them declared before, requires `needed`.
    void require(const std::string& needed, const std::vector<std::string>& options);
    // Refuses `other` together with `option`; both are declared before. `remedy` names the alternative.
    void exclude(const std::string& option, const std::string& other, const std::string& remedy);
    // Refuses these options, all of them declared before, with --backend cpu, which would ignore them.
    void requireGpu(const std::vector<std::string>& options);

  private:
    // CLI11's own look-up is noexcept and ends the program if memory is short.
    CLI::Option& optionNamed(const std::string& name);

    CLI::App& command_;
};

// The scene, and the wishes of the command line.
struct SceneOptions {
    std::filesystem::path scene;
    LoadOptions loading;  // its memory is the available one
    std::optional<Size> size;
    std::optional<int> spp;
    BuildQuality buildQuality = BuildQuality::Default;
    Methods methods;
    PathLimits limits;
    std::optional<Sampler> sampler;
    std::optional<FilterChoice> filter;
    std::optional<uint32_t> seed;
    std::optional<AdaptiveSampling> adaptive;
    std::optional<double> time;  // of the animation, seconds; empty: the scene as its file says it
};

struct DeviceChoice {
    Backend backend = Backend::Gpu;  // the other members are the device's
    std::string selector;
    bool validation = false;
    render::Traversal traversal = render::Traversal::Auto;
    bool reproducible = false;  // render::Options::ownArithmetic
};

// Options that several commands share, with the same names, texts and values in each.
void addScene(OptionTable& table, SceneOptions& options,  // one SCENE
              const std::string& more = "; - reads JSON from standard input");
// One or more; `options` are those of each.
void addScenes(OptionTable& table, std::vector<std::filesystem::path>& scenes, SceneOptions& options);
// --size, --spp, --max-depth, --build-quality, --camera, --up, --time
void addSceneOverrides(OptionTable& table, SceneOptions& options,
                       const std::string& defaultSize = "the scene's");
void addCamera(OptionTable& table, SceneOptions& options);      // --camera, --up
void addCameraName(OptionTable& table, SceneOptions& options);  // --camera
void addMethods(OptionTable& table, SceneOptions& options);     // --intersector, --sphere
void addMinContribution(OptionTable& table, SceneOptions& options);
void addSampling(OptionTable& table, SceneOptions& options);  // --sampler, --filter, --seed, --adaptive
void addExposure(OptionTable& table, std::optional<double>& stops);
void addBackend(OptionTable& table, DeviceChoice& device);
void addDevice(OptionTable& table, DeviceChoice& device);  // --device, --validation, --threads
void addTraversal(OptionTable& table, DeviceChoice& device);
void addProgress(OptionTable& table, ProgressMode& mode);
// --stats json; `help` lists its contents.
void addStats(OptionTable& table, const std::string& help, bool& json);

// --error, --confidence, --within-depth; the last two require the first.
void addError(OptionTable& table, converge::Target& target);

}  // namespace glint::app
