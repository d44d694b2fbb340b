#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ostream>

#include "app/cli.h"
#include "app/common.h"
#include "app/exit_code.h"
#include "app/ray_file.h"
#include "core/error.h"
#include "reference/tracer.h"
#include "render/renderer.h"

namespace glint::app {

namespace {

constexpr const char* kHeader = "hit,t,u,v,object,primitive,px,py,pz,nx,ny,nz\n";

void printHit(std::ostream& out, int digits, double t, double u, double v, uint32_t object,
              uint32_t primitive, const glm::dvec3& p, const glm::dvec3& n) {
    char line[512];
    std::snprintf(line, sizeof(line), "1,%.*g,%.*g,%.*g,%u,%u,%.*g,%.*g,%.*g,%.*g,%.*g,%.*g\n", digits, t,
                  digits, u, digits, v, object, primitive, digits, p.x, digits, p.y, digits, p.z, digits, n.x,
                  digits, n.y, digits, n.z);
    out << line;
}

void printDeviceHit(std::ostream& out, double t, const PixelData& d) {
    printHit(out, 9, t, d.u, d.v, d.object, d.primitive, d.position, glm::dvec3(d.geometricNormal));
}

void printMiss(std::ostream& out) {
    out << "0,,,,,,,,,,,\n";
}
void printAny(std::ostream& out, bool hit) {
    out << (hit ? "1,,,,,,,,,,,\n" : "0,,,,,,,,,,,\n");
}

// Squares of directions far from unit length overflow or vanish, in fp32 at 2^64 already. Such a ray is
// scaled by 2^-exponent, which is exact; its t is 2^exponent times the user's. Returns the exponent.
int scaleDirection(reference::Ray& ray) {
    constexpr int kHarmless = 32;  // the square of 2^32, times 1e18, is far inside fp32's range
    const glm::dvec3 size = glm::abs(ray.direction);
    const double greatest = std::max({size.x, size.y, size.z});
    if (!(greatest > 0 && std::isfinite(greatest))) return 0;  // it misses
    const int exponent = std::ilogb(greatest);
    if (std::abs(exponent) <= kHarmless) return 0;
    for (int axis = 0; axis < 3; ++axis) ray.direction[axis] = std::scalbn(ray.direction[axis], -exponent);
    ray.tMin = std::scalbn(ray.tMin, exponent);
    ray.tMax = std::scalbn(ray.tMax, exponent);
    return exponent;
}

render::RayInput toDevice(const reference::Ray& ray) {
    // kInfinity stands for all that fp32 cannot hold: there is no geometry that far away. NaN stays NaN and
    // misses.
    const auto bound = [](double t) {
        const double limit = static_cast<double>(shared::kInfinity);
        return static_cast<float>(std::clamp(t, -limit, limit));
    };
    return {glm::vec3(ray.origin), glm::vec3(ray.direction), bound(ray.tMin), bound(ray.tMax)};
}

// Rays in local coordinates.
struct Rays {
    std::vector<reference::Ray> rays;
    std::vector<int> exponents;  // of scaleDirection

