#include "app/render_command.h"

#include <algorithm>
#include <functional>
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
#include "core/text_file.h"

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

// Renders the frames that do not exist yet.
class FrameRenderer {
  public:
    FrameRenderer(const RenderCommand& command, std::ostream& out, std::ostream& err)
        : command_(command),
          out_(out),
          err_(err),
          frames_(framesToDraw(command)),
          there_(static_cast<size_t>(command.frames->last - command.frames->first + 1) - frames_.size()),
          drawing_(command.backend, command.device, err) {}

    ExitCode run() {
        const bool complete = frames_.empty() || drawAll();
        if (command_.json)
            printStats();
        else if (!command_.quiet)
            printSummary();
        drawing_.checkValidation();
        if (!complete)
            throw Error(ErrorKind::Interrupted, "interrupted: " + std::to_string(there_ + drawn_.size()) +
                                                    " of " + std::to_string(there_ + frames_.size()) +
                                                    " frames exist; repeat the command to resume");
        return missed_ && command_.target.strict ? ExitCode::Difference : ExitCode::Done;
    }

  private:
    double timeOf(int frame) const { return frame / framesPerSecond_; }

    // The frame rate may be the scene's own, so the scene is read before the time of the first frame is
    // known.
    void open() {
        scene_.emplace(command_.scene, std::nullopt, err_);
        const LoadedScene& loaded = scene_->loaded();
        const auto& animation = loaded.scene.animation;
        framesPerSecond_ = command_.framesPerSecond.value_or(animation ? animation->framesPerSecond : 24);
        if (!animation && command_.frames->first != command_.frames->last)
            err_ << "glint: warning: " << shown(command_.scene.scene)
                 << ": has no animation; all frames are the same image\n";
        const Region region = requestOf(command_, loaded).region;
        checkMemory(region.width(), region.height(), 2 * bytesPerPixel(command_), availableMemory());
        scene_->moveTo(timeOf(frames_.front().number));
    }

    // False if it was interrupted.
    bool drawAll() {
        open();
        installInterruptHandler();
        Progress progress = progressOf("render " + counted(frames_.size(), "frame"), command_.progress, err_);
        for (size_t i = 0; i < frames_.size(); ++i) {
            const auto show = [&](double done) {
                progress.update((static_cast<double>(i) + done) / static_cast<double>(frames_.size()));
            };
            if (interrupted() || !drawOne(frames_[i], show)) return false;
        }
        return true;
    }

    bool drawOne(const Frame& frame, const std::function<void(double)>& show) {
        const Stopwatch watch;
        const LoadedScene& loaded = scene_->loaded();
        using Change = AnimatedScene::Change;
        const double time = timeOf(frame.number);
        const bool first = drawn_.empty();
        const Change change = first ? Change::Scene : scene_->moveTo(time);
        Outcome outcome;
        Request request = outcome.request = requestOf(command_, loaded);
        request.progress = show;
        std::optional<converge::Job> job;
        if (command_.target.error) job = jobOf(command_.target, loaded, command_.backend, request);
        if (first)
            drawing_.load(loaded, request);
        else if (change != Change::Nothing)
            drawing_.reload(request, change == Change::Camera);
        outcome.output = frame.path;
        outcome.picture = drawing_.draw(request, job, outcome.converged);
        const bool cut = outcome.converged && outcome.converged->stop == converge::Stop::Interrupted;
        // The next run would skip an incomplete frame as finished.
        if (!outcome.picture.complete || cut) return false;
        missed_ = missed_ || (outcome.converged && !outcome.converged->reached());
        adviseOn(outcome, command_, loaded);
        warnAboutPicture(outcome, command_, loaded, err_);
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

    void printStats() const {
        nlohmann::json json = drawnJson(drawing_.facts());
        json.update({{"scene", command_.scene.scene.string()},
                     {"there", there_},
                     {"treesBuilt", scene_ ? scene_->treesBuilt() : 0},
                     {"seconds", total_.seconds()},
                     {"frames", drawn_}});
        printJson(json, out_);
    }

    void printSummary() const {
        const size_t count = drawn_.size();
        const auto fileOf = [&](size_t i) { return shown(drawn_[i]["files"][0].get<std::string>()); };
        if (count > 0)
            out_ << "wrote " << counted(count, "frame") << ", " << fileOf(0)
                 << (count > 1 ? " to " + fileOf(count - 1) : "") << '\n';
        if (there_ > 0)
            out_ << counted(there_, "frame") << (there_ == 1 ? " was" : " were")
                 << " there already (--overwrite renders them again)\n";
        printDevice(drawing_.facts(), out_);
        out_ << "times: " << formatSeconds(total_.seconds()) << " in all";
        if (count > 0)
            out_ << ", " << formatSeconds(total_.seconds() / static_cast<double>(count)) << " a frame";
        out_ << '\n';
    }

    const RenderCommand& command_;
    std::ostream& out_;
    std::ostream& err_;
    const std::vector<Frame> frames_;
    const size_t there_;  // frames that existed before
    Drawing drawing_;
    std::optional<AnimatedScene> scene_;
    double framesPerSecond_ = 24;
    nlohmann::json drawn_ = nlohmann::json::array();  // a frame each, as for --stats
    bool missed_ = false;                             // an --error was not reached
    const Stopwatch total_;
};

}  // namespace

ExitCode renderFrames(const RenderCommand& command, std::ostream& out, std::ostream& err) {
    check(command);
    return FrameRenderer(command, out, err).run();
}

}  // namespace glint::app
