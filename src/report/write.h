// A report as JSON, CSV, Markdown, SVG and HTML.
#pragma once

#include <string>
#include <vector>

#include "report/plan.h"

namespace glint::report {

std::string toJson(const Report& report);
// Throws Error(Failed) "NAME: ..." for anything that toJson does not write.
Report fromJson(const std::string& text, const std::string& name);

// A line for each setting with the fields of toJson, and a header; RFC 4180.
std::string toCsv(const Report& report);

// Conclusions and tables for a terminal.
std::string toMarkdown(const Report& report);
// The same with diagrams: one page without scripts and references.
std::string toHtml(const Report& report);

// For three errors the options that reach them fastest, one line each.
std::vector<std::string> useTheseSettings(const SceneReport& scene);

// Complete SVG files; empty if there is nothing to draw.
std::string precisionDiagram(const SceneReport& scene);   // error against seconds
std::string truncationDiagram(const SceneReport& scene);  // depth and least contribution

// < > & " ' as entities.
std::string escapeMarkup(const std::string& text);
// "0.00123", "1.2e-07"; three digits.
std::string shortNumber(double value);

bool isSampler(const std::string& family);
// The points of a family, by samples per pixel.
std::vector<const Measured*> familyOf(const SceneReport& scene, const std::string& family);
// The Pareto front of all settings that a user of one device can choose, ordered by time: no other setting is
// at least as fast and exact, and better in time or error. The first of equal settings stays.
std::vector<const Measured*> frontOf(const SceneReport& scene);

}  // namespace glint::report
