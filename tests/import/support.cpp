#include "support.h"

#include <regex>

#include "import/load.h"

namespace glint::test {

std::string errorOf(const std::function<void()>& action) {
    return std::regex_replace(placedErrorOf(action), std::regex(":[0-9]+:[0-9]+(: /)"), "$1");
}

std::string placedErrorOf(const std::function<void()>& action) {
    return errorOf(ErrorKind::Scene, action);
}

Scene parse(const std::string& text) {
    return parseScene(text, "s.json", {});
}

std::string parseErrorOf(const std::string& text) {
    return errorOf([&] { parse(text); });
}

const char* const kCubeObj =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
    "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

}  // namespace glint::test
