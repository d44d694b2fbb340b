#include "app/cli.h"

#include <CLI/CLI.hpp>
#include <memory>
#include <new>
#include <ostream>

#include "app/exit_code.h"
#include "app/options.h"
#include "app/usage.h"
#include "core/enum_names.h"
#include "core/error.h"
#include "core/near_names.h"
#include "report/plan.h"
#include "scene/limits.h"

namespace glint::app {

namespace {

constexpr const char* kFooter =
    "Examples:\n"
    "  glint render scenes/spheres.json -o spheres.png --size 1280x960\n"
    "  glint render bunny.ply --backend cpu\n"
    "  glint verify scenes/spheres.json\n"
    "\n"
    "glint COMMAND --help tells a command's options.\n"
    "Exit codes: 0 done, 1 could not render or write, 2 usage, 3 the scene is at fault, 4 no usable device,\n"
    "5 difference found, 130 interrupted.";

using Text = std::string;

// Each option hands its text, empty or not, to `use`, which throws Error(Usage) for what it cannot be.
template <typename Use>
CLI::Option* addText(CLI::App& command, const char* names, const char* form, const Text& description,
                     Use use) {
    return command.add_option_function<Text>(names, use, description)->type_name(form);
}

Text parseStats(const Text& text) {
    if (text != "json") throw Error(ErrorKind::Argument, "--stats: expected json, got " + quoted(text));
    return text;
}

// An option that takes one of an enumeration's names.
template <NamedEnum E, typename Target>
void addNamed(CLI::App& command, const char* name, const Text& description, Target& target) {
    addText(command, name, alternatives<E>().c_str(), description,
            [&target, name](const Text& t) { target = parseNamed<E>(name, t); });
}

void addFlag(CLI::App& command, const char* names, bool& flag, const Text& description) {
    command.add_flag(names, flag, description)->disable_flag_override();
}

void addScene(CLI::App& command, SceneOptions& options) {
    addText(command, "SCENE", "", "a scene (.json .gltf .glb .nff) or a model alone (.obj .ply .stl)",
            [&](const Text& t) { options.scene = t; })
        ->required();
}

void addSceneOverrides(CLI::App& command, SceneOptions& options) {
    addText(command, "--size", "WxH", "size in pixels instead of the scene's",
            [&](const Text& t) { options.size = parseSize(t); });
    addText(command, "--spp", "N", "samples for each pixel instead of the scene's",
            [&](const Text& t) { options.spp = parseWhole("--spp", t, 1, kMaxSamplesPerPixel); });
    addText(command, "--max-depth", "N",
            "greatest number of reflections and refractions in a row instead of the scene's",
            [&](const Text& t) { options.maxDepth = parseWhole("--max-depth", t, 0, kMaxBounces); });
    addNamed<BuildQuality>(command, "--build-quality",
                           "time spent on the BVH: " + explainedChoices<BuildQuality>(),
                           options.buildQuality);
}

void addMethods(CLI::App& command, SceneOptions& options) {
    addNamed<TriangleMethod>(
        command, "--intersector",
        "test of triangles: all but the default, watertight, are textbooks', with their faults",
        options.methods.triangles);
    addNamed<SphereMethod>(command, "--sphere",
                           "test of spheres: all but the default, robust, are textbooks', with their faults",
                           options.methods.spheres);
}

void addMinContribution(CLI::App& command, SceneOptions& options) {
    addText(command, "--min-contribution", "X",
            "do not follow reflected and refracted rays that can add no more than X to a pixel (default 0: "
            "follow all)",
            [&](const Text& t) { options.minContribution = parseMinContribution(t); });
}

void addSampling(CLI::App& command, SceneOptions& options) {
    addNamed<Sampler>(command, "--sampler", "where the samples of a pixel lie, instead of the scene's",
                      options.sampler);
    addText(command, "--filter", "NAME[,RADIUS]",
            choices<Filter>() + " instead of the scene's; radius in pixels",
            [&](const Text& t) { options.filter = parseFilter(t); });
    addText(command, "--seed", "N", "of the jittered and the lowDiscrepancy sampler, instead of the scene's",
            [&](const Text& t) { options.seed = parseSeed(t); });
    addText(command, "--adaptive", "MAX[,THRESHOLD]",
            "up to MAX samples for pixels whose samples differ, see docs/guide/sampling.md",
            [&](const Text& t) { options.adaptive = parseAdaptive(t); });
}

void addDevice(CLI::App& command, DeviceChoice& device) {
    addText(command, "--device", "NAME|INDEX",
            "index or part of the name, see glint devices (default: the best)",
            [&](const Text& t) { device.selector = t; });
    command.add_flag("--validation", device.validation,
                     "run the Vulkan validation layer; its messages are errors");
}

void addTraversal(CLI::App& command, DeviceChoice& device) {
    addNamed<render::Traversal>(
        command, "--traversal",
        "how the device finds hits: ray by ray, by packets of rays, or ray by ray in a wide tree "
        "(default auto: see glint info)",
        device.traversal);
}

void addBackend(CLI::App& command, Backend& backend) {
    addNamed<Backend>(command, "--backend",
                      "gpu (default), or cpu: the double-precision reference, needs no Vulkan", backend);
}

void addProgress(CLI::App& command, ProgressMode& mode) {
    addNamed<ProgressMode>(command, "--progress", "on standard error (default auto: a bar on a terminal)",
                           mode);
}

void addRender(CLI::App& app, RenderCommand& c) {
    CLI::App& command = *app.add_subcommand("render", "render a scene to a picture");
    addScene(command, c.scene);
    addText(command, "-o,--output", "FILE",
            "picture to write: .png .exr .pfm .hdr (default: SCENE's name with .png, here)",
            [&](const Text& t) {
                if (t.empty()) throw Error(ErrorKind::Argument, "--output: the file name is empty");
                c.output = t;
            });
    addSceneOverrides(command, c.scene);
    addMethods(command, c.scene);
    addMinContribution(command, c.scene);
    addSampling(command, c.scene);
    addBackend(command, c.backend);
    addDevice(command, c.device);
    addTraversal(command, c.device);
    addText(command, "--aov", "LIST",
            "layers, with commas: " + joinNames(kEnumNames<Aov>) +
                "; an EXR holds them all, other formats get a file for each",
            [&](const Text& t) { c.aovs = parseAovs(t); });
    addText(command, "--crop", "x0,y0,x1,y1",
            "only the pixels x0 <= x < x1, y0 <= y < y1, from the top left corner",
            [&](const Text& t) { c.crop = parseCrop(t); });
    addText(command, "--stats", "json", "times and counts as JSON on standard output, instead of the summary",
            [&](const Text& t) { c.stats = parseStats(t); });
    addProgress(command, c.progress);
    addFlag(command, "-q,--quiet", c.quiet, "print nothing but errors (and what --stats asks for)");
}

void addView(CLI::App& app, ViewCommand& c) {
    CLI::App& command = *app.add_subcommand("view", "a window to look around a scene in");
    addScene(command, c.scene);
    addSceneOverrides(command, c.scene);
    addDevice(command, c.device);
    addText(command, "--frames", "N", "close after N frames (and the script's end)", [&](const Text& t) {
        c.frames = static_cast<uint64_t>(parseWhole("--frames", t, 1, 1'000'000));
    });
    addText(command, "--script", "FILE", "drive the window without a person, see docs/guide/window.md",
            [&](const Text& t) {
                if (t.empty()) throw Error(ErrorKind::Argument, "--script: the file name is empty");
                c.script = t;
            });
    addText(command, "--present", "MODE",
            "fifo (default), mailbox, immediate; fifo where the screen has no other", [&](const Text& t) {
                if (t != "fifo" && t != "mailbox" && t != "immediate")
                    throw Error(ErrorKind::Argument,
                                "--present: expected fifo, mailbox or immediate, got " + quoted(t));
                c.present = t;
            });
    addText(command, "--target", "MS", "milliseconds a frame to aim for while the camera moves",
            [&](const Text& t) { c.target = parseWhole("--target", t, 1, 10'000); });
}

void addScenes(CLI::App& command, std::vector<std::filesystem::path>& scenes) {
    command
        .add_option_function<std::vector<Text>>(
            "SCENE", [&](const std::vector<Text>& list) { scenes.assign(list.begin(), list.end()); },
            "scenes or models")
        ->type_name("")
        ->required();
}

CLI::Option* addFolder(CLI::App& command, const char* description, std::filesystem::path& folder) {
    return addText(command, "-o,--output", "FOLDER", description, [&](const Text& t) {
        if (t.empty()) throw Error(ErrorKind::Argument, "--output: the folder's name is empty");
        folder = t;
    });
}

void addVerify(CLI::App& app, VerifyCommand& c) {
    CLI::App& command =
        *app.add_subcommand("verify", "compare the shaders' picture with the reference's, pixel by pixel");
    addScenes(command, c.scenes);
    addFolder(command, "for the difference pictures NAME.verify.png (default: here)", c.folder);
    addSceneOverrides(command, c.common);
    addMethods(command, c.common);
    addMinContribution(command, c.common);
    addSampling(command, c.common);
    addDevice(command, c.device);
    addTraversal(command, c.device);
    addProgress(command, c.progress);
}

void addReport(CLI::App& app, ReportCommand& c) {
    CLI::App& command =
        *app.add_subcommand("report", "error against run time, for many settings of each scene");
    addScenes(command, c.scenes);
    addFolder(command, "for report.html, report.csv, report.json and the diagrams", c.folder)->required();
    addText(command, "--size", "WIDTH", "of the pictures in pixels (default 160); the height follows",
            [&](const Text& t) { c.width = parseWhole("--size", t, 4, 4096); });
    addText(command, "--repeats", "N", "runs of each setting (default 5)",
            [&](const Text& t) { c.repeats = parseWhole("--repeats", t, 1, 1000); });
    addText(command, "--truth-spp", "N", "samples for each pixel of the converged picture (default 256)",
            [&](const Text& t) { c.truthSamples = parseWhole("--truth-spp", t, 1, kMaxSamplesPerPixel); });
    addNamed<Backend>(
        command, "--truth",
        "who draws the converged picture: the double-precision reference (cpu, default) or the device",
        c.truth);
    addText(command, "--budget", "SECONDS", "after which no further setting is started",
            [&](const Text& t) { c.budget = parseWhole("--budget", t, 0, 10'000'000); });
    const auto& families = report::familyStarts();
    addText(command, "--only", "LIST",
            "with commas, the settings to measure: " +
                joinNames(std::vector<std::string_view>(families.begin(), families.end())),
            [&](const Text& t) { c.only = parseFamilies(t); });
    addDevice(command, c.device);
    addProgress(command, c.progress);
}

void addBench(CLI::App& app, BenchCommand& c) {
    CLI::App& command = *app.add_subcommand(
        "bench", "rays a second for each class of rays, and the time that each stage takes");
    addScenes(command, c.scenes);
    addSceneOverrides(command, c.common);
    addMethods(command, c.common);
    addMinContribution(command, c.common);
    addBackend(command, c.backend);
    addDevice(command, c.device);
    addText(command, "--traversal", (alternatives<render::Traversal>() + "|all").c_str(),
            "how the device finds hits (default auto: see glint info); all: each way in turn besides",
            [&](const Text& t) {
                c.everyWalk = t == "all";
                c.device.traversal =
                    c.everyWalk ? render::Traversal::Auto : parseNamed<render::Traversal>("--traversal", t);
            });
    addNamed<render::Compaction>(
        command, "--compaction",
        "after a bounce, whether kernels run over the paths that go on alone (default auto: if fewer)",
        c.compaction);
    addText(command, "--repeat", "N", "pictures to take the median of, after the warm-up (default 7)",
            [&](const Text& t) { c.repeats = parseWhole("--repeat", t, 1, 1000); });
    addText(command, "--with", "LIST",
            "features, with commas, whose code the pipeline is to hold though the scene needs none of it "
            "(names: glint info)",
            [&](const Text& t) { c.with = parseFeatures(t); });
    addFlag(command, "--full", c.full, "the code of every feature");
    addText(command, "--stats", "json", "the results as JSON on standard output, instead of tables",
            [&](const Text& t) { c.stats = parseStats(t); });
    addProgress(command, c.progress);
}

void addTrace(CLI::App& app, TraceCommand& c) {
    CLI::App& command = *app.add_subcommand("trace", "trace single rays and print what they hit as CSV");
    addScene(command, c.scene);
    addText(command, "--rays", "FILE.csv",
            "rays, one a line: ox,oy,oz,dx,dy,dz[,tmin[,tmax]]; - for standard input", [&](const Text& t) {
                if (t.empty()) throw Error(ErrorKind::Argument, "--rays: the file name is empty");
                c.rays = t;
            });
    addText(command, "--pixel", "x,y", "the camera ray of a pixel, from the top left corner",
            [&](const Text& t) { c.pixel = parsePixel(t); });
    addFlag(command, "--any", c.any, "only whether anything is hit");
    addText(command, "--size", "WxH", "size of the picture that --pixel counts in, instead of the scene's",
            [&](const Text& t) { c.scene.size = parseSize(t); });
    addMethods(command, c.scene);
    addBackend(command, c.backend);
    addDevice(command, c.device);
    addTraversal(command, c.device);
}

void addDiff(CLI::App& app, DiffCommand& c) {
    CLI::App& command =
        *app.add_subcommand("diff", "how far apart two pictures are; exit code 5 if they differ");
    addText(command, "A", "", "picture: .png .exr .pfm .hdr .jpg", [&](const Text& t) {
        c.a = t;
    })->required();
    addText(command, "B", "", "picture of the same size", [&](const Text& t) { c.b = t; })->required();
    addText(command, "-o,--output", "FILE", "picture of |A - B| to write", [&](const Text& t) {
        if (t.empty()) throw Error(ErrorKind::Argument, "--output: the file name is empty");
        c.output = t;
    });
    addText(command, "--tolerance", "X",
            "greatest difference, on linear values, that still counts as equal (default 0)",
            [&](const Text& t) { c.tolerance = parseTolerance(t); });
}

class HelpFormatter : public CLI::Formatter {
    std::string make_usage(const CLI::App* app, std::string name) const override {
        return app->get_parent() == nullptr ? "Usage: glint COMMAND [OPTIONS]\n"
                                            : Formatter::make_usage(app, name);
    }
};

struct Commands {
    RenderCommand render;
    ViewCommand view;
    VerifyCommand verify;
    ReportCommand report;
    BenchCommand bench;
    TraceCommand trace;
    DiffCommand diff;
    SceneOptions info;
};

void addCommands(CLI::App& app, Commands& c) {
    app.formatter(std::make_shared<HelpFormatter>());  // commands added from here on inherit it
    app.set_version_flag("--version", "glint " GLINT_VERSION, "print the version and exit");
    app.set_help_flag("-h,--help", "print this help and exit");
    app.require_subcommand(0, 1);
    app.get_formatter()->label("REQUIRED", "");
    app.get_formatter()->column_width(34);
    addRender(app, c.render);
    addView(app, c.view);
    addVerify(app, c.verify);
    addReport(app, c.report);
    addBench(app, c.bench);
    addTrace(app, c.trace);
    addDiff(app, c.diff);
    CLI::App& info = *app.add_subcommand("info", "what a scene holds, and what its pipeline leaves out");
    addScene(info, c.info);
    addSceneOverrides(info, c.info);
    addMethods(info, c.info);
    app.add_subcommand("devices", "the Vulkan devices, chosen or refused and why");
    for (CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
        command->group("Commands");
    app.footer(kFooter);  // after the commands, which would inherit it
}

// The reference runs on no device: options for one would be without effect, which is never what was meant.
void checkDeviceOptions(Backend backend, const DeviceChoice& device) {
    if (backend == Backend::Gpu) return;
    if (!device.selector.empty()) throw Error(ErrorKind::Argument, "--device: needs --backend gpu");
    if (device.validation) throw Error(ErrorKind::Argument, "--validation: needs --backend gpu");
    if (device.traversal != render::Traversal::Auto)
        throw Error(ErrorKind::Argument, "--traversal: needs --backend gpu");
}

int dispatch(const CLI::App& app, const Commands& c, std::ostream& out, std::ostream& err) {
    const auto chosen = [&](const char* name) { return app.got_subcommand(name); };
    if (chosen("render")) {
        checkDeviceOptions(c.render.backend, c.render.device);
        return runRender(c.render, out, err);
    }
    if (chosen("trace")) {
        if (c.trace.rays.empty() == !c.trace.pixel)
            throw Error(ErrorKind::Argument, "trace: give either --rays FILE.csv or --pixel x,y");
        checkDeviceOptions(c.trace.backend, c.trace.device);
        return runTrace(c.trace, out, err);
    }
    if (chosen("bench")) {
        checkDeviceOptions(c.bench.backend, c.bench.device);
        if (c.bench.backend == Backend::Cpu && c.bench.everyWalk)
            throw Error(ErrorKind::Argument, "--traversal: needs --backend gpu");
        if (c.bench.backend == Backend::Cpu && (c.bench.full || c.bench.with != SceneFeatures{}))
            throw Error(ErrorKind::Argument, "--full, --with: need --backend gpu");
        if (c.bench.backend == Backend::Cpu && c.bench.compaction != render::Compaction::Auto)
            throw Error(ErrorKind::Argument, "--compaction: needs --backend gpu");
        return runBench(c.bench, out, err);
    }
    if (chosen("view")) return runView(c.view, out, err);
    if (chosen("verify")) return runVerify(c.verify, out, err);
    if (chosen("report")) return runReport(c.report, out, err);
    if (chosen("diff")) return runDiff(c.diff, out);
    if (chosen("info")) return runInfo(c.info, out, err);
    if (chosen("devices")) return runDevices(out);
    err << app.help();
    return static_cast<int>(ExitCode::Usage);
}

int parseAndRun(std::vector<std::string> args, std::ostream& out, std::ostream& err) {
    CLI::App app(
        "glint: a ray tracer in Vulkan compute shaders, checked against a double-precision reference",
        "glint");
    Commands commands;
    addCommands(app, commands);
    if (!args.empty() && args.front() == "help") {
        args.erase(args.begin());
        args.push_back("--help");
    }
    if (const std::string wrong = firstWordError(app, args); !wrong.empty())
        throw Error(ErrorKind::Argument, wrong);
    try {
        std::reverse(args.begin(), args.end());  // the order that CLI11 takes a vector in
        app.parse(args);
    } catch (const CLI::ParseError& e) {
        if (e.get_exit_code() != 0) throw Error(ErrorKind::Argument, parseErrorLine(app, e));
        app.exit(e, out, err);  // --help and --version
        return static_cast<int>(ExitCode::Done);
    }
    return dispatch(app, commands, out, err);
}

}  // namespace

int run(const std::vector<std::string>& args, std::ostream& out, std::ostream& err) {
    const auto failed = [&](ExitCode code, const std::string& message) {
        out.flush();  // results come before the error, whoever reads both
        err << "glint: " << message << std::endl;
        return static_cast<int>(code);
    };
    try {
        const int code = parseAndRun(args, out, err);
        if (!out.flush()) return failed(ExitCode::Failed, "cannot write to standard output");
        return code;
    } catch (const Error& e) {
        return failed(exitCodeOf(e.kind()), e.what());
    } catch (const std::bad_alloc&) {
        return failed(
            ExitCode::Failed,
            "not enough memory; for a large picture, ask for a smaller --size, or for parts with --crop");
    } catch (const std::exception& e) {
        return failed(ExitCode::Failed, e.what());
    }
}

}  // namespace glint::app
