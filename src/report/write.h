// A report as JSON, CSV, Markdown, SVG and HTML.
#pragma once

#include <string>

#include "report/plan.h"

namespace glint::report {

std::string toJson(const Report& data);
// Throws Error(Failed) "NAME: ..." for anything that toJson does not write.
Report fromJson(const std::string& text, const std::string& name);

// One line a configuration, a header before them; RFC 4180.
std::string toCsv(const Report& data);

// Tables and conclusions, for a terminal and for docs/lab/accuracy.md.
std::string toMarkdown(const Report& data);
std::string conclusionOf(const SceneReport& scene);

// Drawings of a size of their own, complete files; empty if there is nothing to draw.
std::string precisionDiagram(const SceneReport& scene);   // error against seconds
std::string truncationDiagram(const SceneReport& scene);  // depth and least contribution
std::string devicesDiagram(const SceneReport& scene);     // error against seconds, a curve for each device

std::string toHtml(const Report& data);

// < > & " ' as entities.
std::string escapeMarkup(const std::string& text);

// "0.00123", "1.2e-07"; three digits.
std::string shortNumber(double value);

// The points of a family, by samples for each pixel.
std::vector<const Measured*> familyOf(const SceneReport& scene, const std::string& family);
// The curves of the diagram of error against time, in the order of measurement.
std::vector<std::string> familiesOf(const SceneReport& scene);
// The front of all points of the diagram, ordered by time.
std::vector<const Measured*> frontOf(const SceneReport& scene);

}  // namespace glint::report
