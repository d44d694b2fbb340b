#include <algorithm>
#include <cmath>
#include <ostream>

#include "app/commands.h"
#include "app/rendering.h"
#include "core/device_layout.h"
#include "core/error.h"
#include "core/text_file.h"
#include "gpu/device.h"
#include "pack/request_environment.h"
#include "pack/scene_arrays.h"
#include "render/kernel_choice.h"
#include "scene/cameras.h"
#include "scene/sampling.h"

namespace glint::app {

namespace {

constexpr size_t kMostNames = 16;

// Texts of the lines; an empty one is left out.

std::string arraysText(const PackedScene& packed) {
    uint64_t bytes = 0;
    visitArrays(packed, [&](const char*, const auto& array) { bytes += array.size() * sizeof(array[0]); });
    return (bytes < 1024 * 1024 ? std::to_string(bytes) + " bytes"
                                : format("%.1f MiB", static_cast<double>(bytes) / (1024.0 * 1024.0))) +
           " on the device";
}

std::string imageText(const PackedScene& packed, const Request& request) {
    const Sampler sampler = samplerOf(request);
    std::string text = format("%d x %d, ", request.width, request.height) +
                       counted(static_cast<uint64_t>(request.samplesPerPixel), "sample") + " per pixel";
    // A single sample in the centre has no sampler.
    if (request.samplesPerPixel > 1 || sampler != Sampler::Grid)
        text += " (" + std::string(nameOf(sampler)) + (request.sampler == Sampler::Auto ? ", auto)" : ")");
    return text + ", at most " + counted(depthOf(packed, request), "reflection");
}

// "3: "red", "glass"", with at most kMostNames of them.
std::string materialsText(const Scene& scene) {
    std::vector<std::string> names;
    for (const Material& material : scene.materials) names.push_back('"' + printable(material.name) + '"');
    const size_t count = names.size();
    if (count > kMostNames) {
        names.resize(kMostNames);
        names.emplace_back("...");
    }
    return std::to_string(count) + (names.empty() ? "" : ": ") + joined(names);
}

// "3: 2 point, 1 spot"
std::string lightsText(const Scene& scene) {
    std::vector<std::string> kinds;
    for (size_t kind = 0; kind < kLightTypes.size(); ++kind) {
        const auto count = std::count_if(scene.lights.begin(), scene.lights.end(),
                                         [kind](const Light& light) { return light.index() == kind; });
        if (count > 0) kinds.push_back(std::to_string(count) + " " + kLightTypes[kind]);
    }
    return std::to_string(scene.lights.size()) + (kinds.empty() ? "" : ": ") + joined(kinds);
}

// A corner of the bounds: without the margin of the BVH, to five digits of `extent`.
std::string cornerText(const glm::dvec3& corner, double extent) {
    const double step = std::pow(10, std::ceil(std::log10(std::max(extent, 1e-300) * 1e-5)));
    const glm::dvec3 p = glm::round(corner / step) * step + 0.0;  // no -0
    return format("(%.9g %.9g %.9g)", p.x, p.y, p.z);
}

// "2 (1 triangle, 1 sphere, ...)"; instances have a line of their own.
std::string objectsText(const Scene& scene, const PackedScene& packed) {
    std::vector<std::string> counts;
    visitKinds(packed, [&](const KindCount& kind) {
        if (kind.kind != shared::PrimitiveKind::Instance)
            counts.push_back(std::to_string(kind.count) + " " + (kind.count == 1 ? kind.one : kind.many));
    });
    return std::to_string(scene.objects.size()) + " (" + joined(counts) + ")";
}

// The kernel that --traversal auto chooses on the default device, or the text that no device exists.
std::string traversalText(const PackedScene& packed, const Request& request) {
    try {
        const std::vector<gpu::DeviceInfo> devices = gpu::listDevices();
        const gpu::DeviceInfo device = gpu::chooseDevice(devices, "");
        const render::TraversalChoice choice =
            render::chooseTraversal(render::Traversal::Auto, device, packed, request.methods);
        const std::string text = std::string(render::nameOf(choice)) + " (" + choice.reason + ")";
        return choice.packets ? text + "; lane below a million rays, and with reflected or refracted rays"
                              : text;
    } catch (const Error&) {
        return "no device to choose for";
    }
}

bool hasBvh(const PackedScene& packed) {
    return packed.environment.root != shared::kNone;
}

std::string boundsText(const PackedScene& packed) {
    if (!hasBvh(packed)) return packed.planes.empty() ? "no geometry" : "infinite (planes only)";
    const glm::dvec3 lo = packed.origin + glm::dvec3(packed.boundsLo),
                     hi = packed.origin + glm::dvec3(packed.boundsHi), size = hi - lo;
    const double extent = std::max({size.x, size.y, size.z});
    return cornerText(lo, extent) + " .. " + cornerText(hi, extent) +
           (packed.planes.empty() ? "" : ", planes apart");
}

// The widest gap between two surfaces that shadows may miss, by the rule for rays that leave surfaces
// (docs/design/numerics.md): 12 units of the coordinates across it, and of planes that are not parallel to an
// axis 6 units of the scene's size too, along each of three axes.
std::string leastGapText(const PackedScene& packed) {
    if (!hasBvh(packed)) return "";
    const glm::vec3 lo = packed.boundsLo, hi = packed.boundsHi;
    const glm::vec3 far = glm::max(glm::abs(lo), glm::abs(hi)), size = hi - lo;
    const double coordinate = std::max({far.x, far.y, far.z}), extent = std::max({size.x, size.y, size.z});
    constexpr double kUnit = 0x1p-24;
    return format("%.2g along an axis, %.2g in other directions", 12 * kUnit * coordinate,
                  std::sqrt(3.0) * kUnit * (12 * coordinate + 6 * extent));
}

std::string bvhText(const PackedScene& packed) {
    const PackStatistics& s = packed.statistics;
    if (!hasBvh(packed)) return "none";
    return counted(packed.nodes.size(), "node") + ", " + std::to_string(s.leaves) +
           (s.leaves == 1 ? " leaf" : " leaves") +
           format(", depth %u, SAH cost %.2f, built in ", s.depth, s.sahCost) + formatSeconds(s.buildSeconds);
}

ExitCode printInfo(const SceneOptions& command, std::ostream& out, std::ostream& err) {
    const LoadedScene loaded = loadAndPack(command, err);
    const Scene& scene = loaded.scene;
    const PackedScene& packed = loaded.packed;
    const PackStatistics& s = packed.statistics;
    const Request request = requestOf(loaded, command);
    std::vector<std::string> used, leftOut;
#define GLINT_LIST(ID, NAME, field) (packed.features.field ? used : leftOut).push_back(#field);
    GLINT_FEATURES(GLINT_LIST)
#undef GLINT_LIST
    for (std::vector<std::string>* list : {&used, &leftOut})
        if (list->empty()) list->emplace_back("nothing");
    const glm::dvec3& origin = packed.origin;
    const std::pair<const char*, std::string> lines[] = {
        {"image", imageText(packed, request)},
        {"camera", cameraKind(request.camera)},
        {"cameras", scene.cameras.empty() ? "" : cameraNames(scene, kMostNames)},
        {"objects", objectsText(scene, packed)},
        {"instances", packed.instances.empty() ? ""
                                               : std::to_string(packed.instances.size()) + " of " +
                                                     counted(s.prototypes, "object") + " stored once"},
        {"materials", materialsText(scene)},
        {"lights", lightsText(scene)},
        {"textures", scene.textures.empty() ? "" : std::to_string(scene.textures.size())},
        {"environment", scene.environment ? scene.environment->file : ""},
        {"bounds", boundsText(packed)},
        {"least gap", leastGapText(packed)},
        {"BVH", bvhText(packed)},
        {"local frame",
         origin != glm::dvec3(0) ? format("origin (%.9g %.9g %.9g)", origin.x, origin.y, origin.z) : ""},
        {"dropped", s.droppedZeroArea + s.droppedNotFinite > 0
                        ? counted(s.droppedZeroArea, "primitive") + " without area, " +
                              std::to_string(s.droppedNotFinite) + " not finite"
                        : ""},
        {"arrays", arraysText(packed)},
        {"traversal", traversalText(packed, request)},
        {"features used", joined(used)},
        {"left out", joined(leftOut)}};
    out << shown(command.scene) << '\n';
    for (const auto& [name, text] : lines)
        if (!text.empty()) out << format("  %-13s ", name) << text << '\n';
    return ExitCode::Done;
}

std::string arithmeticText(const gpu::DeviceInfo& device) {
    try {
        gpu::DeviceOptions options;
        options.selector = std::to_string(device.index);
        return gpu::Device(options).arithmetic().text();
    } catch (const Error& e) {
        return std::string("could not be tried: ") + e.what();
    }
}

ExitCode printDevices(std::ostream& out) {
    std::vector<gpu::DeviceInfo> devices;
    uint32_t chosen = shared::kNone;
    std::string refusal;
    try {
        devices = gpu::listDevices();
        chosen = gpu::chooseDevice(devices, "").index;
    } catch (const Error& e) {
        // The list below gives the details of each device; the error comes after it.
        refusal = devices.empty() ? e.what() : "no usable Vulkan device (reasons above)";
    }
    for (const gpu::DeviceInfo& d : devices) {
        out << d.index << "  " << d.name << "\n   " << d.type << ", " << d.driver << ", Vulkan " << d.api
            << "\n   "
            << (!d.usable           ? "refused: "
                : d.index == chosen ? "chosen: "
                                    : "usable: ")
            << d.reason << '\n';
        if (d.usable) out << "   arithmetic: " << arithmeticText(d) << '\n';
    }
    out << "cpu\n   double precision on the processor, without Vulkan\n   usable: --backend cpu\n";
    if (!refusal.empty()) throw Error(ErrorKind::Device, refusal);
    return ExitCode::Done;
}

void declareInfo(OptionTable& table, SceneOptions& options) {
    addScene(table, options);
    addSceneOverrides(table, options);
    addMethods(table, options);
}

}  // namespace

Run infoCommand(OptionTable& table) {
    return commandOf<SceneOptions>(table, declareInfo, printInfo);
}

Run devicesCommand(OptionTable&) {
    return [](std::ostream& out, std::ostream&) { return printDevices(out); };
}

}  // namespace glint::app
