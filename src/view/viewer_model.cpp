// What the panel shows, what it has changed, and the picture behind it.
#include <algorithm>
#include <cmath>

#include "core/text_file.h"
#include "view/viewer.h"

namespace glint::view {

namespace {

std::string objectName(const Scene& scene, uint32_t object) {
    return object < scene.objects.size() ? scene.objects[object].name : "";
}

std::string materialName(const Scene& scene, uint32_t material) {
    return material < scene.materials.size() ? scene.materials[material].name : "";
}

}  // namespace

void Viewer::fillModel() {
    model_.scene = &scene_->scene;
    model_.picture = &background_;
    model_.left = left_;
    model_.facts = session_->facts();
    model_.moving = moving();
    model_.samples = session_->samples();
    model_.progress = session_->progress();
    model_.finished = session_->finished();
    model_.goal = session_->goal();
    model_.frameTimes = &frameTimes_;
    model_.saveProgress = saving_.running() ? saving_.progress() : -1;
    model_.verifyProgress = verifying_.running() ? verifying_.progress() : -1;
    model_.referenceProgress = referring_.running() ? referring_.progress() : -1;
    model_.loading = loading_.running();
    model_.closing = closingAsked_;
    model_.differenceShown = difference_.has_value();
    model_.fileCameras = &fileCameras();
    model_.bookmarks = &bookmarks_;
    model_.holdsCameras = lowerExtension(scene_->path) == ".json";
    model_.recent = &recent_.list();
    model_.shownTime = time_;
    model_.seconds = clock_.seconds();
    model_.hints = hints_.any() ? &hints_ : nullptr;
    model_.targetSeconds = pace_.target();
    const Camera& camera = control_.camera();
    model_.perspective = camera.projection == Projection::Perspective;
    model_.hasFov = !camera.window && model_.perspective;
    model_.fovY = camera.fovY;
    model_.lensRadius = camera.lensRadius;
    model_.focusDistance = camera.focusDistance;
    if (hasLegend(model_.settings.layer, model_.display)) model_.range = session_->range();
    fillPixel();
    fillPick();
}

// Over a control the last pixel stays. Else the inspector would shrink as the mouse comes to its slider, show
// nothing of what the slider does, and lose a press in the frame in which it shrinks.
void Viewer::fillPixel() {
    model_.pixel.reset();
    const auto inside = [&](const glm::ivec2& p) {
        return p.x >= 0 && p.y >= 0 && p.x < session_->width() && p.y < session_->height();
    };
    const glm::ivec2 under(std::floor(cursorX_), std::floor(cursorY_));
    if (inside(under) && !covered()) inspected_ = under;
    if (!model_.inspects || !inspected_ || !inside(*inspected_)) {
        inspected_.reset();
        return;
    }
    const int x = inspected_->x, y = inspected_->y;
    PixelFacts facts;
    facts.x = x;
    facts.y = y;
    facts.hasColor = session_->samples() > 0;
    facts.hasData = session_->hasData();
    const Picture& picture = session_->picture();
    if (facts.hasColor) {
        for (int c = 0; c < 3; ++c) facts.linear[c] = picture.color.at(x, y, c);
    }
    if (facts.hasData) {
        facts.data = picture.at(x, y);
        facts.object = objectName(scene_->scene, facts.data.object);
        facts.material = materialName(scene_->scene, facts.data.material);
    }
    model_.pixel = facts;
}

void Viewer::fillPick() {
    model_.pick = &pick_;
    model_.pickIsOld = pickIsOld_;
    model_.pickLines.clear();
    if (!pick_ || !model_.drawsRays) return;
    const shared::Camera camera = session_->packedCamera();
    const glm::dvec3& origin = scene_->packed.origin;
    for (const PickRay& ray : pick_->rays)
        model_.pickLines.push_back(projected(camera, ray.from - origin, ray.to - origin).value_or(Segment{}));
}

void Viewer::takeSettings() {
    if (model_.settings == session_->settings()) return;
    session_->apply(model_.settings);
    if (!session_->ready()) {
        touchMotion();
        forgetPick(true);
        difference_.reset();
        model_.verdict.clear();
    }
    dirty_ = 3;
}

void Viewer::takeCamera() {
    const Camera& camera = control_.camera();
    if (model_.hasFov && model_.fovY != camera.fovY) {
        control_.zoom(model_.fovY / camera.fovY);
        touchMotion();
    }
    if (model_.lensRadius != camera.lensRadius || model_.focusDistance != camera.focusDistance) {
        control_.setLens(model_.lensRadius, model_.focusDistance);
        touchMotion();
    }
}

// What the user has changed in the panel.
void Viewer::takeModel() {
    takeSettings();
    takeCamera();
    if (!(model_.display == shown_.display)) dirty_ = std::max(dirty_, 1);
    session_->wantData(model_.inspects);
    pace_.setTarget(model_.targetSeconds);
    if (model_.mode != swapchain_->presentMode()) {
        const PixelSize size = window_.size();
        swapchain_.reset();
        swapchain_ = std::make_unique<gpu::Swapchain>(*device_, size.width, size.height, model_.mode);
        model_.mode = swapchain_->presentMode();
    }
    if (model_.traversal != session_->traversal()) showScene(scene_);
    if (model_.wish != Wish::None) grant(std::exchange(model_.wish, Wish::None));
}

void Viewer::grant(Wish wish) {
    dirty_ = 3;
    switch (wish) {
        case Wish::SavePng:
            return perform(Action::SavePng);
        case Wish::SaveExr:
            return perform(Action::SaveExr);
        case Wish::RenderPng:
            return perform(Action::RenderPng);
        case Wish::RenderExr:
            return perform(Action::RenderExr);
        case Wish::SaveAs:
            return saveAs();
        case Wish::Open:
            return drop({model_.openName.data()});
        case Wish::Verify:
            return perform(Action::Verify);
        case Wish::Keep:
            return perform(Action::Keep);
        case Wish::TraceReference:
            return startReference();
        case Wish::Undo:
            return perform(Action::Undo);
        case Wish::Redo:
            return perform(Action::Redo);
        case Wish::Bookmark:
            return perform(Action::Bookmark);
        case Wish::GoToCamera:
            return goToCamera(model_.camera);
        case Wish::WriteCameras:
            return writeCameras();
        case Wish::ResetCamera:
            return perform(Action::Reset);
        case Wish::FocusPicked:
            if (pick_) focusAt(pick_->x, pick_->y);
            return;
        case Wish::PrintCamera:
            return perform(Action::PrintCamera);
        case Wish::PlayPause:
            return perform(Action::PlayPause);
        case Wish::FrameBack:
            return perform(Action::FrameBack);
        case Wish::FrameOn:
            return perform(Action::FrameOn);
        case Wish::None:
            return;
    }
}

const Canvas& Viewer::background() {
    const bool compares = comparison_.any() && comparison_.mode != CompareMode::Off;
    if (compares && session_->finished()) {
        const uint64_t wanted = session_->version() * 1000003 + compared_;
        if (std::exchange(measured_, wanted) != wanted) measure(comparison_, comparable());
    }
    Shown now;
    now.version = session_->version();
    now.display = model_.display;
    now.difference = difference_.has_value();
    if (compares) {
        now.mode = comparison_.mode;
        now.flash = now.mode == CompareMode::Flicker && flash();
        now.wipe = comparison_.wipe;
        now.gain = comparison_.gain;
        now.compared = compared_ + (comparison_.figures ? 1000003 : 0);
    }
    if (now == shown_) return background_;
    shown_ = now;
    if (difference_) {
        background_ = Canvas(session_->width(), session_->height());
        stretch(*difference_, background_, false);
        return background_;
    }
    background_ = session_->canvas(model_.display);
    if (compares) compose(comparison_, comparable(), model_.display, now.flash, background_);
    return background_;
}

}  // namespace glint::view
