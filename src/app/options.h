// The values of the command line's options, from text. All throw Error(Usage) with one line that names the
// option, says what it takes and shows what it was given.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "app/cli.h"

namespace glint::app {

// A whole number from `least` to `greatest`.
int parseWhole(const std::string& option, const std::string& text, int least, int greatest);

Size parseSize(const std::string& text);                      // "640x480"
Region parseCrop(const std::string& text);                    // "x0,y0,x1,y1", not empty
std::pair<int, int> parsePixel(const std::string& text);      // "x,y"
std::vector<std::string> parseAovs(const std::string& text);  // "color, depth": known names, each once
Backend parseBackend(const std::string& text, const std::string& option = "--backend");
BuildQuality parseBuildQuality(const std::string& text);
TriangleMethod parseIntersector(const std::string& text);
SphereMethod parseSphereMethod(const std::string& text);
render::Traversal parseTraversal(const std::string& text);
render::Compaction parseCompaction(const std::string& text);
// "depth,offset": words that names of the settings of `glint report` start with.
std::vector<std::string> parseFamilies(const std::string& text);
// By the names that `glint info` prints.
SceneFeatures parseFeatures(const std::string& text);
ProgressMode parseProgress(const std::string& text);
double parseTolerance(const std::string& text);        // >= 0, finite
double parseMinContribution(const std::string& text);  // the same

Sampler parseSampler(const std::string& text);
FilterChoice parseFilter(const std::string& text);        // "NAME" or "NAME,RADIUS"
AdaptiveSampling parseAdaptive(const std::string& text);  // "MAX" or "MAX,THRESHOLD"
uint32_t parseSeed(const std::string& text);

// User's text for a message: in quotes, on one line, not too long.
std::string quoted(const std::string& text);

}  // namespace glint::app
