#include "app/render_command.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <ostream>

#include "app/common.h"
#include "app/loading.h"
#include "app/render_result.h"
#include "core/available_memory.h"
#include "core/error.h"
#include "core/image_io.h"
#include "core/interrupt.h"
#include "core/stopwatch.h"

namespace glint::app {

namespace {

namespace fs = std::filesystem;

// "frame.####.png" for frame 7: "frame.0007.png". Without # the name itself.
fs::path numbered(const fs::path& pattern, int frame) {
    std::string name = pattern.filename().string();
    const size_t first = name.find('#');
    if (first == std::string::npos) return pattern;
    const size_t end = std::min(name.find_first_not_of('#', first), name.size());
    std::string digits = std::to_string(frame);
    digits.insert(0, std::max(end - first, digits.size()) - digits.size(), '0');
    fs::path path = pattern;
    return path.replace_filename(name.replace(first, end - first, digits));
}

struct Frame {
    int number = 0;
    fs::path path;
};

void check(const RenderCommand& command) {
    const FrameRange& frames = *command.frames;
    if (command.scene.time) throw Error(ErrorKind::Argument, "--time: --frames says which moments are drawn");
    const fs::path output = outputOf(command);
    if (frames.first != frames.last && output.filename().string().find('#') == std::string::npos)
        throw Error(ErrorKind::Argument,
                    output.string() +
                        ": the name of several frames has # in the place of each digit of "
                        "their number, such as frame.####.png");
    checkPicturePath(numbered(output, frames.first));
}

// Those that are not there yet; with --overwrite all.
std::vector<Frame> framesToDraw(const RenderCommand& command) {
    std::vector<Frame> frames;
    for (int number = command.frames->first; number <= command.frames->last; ++number) {
        Frame frame{number, numbered(outputOf(command), number)};
        const std::vector<fs::path> files = layerPaths(frame.path, namesOf(command.aovs));
        const bool there = std::all_of(files.begin(), files.end(), [](const fs::path& file) {
            std::error_code ignored;
            return fs::exists(file, ignored);
        });
        if (command.overwrite || !there) frames.push_back(std::move(frame));
    }
    return frames;
}

class FrameRenderer {
  public:
    FrameRenderer(const RenderCommand& command, std::ostream& out, std::ostream& err)
        : command_(command),
          out_(out),
          err_(err),
          drawing_(command.backend, command.device, command.quiet ? nullptr : &err) {}

    // False if it was interrupted.
    bool draw(const std::vector<Frame>& frames);
    ExitCode finish(size_t wanted, bool complete);

  private:
    double timeOf(int frame) const { return frame / framesPerSecond_; }
    void open(const Frame& first);
    bool drawOne(const Frame& frame, double from, double to, Progress& progress);
    void print(size_t there) const;

