// One page with everything in it: opens without a network and runs no script.
#include <sstream>

#include "report/write.h"

namespace glint::report {

namespace {

constexpr const char* kHead =
    "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/><title>glint report</title>\n"
    "<style>body{font:15px/1.45 sans-serif;max-width:1100px;margin:2em auto;padding:0 1em;color:#222}"
    "table{border-collapse:collapse;margin:1em 0;font-size:13px}td,th{border:1px solid #ddd;padding:2px 7px;"
    "text-align:right}td:first-child,th:first-child{text-align:left}th{background:#f3f3f3}"
    "svg{max-width:100%;height:auto;display:block}</style></head><body>\n<h1>Error against run time</h1>\n";

std::string cells(const std::string& line, const char* tag) {
    std::string out = "<tr>";
    size_t at = 1;  // behind the first bar
    while (at < line.size()) {
        const size_t end = line.find('|', at);
        if (end == std::string::npos) break;
        const std::string cell = line.substr(at + 1, end - at - 2);
        out += std::string("<") + tag + ">" + escapeMarkup(cell) + "</" + tag + ">";
        at = end + 1;
    }
    return out + "</tr>\n";
}

const SceneReport* sceneNamed(const Report& data, const std::string& name) {
    for (const SceneReport& scene : data.scenes)
        if (scene.name == name) return &scene;
    return nullptr;
}

// The Markdown that toMarkdown writes: headings, tables, lists, plain lines.
class Page {
  public:
    explicit Page(const Report& data) : data_(data) {}

    std::string write() {
        std::istringstream lines(toMarkdown(data_));
        for (std::string line; std::getline(lines, line);) addLine(line);
        endTable();
        return out_;
    }

  private:
    void endTable() {
        if (rows_ > 0) out_ += "</table>\n";
        rows_ = 0;
    }
    void addLine(const std::string& line) {
        if (line.starts_with("|---")) return;
        if (line.starts_with("|")) {
            if (rows_ == 0) out_ += "<table>\n";
            out_ += cells(line, rows_++ == 0 ? "th" : "td");
            return;
        }
        endTable();
        if (line.starts_with("## ")) {
            const std::string name = line.substr(3);
            out_ += "<h2>" + escapeMarkup(name) + "</h2>\n";
            if (const SceneReport* scene = sceneNamed(data_, name))
                out_ += precisionDiagram(*scene) + truncationDiagram(*scene) + devicesDiagram(*scene);
        } else if (!line.empty()) {
            out_ += "<p>" + escapeMarkup(line) + "</p>\n";
        }
    }

    const Report& data_;
    std::string out_;
    int rows_ = 0;
};

}  // namespace

std::string escapeMarkup(const std::string& text) {
    std::string out;
    for (const char c : text) {
        switch (c) {
            case '<':
                out += "&lt;";
                break;
            case '>':
                out += "&gt;";
                break;
            case '&':
                out += "&amp;";
                break;
            case '"':
                out += "&quot;";
                break;
            case '\'':
                out += "&#39;";
                break;
            default:
                out += c;
        }
    }
    return out;
}

std::string toHtml(const Report& data) {
    std::string out = kHead;
    if (!data.complete) out += "<p><b>Interrupted: what was finished.</b></p>\n";
    return out + Page(data).write() + "</body></html>\n";
}

}  // namespace glint::report
