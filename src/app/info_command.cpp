#include <algorithm>
#include <cmath>
#include <ostream>
#include <set>

#include "app/commands.h"
#include "app/common.h"
#include "app/drawing.h"
#include "app/loading.h"
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

std::string arraySize(const PackedScene& packed) {
    uint64_t bytes = 0;
    visitArrays(packed, [&](const char*, const auto& array) { bytes += array.size() * sizeof(array[0]); });
    if (bytes < 1024 * 1024) return std::to_string(bytes) + " bytes";
    return format("%.1f MiB", static_cast<double>(bytes) / (1024.0 * 1024.0));
}

constexpr size_t kMostNames = 16;

// ": "red", "glass"", or nothing.
std::string materialNames(const Scene& scene) {
    std::vector<std::string> names;
    for (const Material& material : scene.materials) names.push_back('"' + printable(material.name) + '"');
    if (names.size() > kMostNames) {
        names.resize(kMostNames);
        names.emplace_back("...");
    }
    return names.empty() ? "" : ": " + joined(names);
}

// ": 2 point, 1 spot", or nothing.
std::string lightKinds(const Scene& scene) {
    constexpr const char* kKinds[] = {"point", "directional", "spot"};
    static_assert(std::size(kKinds) == std::variant_size_v<Light>);
    std::vector<std::string> kinds;
    for (size_t kind = 0; kind < std::size(kKinds); ++kind) {
        const auto count = std::count_if(scene.lights.begin(), scene.lights.end(),
                                         [kind](const Light& light) { return light.index() == kind; });
        if (count > 0) kinds.push_back(std::to_string(count) + " " + kKinds[kind]);
    }
    return kinds.empty() ? "" : ": " + joined(kinds);
}

// A corner of the bounds: without the margin of the BVH, to five digits of `extent`.
std::string cornerText(const glm::dvec3& corner, double extent) {
    const double step = std::pow(10, std::ceil(std::log10(std::max(extent, 1e-300) * 1e-5)));
    const glm::dvec3 p = glm::round(corner / step) * step + 0.0;  // no -0
    return format("(%.9g %.9g %.9g)", p.x, p.y, p.z);
}

