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

// The blanks at the beginning of the line that holds byte `at`.
std::string indentation(const std::string& text, size_t at) {
    const size_t line = at == 0 ? 0 : text.rfind('\n', at - 1) + 1;  // npos + 1 is 0
    const size_t end = std::min(text.find_first_not_of(" \t", line), at);
    return text.substr(line, end - line);
}

std::string deeper(const std::string& indent) {
    return indent + (indent.starts_with('\t') ? "\t" : "  ");
}

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
    const std::string newLine = text.find("\r\n") == text.npos ? "\n" : "\r\n";
    const JsonCursor& parent = there ? *there : root;
    const size_t brace = (text.starts_with("\xef\xbb\xbf") ? 3 : 0) + parent.value().begin;
    const std::string indent = indentation(text, brace), inner = newLine + deeper(indent);
    const std::string beforeCamera = there ? inner : newLine + deeper(deeper(indent));
    std::string added;
    for (const NamedCamera& camera : cameras)
        added += (added.empty() ? "" : ",") + beforeCamera + jsonString(camera.name) + ": " +
                 cameraText(camera.camera);
    if (!there) added = inner + "\"cameras\": {" + added + inner + "}";
    if (!parent.object().keys.empty()) added += ',';
    const size_t rest = brace + 1;
    const bool lineEnds = text.find_first_not_of(" \t\r", rest) == text.find('\n', rest);
    const std::string written =
        text.substr(0, rest) + added + (lineEnds ? "" : newLine + indent) + text.substr(rest);
    checkWritten(text, written, file, cameras);
    return written;
}

}  // namespace glint
