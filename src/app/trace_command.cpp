#include <memory>
#include <ostream>

#include "app/commands.h"
#include "app/ray_file.h"
#include "app/rendering.h"
#include "app/trace_batch.h"
#include "core/format.h"
#include "reference/render.h"
#include "reference/truth/truth.h"
#include "render/ray_queries.h"
#include "render/renderer.h"

namespace glint::app {

namespace {

struct TraceCommand {
    SceneOptions scene;
    std::string rays;  // a file, "-" for standard input, empty for --pixel
    std::optional<std::pair<int, int>> pixel;
    bool any = false;
    DeviceChoice device;
};

void declare(OptionTable& table, TraceCommand& c) {
    addScene(table, c.scene);
    table.name("--rays", "FILE.csv",
               "read rays, one per line: ox,oy,oz,dx,dy,dz[,tmin[,tmax]]; -: standard input", c.rays);
    table.value("--pixel", "x,y", "trace the camera ray of a pixel, from the top left corner", c.pixel,
                parsePixel);
    table.exclude("--rays", "--pixel", "give one of them");
    table.flag("--any", "test only whether a ray hits anything", c.any);
    table.value("--size", "WxH", "image size for --pixel (default: the scene's)", c.scene.size, parseSize);
    addCamera(table, c.scene);
    addMethods(table, c.scene);
    addBackend(table, c.device);
    addDevice(table, c.device);
    addTraversal(table, c.device);
    table.requireGpu({"--device", "--validation", "--traversal"});
}

RayBatch batchOf(const TraceCommand& command, std::ostream& err) {
    RayBatch batch = {.rays = readRays(command.rays),
                      .detail = command.any ? HitDetail::Any : HitDetail::Surface,
                      .methods = command.scene.methods};
    if (batch.rays.empty()) err << "glint: warning: " << command.rays << ": holds no rays\n";
    return batch;
}

// The camera ray goes through the pixel's centre. The device makes its own, in fp32, as it does for an image.
std::vector<WorldHit> traceOnDevice(const TraceCommand& command, const LoadedScene& loaded,
                                    const Request& request, const gpu::Device& device, std::ostream& err) {
    if (!command.pixel) {
        render::RayQueries queries(device, loaded.packed, command.device.traversal);
        return traceBatch(queries, loaded.packed, batchOf(command, err));
    }
    render::Options options;
    options.traversal = command.device.traversal;
    render::Renderer renderer(device, loaded.packed, options);
    return {hitOf(renderer.pixel(request, command.pixel->first, command.pixel->second))};
}

std::vector<WorldHit> traceOnHost(const TraceCommand& command, const LoadedScene& loaded,
                                  const Request& request, std::ostream& err) {
    const auto truth =
        std::make_shared<const reference::Model>(reference::truthOf(loaded.scene, loaded.packed.origin));
    if (!command.pixel) {
        const RayBatch batch = batchOf(command, err);
        return reference::trace(reference::Tracer(truth, {.methods = batch.methods}, 0), batch);
    }
    const reference::Tracer tracer(truth, request, radianceBoundOf(loaded.packed, request));
    const reference::rows::Camera camera =
        reference::truthCamera(request.camera, request.width, request.height, loaded.packed.origin);
    return {reference::trace(
        tracer, tracer.cameraRay(camera, command.pixel->first + 0.5, command.pixel->second + 0.5))};
}

void checkPixel(const Request& image, std::pair<int, int> pixel) {
    const auto [x, y] = pixel;
    refuseIf(x < 0 || y < 0 || x >= image.width || y >= image.height,
             format("--pixel: %d,%d is outside the image of %dx%d pixels", x, y, image.width, image.height));
}

ExitCode run(const TraceCommand& command, std::ostream& out, std::ostream& err) {
    refuseIf(command.rays.empty() && !command.pixel, "trace: give either --rays FILE.csv or --pixel x,y");
    refuseIf(command.rays == "-" && command.scene.scene == "-",
             "--rays -: SCENE reads standard input; read the rays from a file");
    checkStandardOutput(out);
    const LoadedScene loaded = loadAndPack(command.scene, err);
    const Request request = command.pixel ? requestOf(loaded, command.scene) : Request();
    if (command.pixel) checkPixel(request, *command.pixel);
    std::optional<gpu::Device> device;
    if (command.device.backend == Backend::Gpu) device.emplace(openDevice(command.device));
    const std::vector<WorldHit> hits = device ? traceOnDevice(command, loaded, request, *device, err)
                                              : traceOnHost(command, loaded, request, err);
    out << kHitCsvHeading;
    for (const WorldHit& hit : hits)
        out << hitCsv(hit, device ? kDeviceDigits : kReferenceDigits, command.any);
    if (device) checkValidation(*device, command.device);
    return ExitCode::Done;
}

}  // namespace

Run traceCommand(OptionTable& table) {
    return commandOf<TraceCommand>(table, declare, run);
}

}  // namespace glint::app
