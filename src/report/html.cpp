// One page with everything in it, without scripts and references. Each scene's first screen shows its image,
// the settings to use and the error curve; the tables follow.
#include <map>
#include <sstream>

#include "core/text_file.h"
#include "report/write.h"

namespace glint::report {

namespace {

constexpr const char* kHead =
    "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/><title>glint report</title>\n"
    "<style>body{font:15px/1.45 sans-serif;max-width:1100px;margin:1em auto;padding:0 1em;color:#222}"
    "table{border-collapse:collapse;margin:1em 0;font-size:13px}td,th{border:1px solid #ddd;padding:2px 7px;"
    "text-align:right}td:first-child,th:first-child{text-align:left}th{background:#f3f3f3}"
    "svg{max-width:100%;height:auto;display:block}.top{display:flex;gap:2em;align-items:center}"
    ".top img{max-width:320px;border:1px solid #ddd}.use{font-size:17px}</style></head><body>\n"
    "<h1>Error against run time</h1>\n";

std::string cells(const std::string& line, const std::string& tag) {
    const std::vector<std::string> parts = split(line, '|');  // empty before the first bar and after the last
    std::string out = "<tr>";
    for (size_t i = 1; i + 1 < parts.size(); ++i)
        out += "<" + tag + ">" + escapeMarkup(trimmed(parts[i])) + "</" + tag + ">";
    return out + "</tr>\n";
}

std::string firstScreen(const SceneReport& scene) {
    std::string out = "<h2>" + escapeMarkup(scene.name) + "</h2>\n<div class=\"top\">\n";
    if (!scene.thumbnail.empty())
        out += "<img alt=\"the converged image\" src=\"data:image/png;base64," + scene.thumbnail + "\"/>\n";
    out += "<div><h3>Use these settings</h3>\n<ul class=\"use\">\n";
    for (const std::string& line : useTheseSettings(scene)) out += "<li>" + escapeMarkup(line) + "</li>\n";
    return out + "</ul></div></div>\n" + precisionDiagram(scene);
}

// Converts the Markdown of toMarkdown: headings, tables, lists, paragraphs.
class Page {
  public:
    std::string convert(const std::string& markdown) {
        std::istringstream lines(markdown);
        for (std::string line; std::getline(lines, line);) add(line);
        end();
        return out_;
    }

  private:
    // `block`: the element that the next line belongs to, or nothing.
    void end(const char* block = "") {
        if (block_ == block) return;
        if (!block_.empty()) out_ += "</" + block_ + ">\n";
        block_ = block;
        rows_ = 0;
        if (!block_.empty()) out_ += "<" + block_ + ">\n";
    }
    void add(const std::string& line) {
        if (line.starts_with("|---")) return;
        if (line.starts_with("|")) {
            end("table");
            out_ += cells(line, rows_++ == 0 ? "th" : "td");
        } else if (line.starts_with("- ")) {
            end("ul");
            out_ += "<li>" + escapeMarkup(line.substr(2)) + "</li>\n";
        } else {
            end();
            if (line.starts_with("## "))
                out_ += "<h2>" + escapeMarkup(line.substr(3)) + "</h2>\n";
            else if (!line.empty())
                out_ += "<p>" + escapeMarkup(line) + "</p>\n";
        }
    }

    std::string out_, block_;
    int rows_ = 0;
};

}  // namespace

std::string escapeMarkup(const std::string& text) {
    static const std::map<char, const char*> entities = {
        {'<', "&lt;"}, {'>', "&gt;"}, {'&', "&amp;"}, {'"', "&quot;"}, {'\'', "&#39;"}};
    std::string out;
    for (const char c : text) {
        const auto entity = entities.find(c);
        out += entity == entities.end() ? std::string(1, c) : entity->second;
    }
    return out;
}

// RFC 4648, section 4.
std::string base64(const std::vector<uint8_t>& bytes) {
    constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (size_t i = 0; i < bytes.size(); i += 3) {
        const auto at = [&](size_t k) { return k < bytes.size() ? uint32_t{bytes[k]} : 0u; };
        const uint32_t word = at(i) << 16 | at(i + 1) << 8 | at(i + 2);
        for (size_t k = 0; k < 4; ++k)
            text += i + k <= bytes.size() ? kDigits[word >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

std::string toHtml(const Report& report) {
    std::string out = kHead;
    if (!report.complete) out += "<p><b>Interrupted: the results so far.</b></p>\n";
    for (const SceneReport& scene : report.scenes) out += firstScreen(scene);
    out += Page().convert(toMarkdown(report));
    for (const SceneReport& scene : report.scenes) out += truncationDiagram(scene) + devicesDiagram(scene);
    return out + "</body></html>\n";
}

}  // namespace glint::report
