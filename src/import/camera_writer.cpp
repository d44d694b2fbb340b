#include "import/camera_writer.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "core/error.h"
#include "import/json_cursor.h"
#include "import/json_document.h"

namespace glint {

namespace {

constexpr std::string_view kBlanks = " \t\r\n";

std::string quoted(const std::string& name) {
    return nlohmann::json(name).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

// Finds its way through text that is known to be JSON with comments.
class Places {
  public:
    explicit Places(std::string_view text) : text_(text) {}

    // From `at` on, behind blanks and comments.
    size_t afterBlanks(size_t at) const {
        for (;;) {
            at = std::min(text_.find_first_not_of(kBlanks, at), text_.size());
            if (text_.substr(at, 2) != "//" && text_.substr(at, 2) != "/*") return at;
            at = afterComment(at);
        }
    }

    size_t afterComment(size_t at) const {
        const bool line = text_[at + 1] == '/';
        const size_t end = text_.find(line ? "\n" : "*/", at + 2);
        if (end == std::string_view::npos) return text_.size();
        return line ? end : end + 2;
    }

    // Behind the value that begins at `at`.
    size_t afterValue(size_t at) const {
        if (text_[at] == '"') return afterString(at);
        if (text_[at] != '{' && text_[at] != '[')
            return std::min(text_.find_first_of(" \t\r\n,]}/", at), text_.size());
        size_t depth = 0;
        do {
            at = afterBlanks(at);
            if (at >= text_.size()) return at;
            const char c = text_[at];
            if (c == '{' || c == '[') ++depth;
            if (c == '}' || c == ']') --depth;
            at = c == '"' ? afterString(at) : at + 1;
        } while (depth > 0);
        return at;
    }

    struct Member {
        std::string name;
        size_t key = 0, value = 0, end = 0;  // `end` is behind the value
    };
    // Members of the object that begins at `at`.
    std::vector<Member> members(size_t at) const {
        std::vector<Member> list;
        for (at = afterBlanks(at + 1); at < text_.size() && text_[at] == '"';) {
            Member member;
            member.key = at;
            at = afterString(at);
            member.name = nlohmann::json::parse(text_.substr(member.key, at - member.key)).get<std::string>();
            member.value = afterBlanks(afterBlanks(at) + 1);
            member.end = afterValue(member.value);
            at = afterBlanks(member.end);
            if (text_.substr(at, 1) == ",") at = afterBlanks(at + 1);
            list.push_back(std::move(member));
        }
        return list;
    }

    // The blanks before `at`, if there is nothing else before it in its line.
    std::optional<std::string> indentation(size_t at) const {
        const size_t line = at == 0 ? 0 : text_.rfind('\n', at - 1) + 1;  // npos + 1 is 0
        const std::string_view before = text_.substr(line, at - line);
        if (before.find_first_not_of(kBlanks) != std::string_view::npos) return std::nullopt;
        return std::string(before);
    }

    // The end of the line of `at` if only blanks and comments come before it, else `at`.
    size_t lineEnd(size_t at) const {
        size_t end = at;
        for (;;) {
            end = std::min(text_.find_first_not_of(" \t\r", end), text_.size());
            if (end == text_.size()) return at;
            if (text_[end] == '\n') return text_[end - 1] == '\r' ? end - 1 : end;
            const std::string_view next = text_.substr(end, 2);
            if (next != "//" && next != "/*") return at;
            const size_t after = afterComment(end);
            if (next == "/*" && text_.substr(end, after - end).find('\n') != std::string_view::npos)
                return at;
            end = after;
        }
    }

    std::string_view newLine() const { return text_.find("\r\n") == std::string_view::npos ? "\n" : "\r\n"; }

  private:
    size_t afterString(size_t at) const {
        for (++at; at < text_.size() && text_[at] != '"'; ++at)
            if (text_[at] == '\\') ++at;
        return at + 1;
    }

    std::string_view text_;
};

class Writer {
  public:
    Writer(std::string text, const std::vector<NamedCamera>& cameras)
        : text_(std::move(text)), places_(text_), cameras_(cameras) {}

    std::string written() && {
        const size_t root = places_.afterBlanks(text_.starts_with("\xef\xbb\xbf") ? 3 : 0);
        const std::vector<Places::Member> members = places_.members(root);
        const auto named = [&](std::string_view name) {
            return std::find_if(members.begin(), members.end(),
                                [&](const Places::Member& m) { return m.name == name; });
        };
        if (const auto cameras = named("cameras"); cameras != members.end()) {
            addTo(*cameras);
        } else if (const auto camera = named("camera"); camera != members.end()) {
            const auto indent = places_.indentation(camera->key);
            addAfter(*camera, block(indent, indent), indent);
        } else {
            addFirst(root, members);
        }
        return std::move(text_);
    }

  private:
    // The cameras, in lines of their own if there is an indentation.
    std::string lines(const std::optional<std::string>& indent) const {
        std::string result;
        for (const NamedCamera& camera : cameras_) {
            if (!result.empty()) result += indent ? "," + std::string(places_.newLine()) + *indent : ", ";
            result += quoted(camera.name) + ": " + cameraText(camera.camera);
        }
        return result;
    }

    // "cameras" with its key; what is in it goes in by one more `unit`.
    std::string block(const std::optional<std::string>& indent,
                      const std::optional<std::string>& unit) const {
        if (!indent) return "\"cameras\": {" + lines({}) + "}";
        const std::string deeper = *indent + (unit && !unit->empty() ? *unit : "  ");
        const std::string line(places_.newLine());
        return "\"cameras\": {" + line + deeper + lines(deeper) + line + *indent + "}";
    }

    void addTo(const Places::Member& cameras) {
        const std::vector<Places::Member> members = places_.members(cameras.value);
        if (!members.empty()) {
            const auto indent = places_.indentation(members.back().key);
            addAfter(members.back(), lines(indent), indent);
            return;
        }
        const auto indent = places_.indentation(cameras.key);
        const std::string all = block(indent, indent), head = "\"cameras\": {";
        const size_t inside = cameras.value + 1;
        const size_t blank = std::min(text_.find_first_not_of(kBlanks, inside), text_.size());
        const bool empty = text_[blank] == '}';  // blanks of nothing need not be kept, comments are
        text_.replace(inside, empty ? blank - inside : 0,
                      all.substr(head.size(), all.size() - head.size() - 1));
    }

    void addAfter(const Places::Member& member, const std::string& what,
                  const std::optional<std::string>& indent) {
        const size_t next = places_.afterBlanks(member.end);
        const bool last = text_[next] != ',';
        const size_t at = last ? member.end : next + 1;
        if (!indent) {
            text_.insert(at, last ? ", " + what : " " + what + ",");
            return;
        }
        text_.insert(places_.lineEnd(at),
                     std::string(places_.newLine()) + *indent + what + (last ? "" : ","));
        if (last) text_.insert(member.end, ",");
    }

    void addFirst(size_t root, const std::vector<Places::Member>& members) {
        if (members.empty()) {
            const std::string line(places_.newLine());
            text_.insert(root + 1, line + "  " + block("  ", "  ") + line);
            return;
        }
        const auto indent = places_.indentation(members.front().key);
        if (indent)
            text_.insert(root + 1, std::string(places_.newLine()) + *indent + block(indent, indent) + ",");
        else
            text_.insert(root + 1, block({}, {}) + ", ");
    }

    std::string text_;
    Places places_;  // of text_ before it is changed
    const std::vector<NamedCamera>& cameras_;
};

// Nothing that belongs to somebody is replaced by what only should be right.
void checkWritten(const std::string& before, const std::string& after, const std::string& file,
                  const std::vector<NamedCamera>& cameras) {
    auto wanted = nlohmann::json::parse(before, nullptr, true, true);
    for (const NamedCamera& camera : cameras)
        wanted["cameras"][camera.name] = nlohmann::json::parse(cameraText(camera.camera));
    if (nlohmann::json::parse(after, nullptr, false, true) != wanted)
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
    if (!parallel && camera.lensRadius > 0) json["lensRadius"] = camera.lensRadius;
    if (!parallel && camera.focusDistance > 0) json["focusDistance"] = camera.focusDistance;
    if (camera.nearT > 0) json["near"] = camera.nearT;
    if (std::isfinite(camera.farT)) json["far"] = camera.farT;
    return json.dump();
}

std::string withCameras(const std::string& text, const std::string& file,
                        const std::vector<NamedCamera>& cameras) {
    const JsonValue document = parseJson(text, file);
    const JsonCursor root(document, file);
    root.expectObject();
    std::vector<std::string> names;
    if (const auto there = root.find("cameras")) {
        there->expectObject();
        for (size_t i = 0; i < there->memberCount(); ++i) names.emplace_back(there->memberName(i));
    }
    for (const NamedCamera& camera : cameras) {
        if (std::find(names.begin(), names.end(), camera.name) != names.end())
            throw Error(ErrorKind::Argument,
                        file + ": there is a camera " + quoted(camera.name) + " already");
        names.push_back(camera.name);
    }
    if (cameras.empty()) return text;
    std::string written = Writer(text, cameras).written();
    checkWritten(text, written, file, cameras);
    return written;
}

}  // namespace glint
