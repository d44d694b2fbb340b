#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>

#include "app/commands.h"
#include "app/common.h"
#include "app/render_result.h"
#include "app/units.h"
#include "core/stopwatch.h"
#include "core/text_file.h"
#include "farm/merge.h"

namespace glint::app {

namespace {

struct MergeCommand {
    std::vector<std::filesystem::path> parts;
    std::filesystem::path output;  // empty: as `glint render` would call it
    std::optional<double> exposure;
    bool inBands = false;
    bool json = false;
    bool quiet = false;
};

void declare(OptionTable& table, MergeCommand& c) {
    table.files("PART", "all parts of one image, in any order", c.parts);
    table.name("-o,--output", "FILE", "image to write: .png .exr .pfm .hdr (default: SCENE.png, here)",
               c.output);
    addExposure(table, c.exposure);
    table.flag("--in-bands", "write row by row (default: if the image does not fit into memory)", c.inBands);
    addStats(table, "print parts, devices and hash as JSON instead of the summary", c.json);
    table.flag("-q,--quiet", "print only errors, and the output of --stats", c.quiet);
}

std::filesystem::path sceneOf(const farm::Identity& identity) {
    for (const auto& [name, value] : identity.facts)
        if (name == "scene") return value;
    return "image";
}

nlohmann::json mergeJson(const std::filesystem::path& scene, const Outcome& outcome,
                         const MergeCommand& command, const std::vector<farm::Producer>& producers) {
    nlohmann::json json = {{"scene", scene.string()},
                           {"parts", command.parts.size()},
                           {"files", filesJson(outcome.files)},
                           {"width", outcome.picture.region.width()},
                           {"height", outcome.picture.region.height()},
                           {"hash", outcome.hash},
                           {"inBands", outcome.bands > 0},
                           {"reproducible", std::all_of(producers.begin(), producers.end(),
                                                        [](const auto& p) { return p.sharesBits; })},
                           {"lost", lossesJson(outcome.picture)},
                           {"notFinite", outcome.picture.notFinite},
                           {"seconds", outcome.totalSeconds},
                           {"devices", nlohmann::json::array()}};
    for (const farm::Producer& producer : producers) json["devices"].push_back(textOf(producer));
    return json;
}

ExitCode run(const MergeCommand& command, std::ostream& out, std::ostream& err) {
    const Stopwatch watch;
    if (!command.quiet || command.json) checkStandardOutput(out);
    if (!command.output.empty()) checkPicturePath(command.output);
    farm::UnitHeader header;
    std::optional<UnitPicture> picture;
    const auto begin = [&](const farm::UnitHeader& first, uint64_t largest) {
        header = first;
        std::filesystem::path output = command.output;
        if (output.empty()) output = sceneOf(header.identity).replace_extension(".png");
        checkPicturePath(output);
        // A file, its contents, and its rows.
        picture.emplace(header, output, 3 * largest, command.inBands, command.exposure);
    };
    farm::mergeParts(command.parts, begin, [&](const farm::UnitResult& result) { picture->add(result); });
    const std::filesystem::path scene = sceneOf(header.identity);
    Outcome outcome = picture->write();
    outcome.totalSeconds = watch.seconds();
    const std::vector<farm::Producer>& producers = picture->assembly().producers();
    std::ostream silence(nullptr);
    std::ostream& warnings = command.quiet ? silence : err;
    const std::string start = "glint: warning: " + scene.string() + ": ";
    warnOfNotFinite(outcome.picture, start, warnings);
    warnOfLosses(outcome.picture, start, warnings);
    warnOfMixedBits(producers, start, warnings);
    if (command.json) {
        printJson(mergeJson(scene, outcome, command, producers), out);
    } else if (!command.quiet) {
        printFiles(outcome, out);
        for (const farm::Producer& producer : producers) out << "device: " << textOf(producer) << '\n';
        out << "hash: " << outcome.hash << "\ntimes: " << formatSeconds(outcome.totalSeconds) << " for "
            << counted(command.parts.size(), "part") << '\n';
    }
    return ExitCode::Done;
}

}  // namespace

Run mergeCommand(OptionTable& table) {
    return commandOf<MergeCommand>(table, declare, run);
}

}  // namespace glint::app
