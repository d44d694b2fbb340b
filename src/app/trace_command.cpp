#include <ostream>

#include "app/commands.h"
#include "app/common.h"
#include "app/drawing.h"
#include "app/loading.h"
#include "app/ray_file.h"
#include "core/error.h"
#include "reference/loaded_truth.h"
#include "reference/trace_rays.h"
#include "render/ray_queries.h"
#include "render/renderer.h"
#include "verify/trace_batch.h"

namespace glint::app {

namespace {

struct TraceCommand {
    SceneOptions scene;
    std::string rays;  // a file, "-" for standard input, empty for --pixel
    std::optional<std::pair<int, int>> pixel;
    bool any = false;
    Backend backend = Backend::Gpu;
    DeviceChoice device;
};

void declare(OptionTable& table, TraceCommand& c) {
    addScene(table, c.scene);
    table.name("--rays", "FILE.csv",
               "read rays, one a line: ox,oy,oz,dx,dy,dz[,tmin[,tmax]]; - for standard input", c.rays);
    table.value("--pixel", "x,y", "trace the camera ray of a pixel, from the top left corner", c.pixel,
                parsePixel);
    table.flag("--any", "report only whether a ray hits anything", c.any);
    table.value("--size", "WxH", "image size for --pixel instead of the scene's", c.scene.size, parseSize);
    addCamera(table, c.scene);
    addMethods(table, c.scene);
    addBackend(table, c.backend);
    addDevice(table, c.device);
    addTraversal(table, c.device);
}

RayBatch batchOf(const TraceCommand& command, std::ostream& err) {
    RayBatch batch;
    batch.rays = readRays(command.rays);
    if (batch.rays.empty()) err << "glint: warning: " << command.rays << ": holds no rays\n";
    batch.detail = command.any ? HitDetail::Any : HitDetail::Surface;
    batch.methods = command.scene.methods;
    return batch;
}

// The camera ray of a pixel's middle. The device makes its own, in fp32, as it does for a picture.
std::vector<WorldHit> tracePixelOnDevice(const TraceCommand& command, const LoadedScene& loaded,
                                         const gpu::Device& device) {
    render::Options options;
    options.traversal = command.device.traversal;
    render::Renderer renderer(device, loaded.packed, options);
    const auto [x, y] = *command.pixel;
    const Request request = requestOf(loaded, command.scene);
    return {hitOf(renderer.pixel(cameraOf(loaded, request), request, x, y))};
}

std::vector<WorldHit> traceRaysOnDevice(const TraceCommand& command, const LoadedScene& loaded,
                                        const gpu::Device& device, const RayBatch& batch) {
    render::RayQueries queries(device, loaded.packed, command.device.traversal);
    return verify::traceBatch(queries, loaded.packed, batch);
}

std::vector<WorldHit> tracePixelOnHost(const TraceCommand& command, const LoadedScene& loaded) {
    const auto [x, y] = *command.pixel;
    const Request request = requestOf(loaded, command.scene);
    const reference::Tracer tracer(reference::truthOf(loaded), request,
                                   radianceBoundOf(loaded.packed, request));
    return {reference::trace(tracer,
                             tracer.cameraRay(reference::truthCamera(loaded, request), x + 0.5, y + 0.5))};
}

std::vector<WorldHit> traceOnHost(const LoadedScene& loaded, const RayBatch& batch) {
    const reference::Tracer tracer(reference::truthOf(loaded), {.methods = batch.methods}, 0);
    return reference::trace(tracer, batch);
}

void print(const TraceCommand& command, const std::vector<WorldHit>& hits, int digits, std::ostream& out) {
    out << kHitCsvHeading;
    for (const WorldHit& hit : hits) out << hitCsv(hit, digits, command.any);
}

void traceOnDevice(const TraceCommand& command, const LoadedScene& loaded, std::ostream& out,
                   std::ostream& err) {
    const gpu::Device device = openDevice(command.device, true);
    const std::vector<WorldHit> hits =
        command.pixel ? tracePixelOnDevice(command, loaded, device)
                      : traceRaysOnDevice(command, loaded, device, batchOf(command, err));
    print(command, hits, kDeviceDigits, out);
    reportValidation(device, command.device, err);
}

void checkPixel(const Request& image, std::pair<int, int> pixel) {
    if (pixel.first < 0 || pixel.second < 0 || pixel.first >= image.width || pixel.second >= image.height) {
        throw Error(ErrorKind::Argument, "--pixel: " + std::to_string(pixel.first) + "," +
                                             std::to_string(pixel.second) + " is outside the picture of " +
                                             std::to_string(image.width) + "x" +
                                             std::to_string(image.height) + " pixels");
    }
}

ExitCode run(const TraceCommand& command, std::ostream& out, std::ostream& err) {
    if (command.rays.empty() == !command.pixel)
        throw Error(ErrorKind::Argument, "trace: give either --rays FILE.csv or --pixel x,y");
    if (command.rays == "-" && command.scene.scene == "-")
        throw Error(ErrorKind::Argument, "--rays: SCENE reads standard input already");
    checkDeviceOptions(command.backend, command.device);
    const LoadedScene loaded = loadAndPack(command.scene, err);
    if (command.pixel) checkPixel(requestOf(loaded, command.scene), *command.pixel);
    if (command.backend == Backend::Gpu) {
        traceOnDevice(command, loaded, out, err);
    } else {
        print(command,
              command.pixel ? tracePixelOnHost(command, loaded) : traceOnHost(loaded, batchOf(command, err)),
              kReferenceDigits, out);
    }
    return ExitCode::Done;
}

}  // namespace

Run traceCommand(OptionTable& table) {
    return commandOf<TraceCommand>(table, declare, run);
}

}  // namespace glint::app
