#include "view/model.h"

#include <algorithm>
#include <ostream>
#include <utility>

#include "core/text_file.h"

namespace glint::view {

void Toasts::add(const std::string& text, ToastKind kind, double now) {
    std::erase_if(toasts_, [&](const Toast& t) { return t.text == text; });
    toasts_.push_back({text, kind, now + kSeconds * (kind == ToastKind::Error ? 2 : 1)});
    while (toasts_.size() > kMost) toasts_.pop_front();
}

bool Toasts::expire(double now) {
    return std::erase_if(toasts_, [&](const Toast& t) { return t.until <= now; }) > 0;
}

Model::Model(const Options& start)
    : path(start.scene),
      options(start.loading),
      moments(std::make_shared<Moments>(path, options, start.time)),
      scene(moments->show().scene),
      time(start.time),
      control(scene->scene.camera, boundsOf(*scene).radius),
      hints(stateFile("hints")),
      recent(stateFile("recent")),
      docked(start.width == 0) {
    file = {scene, &scene->scene};
    settings = fileSettings = PictureSettings::of(*file);
    settings.until = start.until;
    timeline.follow(file->animation);
    timeline.setTime(time);
    for (size_t i = 0; i < file->cameras.size(); ++i)
        if (file->cameras[i].name == options.camera) camera = i;
    openFolder = std::filesystem::absolute(path).parent_path();
    recent.add(path);
    history.reset(undoable());
}

void Model::say(const std::string& text, ToastKind kind) {
    toasts.add(text, kind, clock.seconds());
    dirty = 3;
}

void Model::keepCamera() {
    const auto taken = [](const std::vector<NamedCamera>& list, const std::string& name) {
        return std::any_of(list.begin(), list.end(), [&](const NamedCamera& c) { return c.name == name; });
    };
    std::string name;
    for (size_t i = 1; name.empty() || taken(file->cameras, name) || taken(bookmarks, name); ++i)
        name = "bookmark " + std::to_string(i);
    bookmarks.push_back({name, control.camera()});
    camera = file->cameras.size() + bookmarks.size() - 1;
    say(name + "; N goes to the next camera");
}

const Image* Model::comparable() const {
    const bool there = session->samples() > 0 && session->width() > 0;
    return there ? &session->picture().color : nullptr;
}

bool Model::hasJsonFile() const {
    return lowerExtension(scene->path) == ".json";
}

void Model::sayWarnings(std::ostream& err) {
    warnings = file->warnings;
    warnings.insert(warnings.end(), scene->packed.warnings.begin(), scene->packed.warnings.end());
    for (const std::string& w : warnings)
        err << "glint: warning: " << scene->path.string() << ": " << w << '\n';
    dirty = 3;
}

std::string Model::waitingComparison() const {
    if (!compares() || comparison.mode == CompareMode::Wipe) return "";
    const std::string name(nameOf(comparison.mode));
    if (!comparison.fault.empty() && comparison.mode == CompareMode::Difference)
        return name + " not shown: " + comparison.fault;
    if (session->finished()) return "";
    return name + ": waiting for the last sample (" + std::to_string(session->samples()) + " of " +
           std::to_string(settings.sampleLimit) + ")";
}

bool Model::changed() const {
    const Undoable& seen = history.seen();
    return control.camera() != seen.camera || settings.lights != seen.settings.lights ||
           settings.background != seen.settings.background || settings.edits != seen.settings.edits;
}

void Model::restore(const Undoable& state) {
    control.set(state.camera);
    PictureSettings then = state.settings;
    then.follow(state.file, fileSettings);
    settings.lights = then.lights;
    settings.background = then.background;
    settings.edits = then.edits;
    forgetView();
    touch();
}

void Model::forgetView(bool evenPinned) {
    pickIsOld = pick.has_value();
    if (!pinsPick || evenPinned) pick.reset();
    difference.reset();
    verdict.clear();
}

}  // namespace glint::view
