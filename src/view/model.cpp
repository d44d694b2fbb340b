#include "view/model.h"

#include <chrono>
#include <cmath>
#include <ostream>

#include "core/format.h"
#include "gpu/device.h"
#include "view/window.h"

namespace glint::view {

namespace {

std::string shadowText(const std::vector<uint8_t>& occluded) {
    std::string text;
    for (size_t i = 0; i < occluded.size(); ++i)
        if (occluded[i] != 0) text += ' ' + std::to_string(i);
    return text.empty() ? "" : ", in shadow of light" + text;
}

const char* nameOfRay(reference::RayClass kind) {
    if (kind == reference::RayClass::Mirrored) return "reflected";
    return kind == reference::RayClass::Refracted ? "transmitted" : "eye";
}

std::string rayText(const Scene& scene, const reference::Bounce& bounce) {
    const std::string ray = nameOfRay(bounce.kind);
    if (!bounce.hit || !bounce.surface) return ray + ": nothing (background)";
    return ray + ": " + objectName(scene, bounce.surface->object) +
           format(" face %u, t = %.6g, ", bounce.surface->primitive, bounce.hit->t) +
           materialName(scene, bounce.surface->material) + shadowText(bounce.occluded);
}

std::vector<PickRay> raysOf(const ViewScene& scene, const reference::PixelRecord& record) {
    const double whole = luminance(record.color);
    const double far = 2 * boundsOf(scene).radius;  // drawn length of a ray that hits nothing
    std::vector<PickRay> rays;
    for (const reference::Bounce& bounce : record.path) {
        const glm::dvec3 from = scene.packed.origin + bounce.ray.origin;
        const glm::dvec3 to = bounce.hit ? scene.packed.origin + bounce.surface->position
                                         : from + far * glm::normalize(bounce.ray.direction);
        rays.push_back({bounce.kind, bounce.depth, from, to, whole > 0 ? luminance(bounce.light) / whole : 0,
                        rayText(scene.scene, bounce)});
    }
    return rays;
}

}  // namespace

Pick pickPixel(Session& session, int x, int y) {
    Pick pick{x, y, session.pixel(x, y), {}};
    const PackedScene& packed = session.scene()->packed;
    const Request request = session.request();
    const reference::Tracer tracer(packed, request);
    const reference::Ray ray = tracer.cameraRay(cameraOf(packed, request), x + 0.5, y + 0.5);
    pick.rays = raysOf(*session.scene(), tracer.trace(ray, {}, true));
    return pick;
}

// A camera ray of film point (x, y) starts at eye + x ox + y oy and goes along center + x sx + y sy
// (shaders/generate.comp), so a point is at the (x, y) that solve a linear equation: with parallel rays
// p - eye = x ox + y oy + t center, else p - eye = t (x sx + y sy + center).
std::optional<Segment> projected(const shared::Camera& camera, const glm::dvec3& from, const glm::dvec3& to) {
    const bool parallel = camera.originStepX != glm::vec3(0);
    const glm::dmat3 film(parallel ? glm::dvec3(camera.originStepX) : glm::dvec3(camera.stepX),
                          parallel ? glm::dvec3(camera.originStepY) : glm::dvec3(camera.stepY),
                          glm::dvec3(camera.center));
    const glm::dmat3 inverse = glm::inverse(film);
    const glm::dvec3 eye(camera.eye);
    glm::dvec3 a = inverse * (from - eye), b = inverse * (to - eye);
    const double least = 1e-6 * std::max({std::abs(a.z), std::abs(b.z), 1e-12});
    if (!parallel) {
        if (a.z < least && b.z < least) return std::nullopt;
        if (a.z < least) a = glm::mix(a, b, (least - a.z) / (b.z - a.z));
        if (b.z < least) b = glm::mix(b, a, (least - b.z) / (a.z - b.z));
        a = {a.x / a.z, a.y / a.z, 1};
        b = {b.x / b.z, b.y / b.z, 1};
    }
    const glm::dvec2 middle(camera.halfWidth, camera.halfHeight);
    const Segment segment = {middle + glm::dvec2(a), middle + glm::dvec2(b)};
    // One coordinate that is not finite makes the sum not finite.
    const bool finite = std::isfinite(segment.from.x + segment.from.y + segment.to.x + segment.to.y);
    return finite ? std::optional(segment) : std::nullopt;
}

void Toasts::add(const std::string& text, ToastKind kind, double now) {
    std::erase_if(toasts_, [&](const Toast& t) { return t.text == text; });
    toasts_.push_back({text, kind, now + kSeconds * (kind == ToastKind::Error ? 2 : 1)});
    while (toasts_.size() > kMost) toasts_.pop_front();
}

bool Toasts::expire(double now) {
    return std::erase_if(toasts_, [&](const Toast& t) { return t.until <= now; }) > 0;
}

// ---- jobs ----

void Job::start(std::function<Rest(JobControl&)> work) {
    stop();
    control_ = std::make_unique<JobControl>();
    future_ = std::async(std::launch::async, [work = std::move(work), control = control_.get()] {
        Rest rest = work(*control);
        Window::wake();
        return rest;
    });
}

bool Job::finish() {
    if (!running() || future_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return false;
    try {
        future_.get()();
    } catch (const gpu::DeviceLost&) {
        throw;
    } catch (const std::exception& e) {
        failed(e.what());
    }
    return true;
}

void Job::stop() {
    if (!running()) return;
    control_->cancelled = true;
    future_.wait();
    future_ = {};
}

// ---- the model ----

Model::Model(const Options& start, std::ostream& output, std::ostream& errors)
    : out(output),
      err(errors),
      path(start.scene),
      options(start.loading),
      wishes(start.wishes),
      moments(std::make_shared<Moments>(path, options, start.time)),
      scene(moments->show().scene),
      time(start.time),
      control(scene->scene.camera, boundsOf(*scene).radius),
      hints(stateFile("hints")),
      recent(stateFile("recent")),
      docked(start.width == 0) {
    file = {scene, &scene->scene};
    settings = fileSettings = PictureSettings::of(*file, wishes);
    settings.until = start.until;
    timeline.follow(file->animation);
    timeline.setTime(time);
    for (size_t i = 0; i < file->cameras.size(); ++i)
        if (file->cameras[i].name == options.camera) camera = i;
    openFolder = std::filesystem::absolute(path).parent_path();
    recent.add(path);
    history.reset(undoable());
    editsAtWork = settings.edits;
    timeAtWork = time;
    files.watch(sceneFiles(path, *file));
}

void Model::say(const std::string& text, ToastKind kind) {
    toasts.add(text, kind, clock.seconds());
    redraw();
}

void Model::fail(const std::string& what) {
    lastError = what;
    say(what, ToastKind::Error);
    err << "glint: " << what << '\n';
}

void Model::report(const std::string& line) {
    say(line);
    out << line << std::endl;
}

void Model::follow(Hint hint) {
    if (hints.done(hint)) say("That is all it takes. F1 lists every key.");
}

std::vector<const NamedCamera*> Model::cameras() const {
    std::vector<const NamedCamera*> all;
    for (const auto* list : {&file->cameras, &bookmarks})
        for (const NamedCamera& each : *list) all.push_back(&each);
    return all;
}

void Model::goToCamera(size_t index) {
    const std::vector<const NamedCamera*> all = cameras();
    if (all.empty()) return say("M keeps a bookmark");
    camera = index % all.size();
    control.set(all[camera]->camera);
    say(all[camera]->name + " (" + std::to_string(camera + 1) + " of " + std::to_string(all.size()) + ")");
    history.endStep();
}

void Model::keepCamera() {
    std::string name;
    const auto taken = [&](const NamedCamera* c) { return c->name == name; };
    const std::vector<const NamedCamera*> all = cameras();
    size_t number = 0;
    do name = "bookmark " + std::to_string(++number);
    while (std::any_of(all.begin(), all.end(), taken));
    bookmarks.push_back({name, control.camera()});
    camera = all.size();
    say(name + "; N goes to the next camera");
}

const Image* Model::comparable() const {
    const bool there = session->samples() > 0 && session->width() > 0;
    return there ? &session->picture().color : nullptr;
}

void Model::sayWarnings() {
    warnings = file->warnings;  // which name their file
    for (const std::string& w : scene->packed.warnings) warnings.push_back(scene->path.string() + ": " + w);
    for (const std::string& w : warnings) err << "glint: warning: " << w << '\n';
    redraw();
}

bool Model::mayLeave() {
    if (!unsaved() || std::exchange(warned, true)) return true;
    say("bookmarks, lights or materials are not saved; again: leave them", ToastKind::Error);
    return false;
}

bool Model::keeps(const std::filesystem::path& existing) {
    std::error_code error;
    const bool kept = !replacesFile && std::filesystem::exists(existing, error);
    if (kept) fail(existing.string() + " exists: choose another name, or \"replace the file\"");
    return kept;
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