    const RenderCommand& command_;
    std::ostream& out_;
    std::ostream& err_;
    Drawing drawing_;
    std::optional<AnimatedScene> scene_;
    double framesPerSecond_ = 24;
    bool loaded_ = false;
    nlohmann::json drawn_ = nlohmann::json::array();  // a frame each, as for --stats
    bool missed_ = false;                             // --strict, and an error was not reached
    const Stopwatch total_;
};

// The frame rate may be the scene's own, so the scene is read before the time of the first frame is known.
void FrameRenderer::open(const Frame& first) {
    scene_.emplace(command_.scene, std::nullopt, err_, command_.quiet);
    const LoadedScene& loaded = scene_->loaded();
    const auto& animation = loaded.scene.animation;
    framesPerSecond_ = command_.framesPerSecond.value_or(animation ? animation->framesPerSecond : 24);
    if (!animation && !command_.quiet && command_.frames->first != command_.frames->last)
        err_ << "glint: warning: " << shown(command_.scene.scene)
             << ": has no animation; all frames are the same picture\n";
    const Region region = requestOf(command_, loaded).region;
    checkMemory(region.width(), region.height(), bytesPerPixel(command_.aovs, needsData(command_)),
                availableMemory());
    scene_->moveTo(timeOf(first.number));
}

bool FrameRenderer::drawOne(const Frame& frame, double from, double to, Progress& progress) {
    const Stopwatch watch;
    const LoadedScene& loaded = scene_->loaded();
    using Change = AnimatedScene::Change;
    const double time = timeOf(frame.number);
    const Change change = loaded_ ? scene_->moveTo(time) : Change::Scene;
    Request request = requestOf(command_, loaded);
    request.progress = [&](double done) { progress.update(from + (to - from) * done); };
    std::optional<converge::Job> job;
    if (command_.target.error) job = jobOf(command_.target, loaded, command_.backend, request, progress);
    if (!loaded_)
        drawing_.load(loaded, request);
    else if (change != Change::Nothing)
        drawing_.reload(request, change == Change::Camera);
    loaded_ = true;
    Outcome outcome;
    outcome.request = request;
    outcome.output = frame.path;
    outcome.picture = drawing_.draw(request, job, outcome.converged);
    const bool cut = outcome.converged && outcome.converged->stop == converge::Stop::Interrupted;
    if (!outcome.picture.complete || cut) return false;  // half a frame would pass for a whole one next time
    warnAboutPicture(outcome, command_, loaded, err_);
    missed_ = missed_ || (outcome.converged && !outcome.converged->reached());
    writePicture(outcome, command_, out_);
    constexpr const char* kChanges[] = {"nothing", "camera", "scene"};
    drawn_.push_back({{"frame", frame.number},
                      {"time", time},
                      {"hash", outcome.hash},
                      {"seconds", watch.seconds()},
                      {"changed", kChanges[static_cast<size_t>(change)]},
                      {"files", filesJson(outcome.files)}});
    return true;
}

bool FrameRenderer::draw(const std::vector<Frame>& frames) {
    if (frames.empty()) return true;
    open(frames.front());
    installInterruptHandler();
    Progress progress =
        progressOf("render " + counted(frames.size(), "frame"), command_.shownProgress(), err_);
    const auto count = static_cast<double>(frames.size());
    for (size_t i = 0; i < frames.size(); ++i) {
        const auto done = static_cast<double>(i);
        if (interrupted() || !drawOne(frames[i], done / count, (done + 1) / count, progress)) return false;
    }
    return true;
}

void FrameRenderer::print(size_t there) const {
    const DrawingFacts facts = drawing_.facts();
    if (command_.json) {
        nlohmann::json json = {{"scene", command_.scene.scene.string()},
                               {"there", there},
                               {"treesBuilt", scene_ ? scene_->treesBuilt() : 0},
                               {"seconds", total_.seconds()},
                               {"frames", drawn_}};
        json.update(drawnJson(facts));
        printJson(json, out_);
        return;
    }
    if (command_.quiet) return;
    const auto fileOf = [](const nlohmann::json& frame) {
        return shown(frame["files"][0].get<std::string>());
    };
    if (!drawn_.empty())
        out_ << "wrote " << counted(drawn_.size(), "frame") << ", " << fileOf(drawn_.front())
             << (drawn_.size() > 1 ? " to " + fileOf(drawn_.back()) : "") << '\n';
    if (there > 0)
        out_ << counted(there, "frame") << (there == 1 ? " was" : " were")
             << " there already (--overwrite draws them again)\n";
    printDevice(facts, out_);
    out_ << "times: " << formatSeconds(total_.seconds()) << " in all";
    if (!drawn_.empty())
        out_ << ", " << formatSeconds(total_.seconds() / static_cast<double>(drawn_.size())) << " a frame";
    out_ << '\n';
}

ExitCode FrameRenderer::finish(size_t wanted, bool complete) {
    const auto all = static_cast<size_t>(command_.frames->last - command_.frames->first + 1);
    print(all - wanted);
    drawing_.reportValidation(err_);
    if (!complete)
        throw Error(ErrorKind::Interrupted, "interrupted: " + std::to_string(all - wanted + drawn_.size()) +
                                                " of " + std::to_string(all) +
                                                " frames are there; the same command goes on");
    return missed_ && command_.target.strict ? ExitCode::Difference : ExitCode::Done;
}

}  // namespace

ExitCode renderFrames(const RenderCommand& command, std::ostream& out, std::ostream& err) {
    check(command);
    const std::vector<Frame> frames = framesToDraw(command);
    FrameRenderer renderer(command, out, err);
    return renderer.finish(frames.size(), renderer.draw(frames));
}

}  // namespace glint::app
