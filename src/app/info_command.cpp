#include <cstdio>
#include <ostream>

#include "app/cli.h"
#include "app/common.h"
#include "core/error.h"
#include "core/image_diff.h"
#include "core/image_io.h"
#include "gpu/device.h"
#include "shared/dispatch.h"

namespace glint::app {

namespace {

std::string words(const std::vector<std::string>& list) {
    std::string text;
    for (const std::string& item : list) text += (text.empty() ? "" : ", ") + item;
    return text.empty() ? "nothing" : text;
}

template <typename T>
uint64_t bytesOf(const std::vector<T>& array) {
    return array.size() * sizeof(T);
}

}  // namespace

int runInfo(const SceneOptions& command, std::ostream& out, std::ostream& err) {
    const LoadedScene loaded = loadAndPack(command, err);
    const Scene& scene = loaded.scene;
    const PackedScene& packed = loaded.packed;
    char line[400];
    const auto print = [&](const char* format, auto... values) {
        std::snprintf(line, sizeof(line), format, values...);
        out << line;
    };
    out << command.scene.string() << '\n';
    print("  picture       %d x %d, %d samples per pixel, at most %d reflections\n", scene.image.width, scene.image.height,
          scene.image.samplesPerPixel, scene.maxDepth);
    print("  objects       %zu (%zu triangles, %zu spheres, %zu planes), %zu materials, %zu lights\n", scene.objects.size(),
          packed.triangles.size(), packed.spheres.size(), packed.planes.size(), packed.materials.size(), packed.lights.size());
    if (packed.environment.root != shared::kNone) {
        const glm::dvec3 lo = packed.origin + glm::dvec3(packed.boundsLo), hi = packed.origin + glm::dvec3(packed.boundsHi);
        print("  bounds        (%.9g %.9g %.9g) .. (%.9g %.9g %.9g)\n", lo.x, lo.y, lo.z, hi.x, hi.y, hi.z);
    } else {
        out << "  bounds        nothing finite\n";
    }
    if (packed.origin != glm::dvec3(0)) {
        print("  local frame   origin (%.9g %.9g %.9g)\n", packed.origin.x, packed.origin.y, packed.origin.z);
    }
    const PackStatistics& s = packed.statistics;
    print("  BVH           %zu nodes, %u leaves, depth %u, SAH cost %.2f, built in %s\n", packed.nodes.size(), s.leaves, s.depth,
          s.sahCost, formatSeconds(s.buildSeconds).c_str());
    print("  dropped       %u triangles without area, %u not finite\n", s.droppedZeroArea, s.droppedNotFinite);
    const uint64_t bytes = bytesOf(packed.nodes) + bytesOf(packed.triangles) + bytesOf(packed.triangleSurfaces) +
                           bytesOf(packed.vertexNormals) + bytesOf(packed.spheres) + bytesOf(packed.planes) +
                           bytesOf(packed.materials) + bytesOf(packed.lights);
    print("  arrays        %.2f MiB on the device\n", static_cast<double>(bytes) / (1024.0 * 1024.0));
    std::vector<std::string> used, leftOut;
#define GLINT_LIST(ID, NAME, field) (packed.features.field ? used : leftOut).push_back(#field);
    GLINT_FEATURES(GLINT_LIST)
#undef GLINT_LIST
    out << "  features used " << words(used) << '\n' << "  left out      " << words(leftOut) << '\n';
    return static_cast<int>(ExitCode::Done);
}

int runDevices(std::ostream& out) {
    const std::vector<gpu::DeviceInfo> devices = gpu::listDevices();
    if (devices.empty()) {
        throw Error(ExitCode::Device, "the Vulkan loader knows no device: install a driver (Debian: mesa-vulkan-drivers), or use --backend cpu");
    }
    uint32_t chosen = shared::kNone;
    try {
        chosen = gpu::chooseDevice(devices, "").index;
    } catch (const Error&) {
        // None is usable; each line says why, and the exit code says so below.
    }
    for (const gpu::DeviceInfo& d : devices) {
        out << d.index << "  " << d.name << "\n   " << d.type << ", " << d.driver << ", Vulkan " << d.api << "\n   "
            << (!d.usable ? "refused: " : d.index == chosen ? "chosen: " : "usable: ") << d.reason << '\n';
    }
    if (chosen == shared::kNone) throw Error(ExitCode::Device, "no usable Vulkan device (reasons above); --backend cpu needs none");
    return static_cast<int>(ExitCode::Done);
}

int runDiff(const DiffCommand& command, std::ostream& out) {
    if (!command.output.empty() && !isWritableImagePath(command.output)) {
        throw Error(ExitCode::Usage, command.output.string() + ": unknown picture format (use .png, .exr, .pfm or .hdr)");
    }
    const Image a = readImage(command.a);
    const Image b = readImage(command.b);
    const ImageDifference d = compareImages(a, b, command.tolerance);
    char line[200];
    std::snprintf(line, sizeof(line), "RMSE %.6g, PSNR %.4g dB, max %.6g, mean %.6g\n", d.rmse, d.psnr, d.max, d.mean);
    out << line;
    std::snprintf(line, sizeof(line), "%llu of %llu pixels (%.4f %%) differ by more than %g, %llu not finite in one picture only\n",
                  static_cast<unsigned long long>(d.above), static_cast<unsigned long long>(d.pixels),
                  100.0 * static_cast<double>(d.above) / static_cast<double>(std::max<uint64_t>(d.pixels, 1)), command.tolerance,
                  static_cast<unsigned long long>(d.notFinite));
    out << line;
    for (const PixelDifference& p : d.worst) {
        std::snprintf(line, sizeof(line), "  pixel %d,%d: %.6g\n", p.x, p.y, static_cast<double>(p.difference));
        out << line;
    }
    if (!command.output.empty()) writeImage(command.output, differenceImage(a, b));
    return static_cast<int>(d.above > 0 || d.notFinite > 0 ? ExitCode::Difference : ExitCode::Done);
}

}  // namespace glint::app
