#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <ostream>

#include "app/commands.h"
#include "app/common.h"
#include "app/exit_code.h"
#include "app/losses.h"
#include "app/output_check.h"
#include "app/render_options.h"
#include "app/render_result.h"
#include "core/available_memory.h"
#include "core/error.h"
#include "core/image_io.h"
#include "core/picture_hash.h"
#include "core/stopwatch.h"
#include "farm/merge.h"

namespace glint::app {

namespace {

struct MergeCommand {
    std::vector<std::filesystem::path> parts;
    std::filesystem::path output;  // empty: as `glint render` would call it
    bool json = false;
    bool quiet = false;
};

void declare(OptionTable& table, MergeCommand& c) {
    table.arguments("PART", "all parts of one picture, in any order", c.parts);
    table.path("-o,--output", "FILE",
               "picture to write: .png .exr .pfm .hdr (default: the scene's name with .png, here)",
               "the file name", c.output);
    addStats(table, "what was merged as JSON on standard output, instead of the summary", c.json);
    table.flag("-q,--quiet", "print nothing but errors (and what --stats asks for)", c.quiet);
}

std::filesystem::path sceneOf(const farm::Identity& identity) {
    for (const auto& [name, value] : identity.facts)
        if (name == "scene") return value;
    return "picture";
}

bool sharesBits(const farm::Merged& merged) {
    return std::all_of(merged.producers.begin(), merged.producers.end(),
                       [](const farm::Producer& p) { return p.sharesBits; });
}

void warn(const farm::Merged& merged, std::ostream& err) {
    const std::string start = "glint: warning: " + sceneOf(merged.header.identity).string() + ": ";
    warnOfNotFinite(merged.picture, start, err);
    warnOfLosses(merged.picture, start, err);
    warnOfMixedBits(merged.producers, start, err);
}

void print(const farm::Merged& merged, const MergeCommand& command,
           const std::vector<std::filesystem::path>& files, double seconds, std::ostream& out) {
    const Region& region = merged.header.region;
    const std::string hash = pictureHash(merged.picture.color);
    if (command.json) {
        nlohmann::json json = {{"scene", sceneOf(merged.header.identity).string()},
                               {"parts", command.parts.size()},
                               {"width", region.width()},
                               {"height", region.height()},
                               {"hash", hash},
                               {"reproducible", sharesBits(merged)},
                               {"lost", lossesJson(merged.picture)},
                               {"notFinite", merged.picture.notFinite},
                               {"seconds", seconds}};
        json["files"] = nlohmann::json::array();
        for (const auto& file : files) json["files"].push_back(file.string());
        json["devices"] = nlohmann::json::array();
        for (const farm::Producer& producer : merged.producers)
            json["devices"].push_back(producerText(producer));
        out << json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << '\n';
        return;
    }
    if (command.quiet) return;
    for (const auto& file : files)
        out << "wrote " << file.string() << " (" << region.width() << "x" << region.height() << ")\n";
    for (const farm::Producer& producer : merged.producers)
        out << "device: " << producerText(producer) << '\n';
    out << "hash: " << hash << '\n';
    out << "times: " << formatSeconds(seconds) << " for " << counted(command.parts.size(), "part") << '\n';
}

int run(const MergeCommand& command, std::ostream& out, std::ostream& err) {
    const Stopwatch watch;
    if (!command.quiet || command.json) checkStandardOutput(out);
    if (!command.output.empty()) checkPicturePath(command.output);
    std::filesystem::path output = command.output;
    farm::Merged merged = farm::mergeParts(command.parts, [&](const farm::UnitHeader& header) {
        if (output.empty()) output = sceneOf(header.identity).replace_extension(".png");
        checkPicturePath(output);
        // Twice: the picture, and a part that may be as large.
        checkMemory(header.region.width(), header.region.height(), 2 * bytesPerPixel(header.aovs, false),
                    availableMemory());
    });
    if (!command.quiet) warn(merged, err);
    const std::vector<std::filesystem::path> files = writeLayers(output, merged.layers);
    print(merged, command, files, watch.seconds(), out);
    return static_cast<int>(ExitCode::Done);
}

}  // namespace

Run mergeCommand(OptionTable& table) {
    const auto command = std::make_shared<MergeCommand>();
    declare(table, *command);
    return [command](std::ostream& out, std::ostream& err) { return run(*command, out, err); };
}

}  // namespace glint::app
