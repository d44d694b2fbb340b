#include <charconv>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <ostream>

#include "app/cli.h"
#include "app/common.h"
#include "core/error.h"
#include "reference/tracer.h"
#include "render/renderer.h"

namespace glint::app {

namespace {

constexpr const char* kHeader = "hit,t,u,v,object,primitive,px,py,pz,nx,ny,nz\n";

// World coordinates, as read.
struct InputRay {
    double v[8] = {0, 0, 0, 0, 0, 0, 0, std::numeric_limits<double>::infinity()};
};

std::string trimmed(const std::string& text) {
    const size_t first = text.find_first_not_of(" \t\r");
    if (first == std::string::npos) return "";
    return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

InputRay parseRay(const std::string& line, const std::string& where) {
    InputRay ray;
    size_t count = 0, start = 0;
    for (bool last = false; !last; ++count) {
        const size_t comma = line.find(',', start);
        last = comma == std::string::npos;
        const std::string field = trimmed(line.substr(start, last ? std::string::npos : comma - start));
        double value = 0;
        const char* begin = field.c_str() + (field.starts_with('+') ? 1 : 0);
        const auto [end, error] = std::from_chars(begin, field.c_str() + field.size(), value);
        if (error == std::errc::invalid_argument || end != field.c_str() + field.size()) {
            throw Error(ExitCode::Scene, where + ": expected a number, got \"" + field + "\"");
        }
        if (error == std::errc::result_out_of_range) {
            throw Error(ExitCode::Scene, where + ": number out of range: \"" + field + "\"");
        }
        if (count < 8) ray.v[count] = value;
        start = comma + 1;
    }
    if (count < 6 || count > 8) {
        throw Error(ExitCode::Scene, where + ": expected 6 to 8 numbers ox,oy,oz,dx,dy,dz[,tmin[,tmax]], got " + std::to_string(count));
    }
    return ray;
}

std::vector<InputRay> readRays(const std::string& name) {
    std::ifstream file;
    if (name != "-") {
        file.open(name);
        if (!file) throw Error(ExitCode::Scene, name + ": cannot read the rays");
    }
    std::istream& in = name == "-" ? std::cin : file;
    std::vector<InputRay> rays;
    std::string line;
    for (size_t number = 1; std::getline(in, line); ++number) {
        const std::string text = trimmed(line.substr(0, line.find('#')));
        if (text.empty() || (rays.empty() && text.starts_with("ox,"))) continue;
        rays.push_back(parseRay(text, (name == "-" ? "standard input" : name) + ":" + std::to_string(number)));
    }
    if (in.bad()) throw Error(ExitCode::Scene, name + ": cannot read the rays");
    return rays;
}

void printHit(std::ostream& out, int digits, double t, double u, double v, uint32_t object, uint32_t primitive,
              const glm::dvec3& p, const glm::dvec3& n) {
    char line[512];
    std::snprintf(line, sizeof(line), "1,%.*g,%.*g,%.*g,%u,%u,%.*g,%.*g,%.*g,%.*g,%.*g,%.*g\n", digits, t, digits, u, digits,
                  v, object, primitive, digits, p.x, digits, p.y, digits, p.z, digits, n.x, digits, n.y, digits, n.z);
    out << line;
}

void printMiss(std::ostream& out) { out << "0,,,,,,,,,,,\n"; }
void printAny(std::ostream& out, bool hit) { out << (hit ? "1,,,,,,,,,,,\n" : "0,,,,,,,,,,,\n"); }

void traceOnDevice(const TraceCommand& command, const LoadedScene& loaded, const std::vector<InputRay>& rays,
                   std::ostream& out, std::ostream& err) {
    const gpu::Device device({command.device.selector, command.device.validation});
    render::Renderer renderer(device, loaded.packed);
    std::vector<render::RayInput> inputs;
    inputs.reserve(rays.size());
    for (const InputRay& r : rays) {
        const glm::dvec3 origin = glm::dvec3(r.v[0], r.v[1], r.v[2]) - loaded.packed.origin;
        // Past the largest float there is no hit anyway; NaN stays NaN and misses.
        const auto bound = [](double x) { return static_cast<float>(std::min(x, static_cast<double>(shared::kInfinity))); };
        inputs.push_back({glm::vec3(origin), glm::vec3(r.v[3], r.v[4], r.v[5]), bound(r.v[6]), bound(r.v[7])});
    }
    for (const render::RayHit& hit : renderer.trace(inputs, command.any)) {
        if (command.any) {
            printAny(out, hit.hit);
        } else if (!hit.hit) {
            printMiss(out);
        } else {
            const PixelData& d = hit.data;
            printHit(out, 9, hit.t, d.u, d.v, d.object, d.primitive, d.position, glm::dvec3(d.geometricNormal));
        }
    }
    if (reportValidation(device, command.device, err)) throw Error(ExitCode::Device, "the validation layer found faults (listed above)");
}

void traceOnHost(const TraceCommand& command, const PackedScene& packed, const std::vector<InputRay>& rays, std::ostream& out) {
    const reference::Tracer tracer(packed);
    for (const InputRay& r : rays) {
        reference::Ray ray;
        ray.origin = glm::dvec3(r.v[0], r.v[1], r.v[2]) - packed.origin;
        ray.direction = {r.v[3], r.v[4], r.v[5]};
        ray.tMin = r.v[6];
        ray.tMax = r.v[7];
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
        printHit(out, 17, hit->t, hit->u, hit->v, s.object, s.primitive, packed.origin + s.position, s.geometricNormal);
    }
}

// The camera ray of the pixel's centre, in double, as a ray of the list; the device makes its own in fp32.
InputRay pixelRay(const LoadedScene& loaded, std::pair<int, int> pixel) {
    const ImageSettings& image = loaded.scene.image;
    if (pixel.first < 0 || pixel.second < 0 || pixel.first >= image.width || pixel.second >= image.height) {
        throw Error(ExitCode::Usage, "--pixel: " + std::to_string(pixel.first) + "," + std::to_string(pixel.second) +
                                         " is outside the picture of " + std::to_string(image.width) + "x" +
                                         std::to_string(image.height) + " pixels");
    }
    const shared::Camera camera = packCamera(loaded.scene.camera, image.width, image.height, loaded.packed.origin);
    const reference::Ray ray = reference::Tracer(loaded.packed).cameraRay(camera, pixel.first + 0.5, pixel.second + 0.5);
    const glm::dvec3 o = ray.origin + loaded.packed.origin;
    return {{o.x, o.y, o.z, ray.direction.x, ray.direction.y, ray.direction.z, ray.tMin, ray.tMax}};
}

void tracePixelOnDevice(const TraceCommand& command, const LoadedScene& loaded, std::ostream& out) {
    pixelRay(loaded, *command.pixel);  // checks the range
    const gpu::Device device({command.device.selector, command.device.validation});
    render::Renderer renderer(device, loaded.packed);
    render::RenderSettings settings;
    settings.width = loaded.scene.image.width;
    settings.height = loaded.scene.image.height;
    const auto [x, y] = *command.pixel;
    settings.region = {x, y, x + 1, y + 1};
    settings.data = true;
    const Picture picture =
        renderer.render(packCamera(loaded.scene.camera, settings.width, settings.height, loaded.packed.origin), settings);
    const PixelData& d = picture.data[0];
    if (d.object == PixelData::kNoIndex) return printMiss(out);
    printHit(out, 9, d.depth, d.u, d.v, d.object, d.primitive, d.position, glm::dvec3(d.geometricNormal));
}

}  // namespace

int runTrace(const TraceCommand& command, std::ostream& out, std::ostream& err) {
    const LoadedScene loaded = loadAndPack(command.scene, err);
    if (command.pixel && !command.any && command.backend == Backend::Gpu) {
        out << kHeader;
        tracePixelOnDevice(command, loaded, out);
        return static_cast<int>(ExitCode::Done);
    }
    const std::vector<InputRay> rays =
        command.pixel ? std::vector<InputRay>{pixelRay(loaded, *command.pixel)} : readRays(command.rays);
    out << kHeader;
    if (command.backend == Backend::Cpu) {
        traceOnHost(command, loaded.packed, rays, out);
    } else {
        traceOnDevice(command, loaded, rays, out, err);
    }
    return static_cast<int>(ExitCode::Done);
}

}  // namespace glint::app
