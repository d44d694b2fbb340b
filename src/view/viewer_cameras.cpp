// Cameras with names: those of the scene's file, and bookmarks.
#include <algorithm>
#include <ostream>

#include "core/content_hash.h"
#include "core/error.h"
#include "core/file_io.h"
#include "core/text_file.h"
#include "import/camera_writer.h"
#include "view/viewer.h"

namespace glint::view {

void Viewer::keepCamera() {
    const auto taken = [](const std::vector<NamedCamera>& list, const std::string& name) {
        return std::any_of(list.begin(), list.end(), [&](const NamedCamera& c) { return c.name == name; });
    };
    std::string name;
    for (size_t i = 1; name.empty() || taken(fileCameras(), name) || taken(bookmarks_, name); ++i)
        name = "bookmark " + std::to_string(i);
    bookmarks_.push_back({name, control_.camera()});
    model_.camera = fileCameras().size() + bookmarks_.size() - 1;
    say(name + "; N goes to the next camera");
}

void Viewer::goToCamera(size_t index) {
    const size_t inFile = fileCameras().size(), all = inFile + bookmarks_.size();
    if (all == 0) {
        say("M keeps a bookmark");
        return;
    }
    model_.camera = index % all;
    const NamedCamera& camera =
        model_.camera < inFile ? fileCameras()[model_.camera] : bookmarks_[model_.camera - inFile];
    control_.set(camera.camera);
    say(camera.name + " (" + std::to_string(model_.camera + 1) + " of " + std::to_string(all) + ")");
    gestureEnded_ = true;
    touchMotion();
}

// The file belongs to whoever edits it: what has changed since it was read is not overwritten.
void Viewer::writeCameras() {
    const std::filesystem::path& file = scene_->path;
    try {
        if (bookmarks_.empty()) throw Error(ErrorKind::Argument, "M keeps a bookmark");
        for (const NamedCamera& bookmark : bookmarks_)
            if (bookmark.name.empty()) throw Error(ErrorKind::Argument, "give each bookmark a name");
        const std::string text = readWholeFile(file);
        const std::vector<SourceFile>& read = fileScene_->sources;
        const uint64_t hash = contentHash(text);
        if (std::none_of(read.begin(), read.end(), [&](const SourceFile& s) { return s.hash == hash; }))
            throw Error(ErrorKind::Failed,
                        file.string() +
                            " has changed since it was read; nothing written. It is loaded again: look, and "
                            "try once more");
        writeTextFile(file, withCameras(text, file.string(), bookmarks_));
        const std::string line = "wrote " + std::to_string(bookmarks_.size()) +
                                 (bookmarks_.size() == 1 ? " camera" : " cameras") + " to " + file.string();
        bookmarks_.clear();
        say(line);
        out_ << line << std::endl;
        startLoading();
    } catch (const Error& e) {
        say(e.what(), ToastKind::Error);
        err_ << "glint: " << e.what() << '\n';
    }
}

}  // namespace glint::view
