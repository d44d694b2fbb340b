#include <exception>
#include <utility>
#include <vector>

#include "app/commands.h"
#include "app/version.h"
#include "gpu/device.h"

namespace glint::app {

namespace {

std::string compiler() {
#if defined(__clang__)
    return "Clang " __clang_version__;
#elif defined(__GNUC__)
    return "GCC " __VERSION__;
#else
    return "unknown";
#endif
}

std::string buildType() {
    std::string text = GLINT_BUILD_TYPE;
#if !defined(NDEBUG)
    text += ", with assertions";
#endif
#if defined(__SANITIZE_ADDRESS__)
    text += ", sanitized";
#endif
    return text;
}

// The file may be left out of what is installed.
std::string mpi() {
    const std::string built = GLINT_MPI_TEXT;
    return built == "no" || hasRanksModule() ? built : "no glint-mpi.so";
}

std::vector<std::string> devices() {
    try {
        std::vector<std::string> lines;
        for (const gpu::DeviceInfo& d : gpu::listDevices())
            lines.push_back(d.name + ", " + d.driver + ", Vulkan " + d.api +
                            (d.usable ? "" : ", refused: " + d.reason));
        if (lines.empty()) lines.emplace_back("none found by the Vulkan loader");
        return lines;
    } catch (const std::exception& e) {
        return {std::string("none: ") + e.what()};
    }
}

}  // namespace

std::string builtIn() {
    // A part that is built only where its library is found says here what it is, or "no".
    std::vector<std::pair<const char*, std::string>> facts = {
        {"commit", builtCommit()},     {"compiler", compiler()}, {"build type", buildType()},
        {"window", GLINT_WINDOW_TEXT}, {"MPI", mpi()},           {"EXR", GLINT_EXR_TEXT},
    };
    for (std::string& line : devices()) facts.emplace_back("device", std::move(line));
    std::string text;
    for (const auto& [name, value] : facts)
        text += (text.empty() ? "" : "\n") + std::string(name) + ": " + value;
    return text;
}

}  // namespace glint::app
