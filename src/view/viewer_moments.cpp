// What needs the scene packed again, beside the window: other moments of an animation, and changed materials.
#include <algorithm>
#include <utility>

#include "core/error.h"
#include "core/text_file.h"
#include "view/viewer.h"

namespace glint::view {

void Viewer::playOn() {
    if (timeline_.advance(clock_.seconds())) dirty_ = std::max(dirty_, 1);
}

// One at a time; what is wanted meanwhile comes after it, and moments that nobody waits for any more are left
// out.
void Viewer::pollPacking() {
    if (packing_.finished()) {
        dirty_ = 3;
        try {
            takeMoment(packing_.take());
        } catch (const Error& e) {
            say(e.what(), ToastKind::Error);
            err_ << "glint: " << e.what() << '\n';
            timeline_.setTime(time_);
            timeAtWork_ = time_;
        }
    }
    if (packing_.running() || loading_.running()) return;
    if (same(model_.edits, editsAtWork_) && timeline_.time() == timeAtWork_) return;
    editsAtWork_ = model_.edits;
    timeAtWork_ = timeline_.time();
    packing_.start([moments = moments_, time = timeAtWork_, edits = model_.edits,
                    before = model_.fileEdits](JobControl&) {
        Moment moment = moments->show(time, edits, before);
        Window::wake();
        return moment;
    });
}

// Whatever the user has not changed is as the file has it at this moment.
void Viewer::takeMoment(Moment moment) {
    const PictureSettings file = PictureSettings::of(*moment.file);
    const SceneEdits edits = SceneEdits::of(*moment.file);
    model_.settings.follow(model_.fileSettings, file);
    model_.edits.follow(model_.fileEdits, edits);
    model_.fileSettings = file;
    model_.fileEdits = edits;
    editsAtWork_ = std::move(moment.edits);
    fileScene_ = std::move(moment.file);
    time_ = moment.time;
    control_.follow(fileScene_->camera, boundsOf(moment.scene ? *moment.scene : *scene_).radius);
    seenCamera_ = control_.camera();  // no movement to undo
    if (moment.scene) return showScene(std::move(moment.scene));
    takeSettings();
    forgetPick(false);
    difference_.reset();
    model_.verdict.clear();
    touchMotion();
}

bool Viewer::performTime(Action action) {
    if (action < Action::PlayPause || action > Action::LastFrame) return false;
    if (!timeline_.any()) {
        say("this scene has no animation");
        return true;
    }
    switch (action) {
        case Action::PlayPause:
            timeline_.playing() ? timeline_.pause() : timeline_.play(clock_.seconds());
            return true;
        case Action::FrameBack:
            timeline_.step(-1);
            return true;
        case Action::FrameOn:
            timeline_.step(1);
            return true;
        case Action::FirstFrame:
            timeline_.goTo(timeline_.first());
            return true;
        default:
            timeline_.goTo(timeline_.last());
            return true;
    }
}

std::string Viewer::momentText() const {
    if (!time_ || !timeline_.any()) return "";
    return "; its moment: glint render " + scene_->path.string() + " --time " + describe(*time_);
}

}  // namespace glint::view
