#include "app/units.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <ostream>
#include <utility>

#include "app/commands.h"
#include "core/available_memory.h"
#include "core/error.h"
#include "core/format.h"
#include "core/stopwatch.h"
#include "core/text_file.h"

namespace glint::app {

namespace {

bool needsRows(const farm::UnitHeader& header, const std::filesystem::path& output, uint64_t heldBytes,
               bool wanted) {
    const Region& region = header.region;
    if (!goesByRows(output, header.aovs, region, unitBytes(header.aovs, 1), heldBytes, wanted)) return false;
    const uint64_t needed = heldBytes + unitBytes(header.aovs, static_cast<uint64_t>(4 * shared::kTileSize) *
                                                                   static_cast<uint64_t>(region.width()));
    requireMemory(format("an image of %dx%d pixels in ", region.width(), region.height()) +
                      counted(static_cast<uint64_t>(header.parts), "unit"),
                  needed, availableMemory(), "use more parts (--part K/N) or a smaller --size");
    return true;
}

}  // namespace

UnitPicture::UnitPicture(const farm::UnitHeader& header, const std::filesystem::path& output,
                         uint64_t heldBytes, bool byRows, std::optional<double> exposure)
    : assembly_(header.region, header.aovs),
      file_(output, header.region, header.aovs, exposure, needsRows(header, output, heldBytes, byRows)) {}

void UnitPicture::add(const farm::UnitResult& result) {
    assembly_.add(result);
    if (!file_.goesByRows() && !assembly_.complete()) return;
    farm::Rows rows = assembly_.take();
    if (rows.picture.region.height() == 0) return;
    file_.add(rows.picture, std::move(rows.layers));
    if (!file_.goesByRows()) picture_ = std::move(rows.picture);
}

Outcome UnitPicture::write(std::ostream& out) {
    if (!assembly_.complete())
        throw Error(ErrorKind::Failed, "the parts leave some of the image's pixels out");
    Outcome outcome;
    outcome.region = assembly_.region();
    outcome.flaws = assembly_.flaws();
    outcome.written = file_.finish(out);
    return outcome;
}

std::string textOf(const farm::Producer& producer) {
    return producer.driver.empty() ? producer.device : producer.device + ", " + producer.driver;
}

void warnOfMixedBits(const std::vector<farm::Producer>& producers, const std::string& start,
                     std::ostream& err) {
    std::vector<std::string> own;
    for (const farm::Producer& producer : producers)
        if (!producer.sharesBits) own.push_back(textOf(producer));
    if (producers.size() < 2 || own.empty()) return;
    err << start << "the parts come from several devices, and the bits of some are their own ("
        << joined(own, "; ") << "): the last digits may differ from part to part\n";
}

uint64_t unitBytes(const std::vector<Aov>& aovs, uint64_t pixels) {
    return 2 * pixels * bytesPerPixel(aovs);  // as rendered, and as layers
}

namespace {

// ---- glint merge

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

bool readsFile(const farm::Identity& identity, const std::filesystem::path& file) {
    return std::ranges::any_of(identity.facts,
                               [&](const auto& fact) { return fact.first == "file " + file.string(); });
}

nlohmann::json mergeJson(const std::filesystem::path& scene, const Outcome& outcome,
                         const MergeCommand& command, const std::vector<farm::Producer>& producers) {
    nlohmann::json json = imageJson(outcome);
    json.update({{"scene", scene.string()},
                 {"parts", command.parts.size()},
                 {"hash", outcome.written.hash},
                 {"inBands", outcome.written.bands > 0},
                 {"reproducible", std::all_of(producers.begin(), producers.end(),
                                              [](const auto& p) { return p.sharesBits; })},
                 {"seconds", outcome.totalSeconds},
                 {"devices", nlohmann::json::array()}});
    for (const farm::Producer& producer : producers) json["devices"].push_back(textOf(producer));
    return json;
}

ExitCode run(const MergeCommand& command, std::ostream& out, std::ostream& err) {
    const Stopwatch watch;
    if (!command.quiet || command.json) checkStandardOutput(out);
    if (!command.output.empty()) checkPicturePath(inFolder(command.output, "image.png"));
    farm::UnitHeader header;
    std::optional<UnitPicture> picture;
    const auto begin = [&](const farm::UnitHeader& first, uint64_t largest) {
        header = first;
        std::filesystem::path output = sceneOf(header.identity).replace_extension(".png");
        if (!command.output.empty()) output = inFolder(command.output, output);
        if (command.output.empty() && readsFile(header.identity, output))
            output.replace_extension(".render.png");
        checkPicturePath(output);
        // A file, its contents, and its rows.
        picture.emplace(header, output, 3 * largest, command.inBands, command.exposure);
    };
    farm::mergeParts(command.parts, begin, [&](const farm::UnitResult& result) { picture->add(result); });
    const std::filesystem::path scene = sceneOf(header.identity);
    Outcome outcome = picture->write(out);
    outcome.totalSeconds = watch.seconds();
    const std::vector<farm::Producer>& producers = picture->assembly().producers();
    std::ostream silence(nullptr);
    std::ostream& warnings = command.quiet ? silence : err;
    const std::string start = "glint: warning: " + scene.string() + ": ";
    warnOf(outcome, true, start, warnings);
    warnOfMixedBits(producers, start, warnings);
    if (command.json) {
        printJson(mergeJson(scene, outcome, command, producers), out);
    } else if (!command.quiet) {
        printFiles(outcome, out);
        for (const farm::Producer& producer : producers) out << "device: " << textOf(producer) << '\n';
        out << "hash: " << outcome.written.hash << "\ntimes: " << formatSeconds(outcome.totalSeconds)
            << " for " << counted(command.parts.size(), "part") << '\n';
    }
    return ExitCode::Done;
}

}  // namespace

Run mergeCommand(OptionTable& table) {
    return commandOf<MergeCommand>(table, declare, run);
}

}  // namespace glint::app
