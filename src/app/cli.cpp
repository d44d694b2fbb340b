#include "app/cli.h"

#include <CLI/CLI.hpp>
#include <charconv>
#include <functional>
#include <ostream>

#include "core/error.h"

namespace glint::app {

namespace {

Error usage(const std::string& message) { return Error(ExitCode::Usage, message); }

// Whole numbers separated by `separator`, exactly `count` of them.
std::vector<int> parseInts(const std::string& option, const std::string& text, char separator, size_t count,
                           const char* form) {
    std::vector<int> values;
    const char* at = text.data();
    const char* const end = at + text.size();
    while (values.size() < count) {
        int value = 0;
        const auto [next, error] = std::from_chars(at, end, value);
        if (error != std::errc()) break;
        values.push_back(value);
        at = next;
        if (values.size() < count && (at == end || *at++ != separator)) break;
    }
    if (values.size() != count || at != end) throw usage(option + ": expected " + form + ", got \"" + text + "\"");
    return values;
}

std::vector<std::string> splitList(const std::string& text) {
    std::vector<std::string> items;
    size_t start = 0;
    while (start <= text.size()) {
        const size_t comma = std::min(text.find(',', start), text.size());
        if (comma > start) items.push_back(text.substr(start, comma - start));
        start = comma + 1;
    }
    return items;
}

// What CLI11 collects as text, turned into the commands' own types once parsing is over.
struct Texts {
    std::string size, crop, pixel, aovs, backend = "gpu", progress = "auto", seed;
    int spp = 0, maxDepth = -1;
};

void addSceneOptions(CLI::App& command, SceneOptions& options, Texts& texts, bool withScene = true) {
    if (withScene) {
        command.add_option("SCENE", options.scene, "a glint scene (.json) or a model (.obj .ply)")->required();
    }
    command.add_option("--size", texts.size, "WxH: picture size in pixels instead of the scene's");
    command.add_option("--spp", texts.spp, "samples for each pixel instead of the scene's")
        ->check(CLI::Range(1, 65536));
    command.add_option("--max-depth", texts.maxDepth, "greatest number of reflections instead of the scene's")
        ->check(CLI::Range(0, 1000));
}

void addDeviceOptions(CLI::App& command, DeviceChoice& device) {
    command.add_option("--device", device.selector, "index or part of the name, see `glint devices`");
    command.add_flag("--validation", device.validation, "run the Vulkan validation layer and report its messages");
}

void addProgress(CLI::App& command, Texts& texts) {
    command.add_option("--progress", texts.progress, "auto (default: a bar on a terminal), bar, plain or none");
}

void addBackend(CLI::App& command, Texts& texts) {
    command.add_option("--backend", texts.backend, "gpu (default) or cpu: the double-precision reference, needs no Vulkan")
        ->check(CLI::IsMember({"gpu", "cpu"}));
}

void finishSceneOptions(SceneOptions& options, const Texts& texts) {
    if (!texts.size.empty()) {
        const auto v = parseInts("--size", texts.size, 'x', 2, "WxH such as 640x480");
        if (v[0] < 1 || v[1] < 1 || v[0] > 65536 || v[1] > 65536) {
            throw usage("--size: width and height must be 1 to 65536, got \"" + texts.size + "\"");
        }
        options.size = {v[0], v[1]};
    }
    if (texts.spp > 0) options.spp = texts.spp;
    if (texts.maxDepth >= 0) options.maxDepth = texts.maxDepth;
}

Region parseCrop(const std::string& text) {
    const auto v = parseInts("--crop", text, ',', 4, "x0,y0,x1,y1");
    if (v[0] < 0 || v[1] < 0 || v[2] <= v[0] || v[3] <= v[1]) {
        throw usage("--crop: needs 0 <= x0 < x1 and 0 <= y0 < y1, got \"" + text + "\"");
    }
    return {v[0], v[1], v[2], v[3]};
}

Backend parseBackend(const std::string& text) { return text == "cpu" ? Backend::Cpu : Backend::Gpu; }

void addRender(CLI::App& app, RenderCommand& c, Texts& t) {
    CLI::App& command = *app.add_subcommand("render", "render a scene to a picture");
    addSceneOptions(command, c.scene, t);
    command.add_option("-o,--output", c.output, "picture to write: .png .exr .pfm .hdr (default: SCENE's name with .png)");
    addBackend(command, t);
    addDeviceOptions(command, c.device);
    command.add_option("--aov", t.aovs,
                       "layers, separated by commas: color alpha depth position normal uv object primitive material bounces cost");
    command.add_option("--crop", t.crop, "x0,y0,x1,y1: only these pixels, from the top left corner");
    command.add_option("--seed", t.seed, "not in this version: the sample pattern has no randomness");
    command.add_option("--stats", c.stats, "json: times and counts as JSON on standard output")->check(CLI::IsMember({"json"}));
    addProgress(command, t);
    command.add_flag("-q,--quiet", c.quiet, "print nothing but errors");
}

void addVerify(CLI::App& app, VerifyCommand& c, Texts& t) {
    CLI::App& command = *app.add_subcommand("verify", "compare the shaders' picture with the reference's, pixel by pixel");
    command.add_option("SCENE", c.scenes, "scenes or models")->required();
    addSceneOptions(command, c.common, t, false);
    addDeviceOptions(command, c.device);
    command.add_option("-o,--output", c.folder, "folder for the difference pictures STEM.verify.png (default: the current one)");
    addProgress(command, t);
}

void addTrace(CLI::App& app, TraceCommand& c, Texts& t) {
    CLI::App& command = *app.add_subcommand("trace", "trace single rays and print what they hit as CSV");
    addSceneOptions(command, c.scene, t);
    auto* rays = command.add_option("--rays", c.rays, "CSV file of rays, - for standard input: ox,oy,oz,dx,dy,dz[,tmin[,tmax]]");
    command.add_option("--pixel", t.pixel, "x,y: the camera ray of a pixel, from the top left corner")->excludes(rays);
    command.add_flag("--any", c.any, "only whether anything is hit");
    addBackend(command, t);
    addDeviceOptions(command, c.device);
}

void addDiff(CLI::App& app, DiffCommand& c) {
    CLI::App& command = *app.add_subcommand("diff", "how far apart two pictures are; exit code 5 if they differ");
    command.add_option("A", c.a, "picture: .png .exr .pfm .hdr")->required();
    command.add_option("B", c.b, "picture of the same size")->required();
    command.add_option("-o,--output", c.output, "picture of |A - B| to write");
    command.add_option("--tolerance", c.tolerance, "greatest difference that still counts as equal (default 0)")
        ->check(CLI::NonNegativeNumber);
}

struct Commands {
    RenderCommand render;
    VerifyCommand verify;
    TraceCommand trace;
    DiffCommand diff;
    SceneOptions info;
    Texts texts;
};

int dispatch(const CLI::App& app, Commands& c, std::ostream& out, std::ostream& err) {
    const auto chosen = [&](const char* name) { return app.got_subcommand(name); };
    const Texts& t = c.texts;
    if (chosen("render")) {
        if (!t.seed.empty()) {
            throw usage("--seed: this version samples each pixel on a fixed pattern, which has no seed; leave --seed out");
        }
        finishSceneOptions(c.render.scene, t);
        c.render.backend = parseBackend(t.backend);
        c.render.aovs = splitList(t.aovs);
        if (!t.crop.empty()) c.render.crop = parseCrop(t.crop);
        c.render.progress = parseProgressMode(t.progress);
        return runRender(c.render, out, err);
    }
    if (chosen("verify")) {
        finishSceneOptions(c.verify.common, t);
        c.verify.progress = parseProgressMode(t.progress);
        return runVerify(c.verify, out, err);
    }
    if (chosen("trace")) {
        finishSceneOptions(c.trace.scene, t);
        c.trace.backend = parseBackend(t.backend);
        if (!t.pixel.empty()) {
            const auto v = parseInts("--pixel", t.pixel, ',', 2, "x,y");
            c.trace.pixel = {v[0], v[1]};
        }
        if (c.trace.rays.empty() && !c.trace.pixel) throw usage("trace: give --rays FILE.csv or --pixel x,y");
        return runTrace(c.trace, out, err);
    }
    if (chosen("diff")) return runDiff(c.diff, out);
    if (chosen("info")) {
        finishSceneOptions(c.info, t);
        return runInfo(c.info, out, err);
    }
    if (chosen("devices")) return runDevices(out);
    for (const char* later : {"view", "report", "bench"}) {
        if (chosen(later)) throw usage(std::string(later) + ": not in this version (glint render, verify, trace, diff, info and devices are)");
    }
    out << app.help();
    return static_cast<int>(ExitCode::Usage);
}

}  // namespace

int run(const std::vector<std::string>& args, std::ostream& out, std::ostream& err) {
    CLI::App app("glint: a ray tracer in Vulkan compute shaders, checked against a double-precision reference", "glint");
    app.set_version_flag("--version", "glint " GLINT_VERSION);
    app.require_subcommand(0, 1);
    Commands commands;
    addRender(app, commands.render, commands.texts);
    addVerify(app, commands.verify, commands.texts);
    addTrace(app, commands.trace, commands.texts);
    addDiff(app, commands.diff);
    addSceneOptions(*app.add_subcommand("info", "what a scene holds, and what its pipeline leaves out"), commands.info, commands.texts);
    app.add_subcommand("devices", "the Vulkan devices, chosen or refused and why");
    for (const char* later : {"view", "report", "bench"}) {
        app.add_subcommand(later, "not in this version")->group("")->allow_extras();
    }
    try {
        std::vector<std::string> reversed(args.rbegin(), args.rend());  // what CLI11's parse(vector) takes
        app.parse(reversed);
        return dispatch(app, commands, out, err);
    } catch (const CLI::ParseError& e) {
        if (e.get_exit_code() == 0) {
            app.exit(e, out, err);
            return 0;
        }
        err << "glint: " << e.what() << " (see glint --help)\n";
        return static_cast<int>(ExitCode::Usage);
    } catch (const Error& e) {
        err << "glint: " << e.what() << '\n';
        return static_cast<int>(e.code());
    } catch (const std::bad_alloc&) {
        err << "glint: out of memory\n";
        return static_cast<int>(ExitCode::Failed);
    } catch (const std::exception& e) {
        err << "glint: " << e.what() << '\n';
        return static_cast<int>(ExitCode::Failed);
    }
}

}  // namespace glint::app