// "12 triangles, 1 sphere, ..."; instances have a line of their own.
std::string kindCounts(const PackedScene& packed) {
    std::vector<std::string> counts;
    visitKinds(packed, [&](const KindCount& kind) {
        if (kind.kind != shared::PrimitiveKind::Instance)
            counts.push_back(std::to_string(kind.count) + " " + (kind.count == 1 ? kind.one : kind.many));
    });
    return joined(counts);
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

// The widest gap between two surfaces that shadows may miss, by the rule for rays that leave surfaces
// (docs/design/numerics.md): 12 units of the coordinates across it, and of planes that are not parallel to an
// axis 6 units of the scene's size too, along each of three axes.
void printLeastGap(const PackedScene& packed, std::ostream& out) {
    const glm::vec3 lo = packed.boundsLo, hi = packed.boundsHi;
    const glm::vec3 far = glm::max(glm::abs(lo), glm::abs(hi)), size = hi - lo;
    const double coordinate = std::max({far.x, far.y, far.z}), extent = std::max({size.x, size.y, size.z});
    constexpr double kUnit = 0x1p-24;
    out << format("  least gap     %.2g along an axis, %.2g in other directions\n", 12 * kUnit * coordinate,
                  std::sqrt(3.0) * kUnit * (12 * coordinate + 6 * extent));
}

void printGeometry(const PackedScene& packed, std::ostream& out) {
    const PackStatistics& s = packed.statistics;
    if (packed.environment.root == shared::kNone) {
        out << "  bounds        " << (packed.planes.empty() ? "no geometry" : "infinite (planes only)")
            << "\n  BVH           none\n";
    } else {
        const glm::dvec3 lo = packed.origin + glm::dvec3(packed.boundsLo),
                         hi = packed.origin + glm::dvec3(packed.boundsHi);
        const glm::dvec3 size = hi - lo;
        const double extent = std::max({size.x, size.y, size.z});
        out << "  bounds        " << cornerText(lo, extent) << " .. " << cornerText(hi, extent)
            << (packed.planes.empty() ? "\n" : ", planes apart\n");
        printLeastGap(packed, out);
        if (s.splitTriangles > 0)
            out << "  split         " << counted(s.splitTriangles, "further part") << " of triangles\n";
        out << "  BVH           " << counted(packed.nodes.size(), "node") << ", " << s.leaves
            << (s.leaves == 1 ? " leaf" : " leaves")
            << format(", depth %u, SAH cost %.2f, built in ", s.depth, s.sahCost)
            << formatSeconds(s.buildSeconds) << '\n';
    }
    if (packed.origin != glm::dvec3(0)) {
        out << format("  local frame   origin (%.9g %.9g %.9g)\n", packed.origin.x, packed.origin.y,
                      packed.origin.z);
    }
    if (s.droppedZeroArea + s.droppedNotFinite > 0) {
        out << "  dropped       " << counted(s.droppedZeroArea, "primitive") << " without area, "
            << s.droppedNotFinite << " not finite\n";
    }
}

void printInstances(const PackedScene& packed, std::ostream& out) {
    if (packed.instances.empty()) return;
    const PackStatistics& s = packed.statistics;
    out << "  instances     " << packed.instances.size() << " of " << counted(s.prototypes, "object")
        << " stored once: " << counted(s.prototypeTriangles, "triangle") << " for " << s.instancedTriangles
        << '\n';
}

// A single sample in the centre has no sampler.
std::string samplerText(const ImageSettings& image) {
    const Sampler sampler = samplerOf(image);
    if (image.samplesPerPixel == 1 && sampler == Sampler::Grid) return "";
    const char* const how = image.sampler == Sampler::Auto ? ", auto)" : ")";
    return " (" + std::string(nameOf(sampler)) + how;
}

void printImage(const std::string& file, const Image& image, std::ostream& out) {
    const uint64_t bytes = static_cast<uint64_t>(image.width) * image.height * sizeof(shared::Texel);
    out << "                " << file
        << format(", %d x %d, %.1f KiB on the device\n", image.width, image.height,
                  static_cast<double>(bytes) / 1024.0);
}

// Each image once, though several textures may show it.
void printTextures(const Scene& scene, std::ostream& out) {
    if (scene.textures.empty() && !scene.environment) return;
    out << "  textures      " << scene.textures.size() << (scene.environment ? ", environment map" : "")
        << '\n';
    std::set<const Image*> seen;
    for (const Texture& texture : scene.textures) {
        const auto* image = std::get_if<ImageTexture>(&texture.source);
        if (image != nullptr && seen.insert(image->image.get()).second)
            printImage(image->file, *image->image, out);
    }
    if (scene.environment) printImage(scene.environment->file, *scene.environment->image, out);
}

ExitCode printInfo(const SceneOptions& command, std::ostream& out, std::ostream& err) {
    const LoadedScene loaded = loadAndPack(command, err);
    const Scene& scene = loaded.scene;
    const PackedScene& packed = loaded.packed;
    const Request request = requestOf(loaded, command);
    const ImageSettings& image = request.image;
    out << shown(command.scene) << '\n'
        << "  image         " << image.width << " x " << image.height << ", "
        << counted(static_cast<uint64_t>(image.samplesPerPixel), "sample") << " per pixel"
        << samplerText(image) << ", at most "
        << counted(static_cast<uint64_t>(depthOf(loaded.packed, request)), "reflection") << '\n'
        << "  camera        " << cameraKind(scene.camera) << '\n';
    if (!scene.cameras.empty()) out << "  cameras       " << cameraNames(scene, kMostNames) << '\n';
    out << "  objects       " << scene.objects.size() << " (" << kindCounts(packed) << ")\n";
    printInstances(packed, out);
    out << "  materials     " << scene.materials.size() << materialNames(scene) << '\n'
        << "  lights        " << scene.lights.size() << lightKinds(scene) << '\n';
    printTextures(scene, out);
    printGeometry(packed, out);
    out << "  arrays        " << arraySize(packed) << " on the device\n";
    std::vector<std::string> used, leftOut;
#define GLINT_LIST(ID, NAME, field) (packed.features.field ? used : leftOut).push_back(#field);
    GLINT_FEATURES(GLINT_LIST)
#undef GLINT_LIST
    out << "  traversal     " << traversalText(packed, request) << '\n';
    for (std::vector<std::string>* list : {&used, &leftOut})
        if (list->empty()) list->emplace_back("nothing");
    out << "  features used " << joined(used) << '\n' << "  left out      " << joined(leftOut) << '\n';
    out << "  tests         triangles " << nameOf(command.methods.triangles) << ", spheres "
        << nameOf(command.methods.spheres) << '\n';
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
        // The list below says more about each device; the error comes after it.
        refusal = devices.empty() ? withAdvice(e).what()
                                  : "no usable Vulkan device (reasons above); --backend cpu needs none";
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
