// One clear line for a command line that cannot be understood.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace glint::app {

// Error in the first word of a command line, which must be a command of `app` or an option that stands alone;
// empty if the word is valid.
std::string firstWordError(const CLI::App& app, const std::vector<std::string>& args);

// The line for what CLI11 refused.
std::string parseErrorLine(const CLI::App& app, const CLI::ParseError& error);

}  // namespace glint::app
