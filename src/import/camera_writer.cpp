#include "import/camera_writer.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "core/error.h"
#include "import/json_document.h"

namespace glint {

namespace {

std::string jsonString(const std::string& name) {
    return nlohmann::json(name).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

// Text that is JSON with comments, into which lines are inserted.
class Writer {
  public:
    explicit Writer(const std::string& text)
        : text_(text), newLine_(text.find("\r\n") == text.npos ? "\n" : "\r\n") {}

    const std::string& text() const { return text_; }

    // The blanks at the beginning of the line that holds byte `at`, and one level more.
    std::string indentation(size_t at) const {
        const size_t line = at == 0 ? 0 : text_.rfind('\n', at - 1) + 1;  // npos + 1 is 0
        const size_t end = std::min(text_.find_first_not_of(" \t", line), at);
        return text_.substr(line, end - line);
    }
    static std::string deeper(const std::string& indent) {
        return indent + (indent.starts_with('\t') ? "\t" : "  ");
    }

    // Members of an object, each in a line of its own.
    std::string lines(const std::vector<std::string>& members, const std::string& indent) const {
        std::string all;
        for (const std::string& member : members)
            all += (all.empty() ? "" : ",") + newLine_ + indent + member;
        return all;
    }

    // Inserts lines behind the brace that opens an object.
    void addFirst(size_t brace, const std::string& lines, const std::string& indent, bool empty) {
        const size_t rest = brace + 1;
        const bool ends = text_.find_first_not_of(" \t\r", rest) == text_.find('\n', rest);
        text_.insert(rest, lines + (empty ? "" : ",") + (ends ? "" : newLine_ + indent));
    }

    // Inserts lines behind the last member of an object, which ends before `end`; a comment of its line stays
    // beside it.
    void addLast(size_t end, const std::string& lines) {
        const size_t next = std::min(text_.find_first_not_of(" \t", end), text_.size());
        const size_t line = std::min(text_.find('\n', end), text_.size());
        const bool comment = text_.compare(next, 2, "//") == 0;
        text_.insert(comment ? line - (text_[line - 1] == '\r' ? 1 : 0) : end, lines);
        text_.insert(end, ",");
    }

  private:
    std::string text_;
    const std::string newLine_;
};

// The result must hold the new values before it may replace a person's file.
void checkWritten(const std::string& before, const std::string& after, const std::string& file,
                  const std::vector<NamedCamera>& cameras) {
    auto wanted = nlohmann::json::parse(before, nullptr, true, true);
    for (const NamedCamera& camera : cameras)
        wanted["cameras"][camera.name] = nlohmann::json::parse(cameraText(camera.camera));
    const auto got = nlohmann::json::parse(after, nullptr, false, true);
    if (got.is_discarded() || got != wanted)  // no comparison with a discarded document holds
        throw Error(ErrorKind::Failed, file + ": its cameras cannot be written; paste them by hand");
}

}  // namespace

std::string cameraText(const Camera& camera) {
    const auto vector = [](const glm::dvec3& v) { return nlohmann::ordered_json{v.x, v.y, v.z}; };
    nlohmann::ordered_json json;
    const bool parallel = camera.projection == Projection::Orthographic;
    json["type"] = parallel ? "orthographic" : "perspective";
    json["eye"] = vector(camera.eye);
    json["target"] = vector(camera.target);
    json["up"] = vector(camera.up);
    if (camera.planeNormal) json["planeNormal"] = vector(*camera.planeNormal);
    if (camera.window) {
        const ViewWindow& w = *camera.window;
        json["window"] = {w.left, w.right, w.bottom, w.top};
    } else if (parallel) {
        json["height"] = camera.height;
    } else {
        json["fovY"] = camera.fovY;
    }
    if (hasLens(camera)) json["lensRadius"] = camera.lensRadius;
    if (!parallel && camera.focusDistance > 0) json["focusDistance"] = camera.focusDistance;
    if (camera.nearT > 0) json["near"] = camera.nearT;
    if (std::isfinite(camera.farT)) json["far"] = camera.farT;
    return json.dump();
}

std::string withCameras(const std::string& text, const std::string& file,
                        const std::vector<NamedCamera>& cameras) {
    const JsonValue document = parseJson(text, file);
    const JsonCursor root(document, file);
    std::set<std::string> names;
    const auto there = root.find("cameras");
    if (there)
        for (const auto& [name, camera] : there->members()) names.emplace(name);
    for (const NamedCamera& camera : cameras)
        if (!names.insert(camera.name).second)
            throw Error(ErrorKind::Argument,
                        file + ": there is a camera " + jsonString(camera.name) + " already");
    if (cameras.empty()) return text;
    const size_t mark = text.starts_with("\xef\xbb\xbf") ? 3 : 0;
    std::vector<std::string> members;
    for (const NamedCamera& camera : cameras)
        members.push_back(jsonString(camera.name) + ": " + cameraText(camera.camera));
    Writer writer(text);
    if (!there) {
        const size_t brace = mark + document.begin;
        const std::string outer = writer.indentation(brace), indent = Writer::deeper(outer);
        const std::string list =
            "\"cameras\": {" + writer.lines(members, Writer::deeper(indent)) + writer.lines({"}"}, indent);
        writer.addFirst(brace, writer.lines({list}, indent), outer, root.object().keys.empty());
    } else if (there->object().keys.empty()) {
        const size_t brace = mark + there->value().begin;
        const std::string indent = writer.indentation(brace);
        writer.addFirst(brace, writer.lines(members, Writer::deeper(indent)), indent, true);
    } else {
        const JsonCursor last = there->members().back().second;
        last.object();
        const std::string indent = Writer::deeper(writer.indentation(mark + there->value().begin));
        writer.addLast(mark + last.value().end, writer.lines(members, indent));
    }
    checkWritten(text, writer.text(), file, cameras);
    return writer.text();
}

}  // namespace glint
