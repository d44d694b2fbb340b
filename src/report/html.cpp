// One page with everything in it, without scripts and references. Each scene's first screen shows its image,
// the settings to use and the error curve; the tables follow.
#include <map>

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

std::string element(const std::string& tag, const std::string& text) {
    return "<" + tag + ">" + escapeMarkup(text) + "</" + tag + ">";
}

std::string firstScreen(const SceneReport& scene) {
    std::string out = "<h2>" + escapeMarkup(scene.name) + "</h2>\n<div class=\"top\">\n";
    if (!scene.thumbnail.empty())
        out += "<img alt=\"the converged image\" src=\"data:image/png;base64," + scene.thumbnail + "\"/>\n";
    out += "<div><h3>Use these settings</h3>\n<ul class=\"use\">\n";
    for (const std::string& line : useTheseSettings(scene)) out += element("li", line) + "\n";
    return out + "</ul></div></div>\n" + precisionDiagram(scene);
}

std::string blockText(const Block& block) {
    std::string out;
    if (block.kind == Block::Table) {
        for (const std::vector<std::string>& row : block.rows) {
            out += "<tr>";
            for (const std::string& cell : row)
                out += element(&row == &block.rows.front() ? "th" : "td", cell);
            out += "</tr>\n";
        }
        return "<table>\n" + out + "</table>\n";
    }
    const char* const tag = block.kind == Block::List ? "li" : block.kind == Block::Heading ? "h2" : "p";
    for (const std::vector<std::string>& row : block.rows) out += element(tag, row[0]) + "\n";
    return block.kind == Block::List ? "<ul>\n" + out + "</ul>\n" : out;
}

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
    for (const Block& block : textOf(report)) out += blockText(block);
    for (const SceneReport& scene : report.scenes) out += truncationDiagram(scene) + devicesDiagram(scene);
    return out + "</body></html>\n";
}

}  // namespace glint::report