    double userT(size_t i, double t) const { return std::scalbn(t, -exponents[i]); }
};

Rays raysOf(const TraceCommand& command, const LoadedScene& loaded, std::ostream& err) {
    if (command.pixel) {
        const auto [x, y] = *command.pixel;
        return {{reference::Tracer(loaded.packed).cameraRay(cameraOf(loaded), x + 0.5, y + 0.5)}, {0}};
    }
    Rays result = {readRays(command.rays), {}};
    if (result.rays.empty()) err << "glint: warning: " << command.rays << ": holds no rays\n";
    for (reference::Ray& ray : result.rays) {
        ray.origin -= loaded.packed.origin;
        result.exponents.push_back(scaleDirection(ray));
    }
    return result;
}

render::Options optionsOf(const TraceCommand& command) {
    render::Options options;
    options.traversal = command.device.traversal;
    return options;
}

void traceOnDevice(const TraceCommand& command, const LoadedScene& loaded, const Rays& rays,
                   std::ostream& out, std::ostream& err) {
    const gpu::Device device({command.device.selector, command.device.validation});
    std::vector<render::RayInput> inputs(rays.rays.size());
    std::transform(rays.rays.begin(), rays.rays.end(), inputs.begin(), toDevice);
    std::vector<render::RayHit> hits;
    {
        render::Renderer renderer(device, loaded.packed, optionsOf(command));
        hits = renderer.trace(inputs, command.any);
    }
    out << kHeader;
    for (size_t i = 0; i < hits.size(); ++i) {
        if (command.any) {
            printAny(out, hits[i].hit);
        } else if (!hits[i].hit) {
            printMiss(out);
        } else {
            printDeviceHit(out, rays.userT(i, static_cast<double>(hits[i].t)), hits[i].data);
        }
    }
    reportValidation(device, command.device, err);
}

void traceOnHost(const TraceCommand& command, const PackedScene& packed, const Rays& rays,
                 std::ostream& out) {
    const reference::Tracer tracer(packed);
    out << kHeader;
    for (size_t i = 0; i < rays.rays.size(); ++i) {
        const reference::Ray& ray = rays.rays[i];
        if (command.any) {
            printAny(out, tracer.occluded(ray));
            continue;
        }
        const auto hit = tracer.closest(ray);
        if (!hit) {
            printMiss(out);
            continue;
        }
        const reference::Surface s = tracer.surface(ray, *hit);
        printHit(out, 17, rays.userT(i, hit->t), hit->u, hit->v, s.object, s.primitive,
                 packed.origin + s.position, s.geometricNormal);
    }
}

void checkPixel(const LoadedScene& loaded, std::pair<int, int> pixel) {
    const ImageSettings& image = loaded.scene.image;
    if (pixel.first < 0 || pixel.second < 0 || pixel.first >= image.width || pixel.second >= image.height) {
        throw Error(ErrorKind::Argument, "--pixel: " + std::to_string(pixel.first) + "," +
                                             std::to_string(pixel.second) + " is outside the picture of " +
                                             std::to_string(image.width) + "x" +
                                             std::to_string(image.height) + " pixels");
    }
}

// The device makes the camera ray itself, in fp32, as it does for a picture.
void tracePixelOnDevice(const TraceCommand& command, const LoadedScene& loaded, std::ostream& out,
                        std::ostream& err) {
    const gpu::Device device({command.device.selector, command.device.validation});
    Request wanted;
    wanted.width = loaded.scene.image.width;
    wanted.height = loaded.scene.image.height;
    const auto [x, y] = *command.pixel;
    wanted.region = {x, y, x + 1, y + 1};
    wanted.data = true;
    PixelData data;
    {
        render::Renderer renderer(device, loaded.packed, optionsOf(command));
        data = renderer.render(cameraOf(loaded), wanted).data[0];
    }
    out << kHeader;
    const bool hit = data.object != PixelData::kNoIndex;
    if (command.any) {
        printAny(out, hit);
    } else if (hit) {
        printDeviceHit(out, data.depth, data);
    } else {
        printMiss(out);
    }
    reportValidation(device, command.device, err);
}

}  // namespace

int runTrace(const TraceCommand& command, std::ostream& out, std::ostream& err) {
    const LoadedScene loaded = loadAndPack(command.scene, err);
    if (command.pixel) checkPixel(loaded, *command.pixel);
    if (command.pixel && command.backend == Backend::Gpu) {
        tracePixelOnDevice(command, loaded, out, err);
    } else if (command.backend == Backend::Gpu) {
        traceOnDevice(command, loaded, raysOf(command, loaded, err), out, err);
    } else {
        traceOnHost(command, loaded.packed, raysOf(command, loaded, err), out);
    }
    return static_cast<int>(ExitCode::Done);
}

}  // namespace glint::app
