#include "bench/write.h"

#include <nlohmann/json.hpp>

#include "core/format.h"
#include "core/parallel.h"
#include "core/text_file.h"

namespace glint::bench {

namespace {

using Json = nlohmann::json;

double testsOf(const Result& result, std::initializer_list<reference::RayClass> classes) {
    reference::RayTally sum;
    for (const reference::RayClass k : classes) sum += result.counted[static_cast<size_t>(k)];
    return sum.rays > 0 ? static_cast<double>(sum.tests) / static_cast<double>(sum.rays) : 0;
}

// Rates of the given times: the shortest time has the highest rate.
Quartiles perSecond(const Rate& rate) {
    const auto of = [&](double seconds) {
        return seconds > 0 ? static_cast<double>(rate.rays) / seconds : 0;
    };
    return {of(rate.seconds.high), of(rate.seconds.median), of(rate.seconds.low)};
}

Json quartilesJson(const Quartiles& q) {
    return {{"q1", q.low}, {"median", q.median}, {"q3", q.high}};
}

// A stage that happens once, or in every image; `once` in seconds.
struct Stage {
    const char *key, *name;  // in JSON, in the table
    double once = 0;
    const Quartiles* often = nullptr;
};

std::vector<Stage> stagesOf(const Result& r) {
    return {{"load", "load", r.load},
            {"build", "build", r.build},
            {"pack", "pack", r.pack},
            {"open", "open the device", r.open},
            {"upload", "upload", r.upload},
            {"compile", "compile, cold", r.compile},
            {"generate", "generate", 0, &r.generate},
            {"shade", "shade", 0, &r.shade},
            {"trace", "trace, all", 0, &r.trace},
            {"readback", "readback", 0, &r.readback},
            {"processors", "processors", 0, &r.processors}};
}

double trianglesPerSecond(const Result& r) {
    return r.build > 0 ? static_cast<double>(r.triangles) / r.build : 0;
}

Json raysJson(const Result& result) {
    Json json;
    for (const Rate& rate : ratesOf(result)) {
        Json& entry = json[rate.key];
        entry["number"] = rate.rays;
        entry["testsPerRay"] = rate.testsPerRay;
        if (rate.seconds.median <= 0) continue;
        entry["seconds"] = quartilesJson(rate.seconds);
        entry["perSecond"] = quartilesJson(perSecond(rate));
    }
    return json;
}

Json walkJson(const Result& r) {
    Json json;
    json["traversal"] = r.traversal;
    for (const Rate& rate : ratesOf(r)) {
        if (rate.seconds.median > 0) json["perSecond"][rate.key] = quartilesJson(perSecond(rate));
    }
    json["seconds"] = {{"upload", r.upload}, {"compile", r.compile}, {"trace", quartilesJson(r.trace)}};
    json["bytes"] = {{"device", r.deviceBytes}, {"spirv", r.codeBytes}};
    json["picture"] = r.picture;
    return json;
}

Json sceneJson(const Result& r) {
    Json json = {
        {"scene", r.scene},
        {"backend", nameOf(r.backend)},
        {"device", r.device},
        {"driver", r.driver},
        {"width", r.width},
        {"height", r.height},
        {"samplesPerPixel", r.samples},
        {"maxDepth", r.depth},
        {"lights", r.lights},
        {"triangles", r.triangles},
        {"primitives", r.primitives},
        {"repeats", r.repeats},
        {"features", r.used},
        {"also", r.also},
        {"rays", raysJson(r)},
        {"countedPixels", r.countedPixels},
        {"build", {{"threads", r.threads}, {"trianglesPerSecond", trianglesPerSecond(r)}}},
        {"bytes", {{"hostPeak", r.hostPeakBytes}, {"device", r.deviceBytes}, {"spirv", r.codeBytes}}},
        {"picture", r.picture}};
    for (const Stage& stage : stagesOf(r))
        json["seconds"][stage.key] = stage.often ? quartilesJson(*stage.often) : Json(stage.once);
    if (r.backend == Backend::Gpu) {
        json["traversal"] = r.traversal;
        json["access"] = r.access;
        json["paths"] = {{"live", r.livePaths}, {"invocations", r.invocations}};
    }
    for (const Result& walk : r.walks) json["walks"].push_back(walkJson(walk));
    return json;
}

std::string rateLine(const Rate& rate) {
    std::string text = format("  %-20s %11llu", rate.name, static_cast<unsigned long long>(rate.rays));
    text += rate.rays > 0 ? format(" %10.1f", rate.testsPerRay) : format(" %10s", "-");
    if (rate.seconds.median <= 0) return text + format(" %10s\n", "-");
    const Quartiles q = perSecond(rate);
    return text + format(" %10.3f  %8.3f .. %-8.3f %10.2f\n", q.median / 1e6, q.low / 1e6, q.high / 1e6,
                         rate.seconds.median * 1e3);
}

std::string stageLines(const Result& r) {
    std::string text = format("  %-20s %10s  %s\n", "stage", "ms", "quartiles");
    for (const auto& [key, name, once, often] : stagesOf(r)) {
        const double seconds = often ? often->median : once;
        if (seconds <= 0) continue;  // not on this backend
        text += format("  %-20s %10.2f", name, seconds * 1e3);
        if (often) text += format("  %8.2f .. %-8.2f", often->low * 1e3, often->high * 1e3);
        text += "\n";
    }
    return text;
}

std::string walkTable(const std::vector<Result>& walks) {
    std::string text = format("  %-9s", "traversal");
    for (const char* name : {"primary", "shadow", "mirrored", "refracted", "all"})
        text += format(" %9s", name);
    text += format(" %9s %9s %9s  %s\n", "trace, ms", "upload", "MiB", "image");
    for (const Result& r : walks) {
        text += format("  %-9s", r.traversal.c_str());
        for (const Rate& rate : ratesOf(r)) {
            if (std::string(rate.key) == "mirroredAndRefracted") continue;
            text += rate.seconds.median > 0 ? format(" %9.3f", perSecond(rate).median / 1e6)
                                            : format(" %9s", "-");
        }
        text += format(" %9.2f %9.2f %9.1f  %s\n", r.trace.median * 1e3, r.upload * 1e3,
                       static_cast<double>(r.deviceBytes) / 1048576, r.picture.c_str());
    }
    return text;
}

}  // namespace

std::vector<Rate> ratesOf(const Result& r) {
    using enum reference::RayClass;
    const auto& [primary, shadow, mirrored, refracted] = r.rays;
    const bool mixed = mirrored > 0 && refracted > 0;
    // If all secondary rays are of one kind, their time is that of the secondary dispatches.
    const auto apart = [&](uint64_t rays, const Quartiles& own) {
        return rays == 0 ? Quartiles() : mixed ? own : r.secondary;
    };
    std::vector<Rate> rates = {
        {"primary", "primary", primary, r.primary, testsOf(r, {Primary})},
        {"shadow", "shadow", shadow, r.shadow, testsOf(r, {Shadow})},
        {"mirrored", "mirrored", mirrored, apart(mirrored, r.mirrored), testsOf(r, {Mirrored})},
        {"refracted", "refracted", refracted, apart(refracted, r.refracted), testsOf(r, {Refracted})}};
    if (mixed)
        rates.push_back({"mirroredAndRefracted", "mirrored, refracted", mirrored + refracted, r.secondary,
                         testsOf(r, {Mirrored, Refracted})});
    rates.push_back({"all", "all, with shading", primary + shadow + mirrored + refracted, r.trace,
                     testsOf(r, {Primary, Shadow, Mirrored, Refracted})});
    return rates;
}

std::string table(const Result& r, const Program& program) {
    std::string text = r.scene + "\n";
    text += format("  %d x %d, %s, maxDepth %d, ", r.width, r.height,
                   counted(static_cast<uint64_t>(r.samples), "sample").c_str(), r.depth);
    text += counted(r.lights, "light") + ", " + counted(r.primitives, "primitive") + "\n";
    text += "  " + r.device + ", " + r.driver;
    if (!r.traversal.empty()) text += ", " + r.traversal + "s, " + r.access + " buffers";
    text += ", commit " + program.commit + "\n";
    if (!r.also.empty()) {
        text += "  with the code of";
        for (const std::string& name : r.also) text += " " + name;
        text += "\n";
    }
    text += format("\n  %-20s %11s %10s %10s  %-20s %10s\n", "rays", "number", "tests/ray", "Mrays/s",
                   "quartiles", "ms");
    for (const Rate& rate : ratesOf(r)) text += rateLine(rate);
    text += "\n" + stageLines(r);
    text += "\n  tree         " + counted(r.threads, "thread");
    if (r.triangles > 0) text += format(", %.2f million triangles/s", trianglesPerSecond(r) / 1e6);
    text += format("\n  memory       host %.1f MiB at most", static_cast<double>(r.hostPeakBytes) / 1048576);
    if (r.backend == Backend::Gpu)
        text += format(", device buffers %.1f MiB, SPIR-V %.1f KiB",
                       static_cast<double>(r.deviceBytes) / 1048576, static_cast<double>(r.codeBytes) / 1024);
    text += "\n  image        " + r.picture + "\n";
    return r.walks.empty() ? text : text + "\n" + walkTable(r.walks);
}

std::string json(const std::vector<Result>& results, const Program& program) {
    Json json;
    json["version"] = program.version;
    json["commit"] = program.commit;
    json["threads"] = defaultThreadCount();
    json["scenes"] = Json::array();
    for (const Result& result : results) json["scenes"].push_back(sceneJson(result));
    // A file name need not be UTF-8; JSON must be.
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace glint::bench
