// Identity of an image: the facts that it is made from, in words. Results are merged only if they agree on
// all of them.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace glint::farm {

// Facts in a fixed order, such as {"size", "640x480"} or {"file bunny.obj", "1f2e..."}.
struct Identity {
    std::vector<std::pair<std::string, std::string>> facts;
    bool operator==(const Identity&) const = default;
};

// The first fact that differs, for people: "size is 640x480 there and 800x600 here"; empty if none does.
// Facts about files are hashes, which nobody reads: "file bunny.obj has other contents".
std::string difference(const Identity& there, const Identity& here);

}  // namespace glint::farm
