#include <cstdio>
#include <ostream>

#include "app/cli.h"
#include "app/common.h"
#include "core/error.h"
#include "core/image_io.h"
#include "core/interrupt.h"
#include "verify/verify.h"

namespace glint::app {

namespace {

void printRecord(const char* who, const glm::dvec3& color, uint32_t hash, uint32_t bounces, bool hit, uint32_t object,
                 uint32_t primitive, double t, const glm::dvec3& p, std::ostream& out) {
    char line[320];
    if (hit) {
        std::snprintf(line, sizeof(line),
                      "      %-9s color (%.6g %.6g %.6g)  object %u primitive %u t %.9g at (%.9g %.9g %.9g)  %u bounces, path %08x\n",
                      who, color.x, color.y, color.z, object, primitive, t, p.x, p.y, p.z, bounces, hash);
    } else {
        std::snprintf(line, sizeof(line), "      %-9s color (%.6g %.6g %.6g)  miss, path %08x\n", who, color.x, color.y,
                      color.z, hash);
    }
    out << line;
}

void printPixel(const verify::DifferingPixel& pixel, const glm::dvec3& origin, std::ostream& out) {
    char line[160];
    std::snprintf(line, sizeof(line), "    pixel %d,%d: difference %.6g, %s", pixel.x, pixel.y, pixel.difference,
                  verify::reasonName(pixel.reason));
    out << line;
    if (pixel.reason != verify::Reason::Unexplained) {
        std::snprintf(line, sizeof(line), " (rays moved by %.3g x 2^-24)", pixel.ulps);
        out << line;
    }
    out << '\n';
    const PixelData& d = pixel.device;
    printRecord("device", glm::dvec3(pixel.deviceColor), d.pathHash, d.bounces, d.object != PixelData::kNoIndex, d.object,
                d.primitive, d.depth, d.position, out);
    const reference::PixelRecord& r = pixel.reference;
    const bool hit = r.hit && r.surface;
    printRecord("reference", r.color, r.pathHash, r.bounces, hit, hit ? r.surface->object : 0, hit ? r.surface->primitive : 0,
                hit ? r.hit->t : 0, hit ? origin + r.surface->position : glm::dvec3(0), out);
}

void printReport(const std::string& scene, const verify::Report& report, const verify::Options& options,
                 const glm::dvec3& origin, std::ostream& out) {
    char line[400];
    const double share = 100.0 * static_cast<double>(report.explained()) / static_cast<double>(report.pixels);
    std::snprintf(line, sizeof(line),
                  "%s: %s\n    %llu pixels; differing: %llu edge, %llu tie (%.4f %% explained, at most %.2f %%), %llu unexplained\n"
                  "    RMSE %.3g; where the paths agree: RMSE %.3g, max %.3g\n",
                  scene.c_str(), report.passed(options) ? "ok" : "FAILED", static_cast<unsigned long long>(report.pixels),
                  static_cast<unsigned long long>(report.edges), static_cast<unsigned long long>(report.ties), share,
                  100 * options.maxExplainedShare, static_cast<unsigned long long>(report.unexplained), report.rmse,
                  report.rmseSamePath, report.maxSamePath);
    out << line;
    for (const verify::DifferingPixel& pixel : report.worst) printPixel(pixel, origin, out);
}

bool verifyScene(const VerifyCommand& command, const std::filesystem::path& path, const gpu::Device& device,
                 std::ostream& out, std::ostream& err) {
    SceneOptions sceneOptions = command.common;
    sceneOptions.scene = path;
    const LoadedScene loaded = loadAndPack(sceneOptions, err);
    render::Renderer renderer(device, loaded.packed);
    verify::Options options;
    options.width = loaded.scene.image.width;
    options.height = loaded.scene.image.height;
    options.sampleOffsets = sampleOffsets(loaded.scene.image.samplesPerPixel);
    options.cancelled = interrupted;
    Progress progress("verify " + path.filename().string(), command.progress, err, isTerminal(err));
    options.progress = [&](double fraction) { progress.update(fraction); };
    const shared::Camera camera = packCamera(loaded.scene.camera, options.width, options.height, loaded.packed.origin);
    const verify::Report report = verify::verify(renderer, loaded.packed, camera, options);
    progress.finish();
    if (report.interrupted) throw Error(ExitCode::Interrupted, "interrupted while verifying " + path.string());
    printReport(path.string(), report, options, loaded.packed.origin, out);
    const std::filesystem::path picture = command.folder / (path.stem().string() + ".verify.png");
    writeImage(picture, report.difference);
    out << "    wrote " << picture.string() << '\n';
    out.flush();
    return report.passed(options);
}

}  // namespace

int runVerify(const VerifyCommand& command, std::ostream& out, std::ostream& err) {
    const gpu::Device device({command.device.selector, command.device.validation});
    out << "device: " << device.info().name << ", " << device.info().driver << '\n';
    size_t failed = 0;
    for (const std::filesystem::path& scene : command.scenes) {
        if (!verifyScene(command, scene, device, out, err)) ++failed;
    }
    if (reportValidation(device, command.device, err)) {
        throw Error(ExitCode::Device, "the validation layer found faults (listed above)");
    }
    if (failed == 0) return static_cast<int>(ExitCode::Done);
    err << "glint: verify: " << failed << " of " << command.scenes.size() << " scenes differ from the reference\n";
    return static_cast<int>(ExitCode::Difference);
}

}  // namespace glint::app
