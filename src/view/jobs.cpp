#include "view/jobs.h"

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "core/error.h"
#include "core/image_io.h"
#include "core/text_file.h"
#include "pack/pack_samples.h"
#include "reference/render.h"
#include "scene/sampling.h"
#include "verify/verify.h"

namespace glint::view {

namespace {

bool isExr(const std::filesystem::path& file) {
    return lowerExtension(file) == ".exr";
}

// A claimed file that nothing was written to goes away with this.
class Claim {
  public:
    explicit Claim(const std::filesystem::path& file) : file_(file) {}
    ~Claim() {
        std::error_code error;
        if (std::filesystem::file_size(file_, error) == 0 && !error) std::filesystem::remove(file_, error);
    }
    Claim(const Claim&) = delete;
    Claim& operator=(const Claim&) = delete;

  private:
    std::filesystem::path file_;
};

// Every layer that an image of the window can have: the number of samples is the same for all pixels, and
// nobody has judged their error.
std::vector<Aov> allLayers() {
    std::vector<Aov> layers;
    for (const EnumEntry<Aov>& entry : kEnumEntries<Aov>)
        if (entry.value != Aov::Error && entry.value != Aov::Samples) layers.push_back(entry.value);
    return layers;
}

void applyDisplay(Image& color, const Display& display) {
    if (display == Display{}) return;
    const auto gain = static_cast<float>(std::exp2(display.exposure));
    for (size_t i = 0; i < color.pixels.size(); i += 4) {
        const glm::dvec3 c(gain * glm::vec3(color.pixels[i], color.pixels[i + 1], color.pixels[i + 2]));
        const glm::dvec3 shown = display.toneMap == ToneMap::False ? heatLinear(falseColorOf(luminance(c)))
                                                                   : toneMapped(c, display.toneMap);
        for (int k = 0; k < 3; ++k) color.pixels[i + static_cast<size_t>(k)] = static_cast<float>(shown[k]);
    }
}

// The part of a request, or of verify::Options, that all work on a view has in common.
template <typename Wanted>
void ofView(const ViewRequest& view, JobControl& control, Wanted& wanted) {
    static_cast<Tracing&>(wanted) = view.tracing;
    wanted.width = view.width;
    wanted.height = view.height;
    wanted.progress = [&](double fraction) { control.progress = fraction; };
    wanted.cancelled = [&] { return control.cancelled.load(); };
}

// The view by the device. Throws Error(Failed) if it is stopped.
Picture rendered(const gpu::Device& device, const ViewRequest& view, Request wanted,
                 const std::filesystem::path& file, JobControl& control) {
    ofView(view, control, wanted);
    render::Renderer renderer(device, view.scene->packed, windowOptions(*view.scene));
    Picture picture = renderer.render(view.camera, wanted);
    if (!picture.complete) throw Error(ErrorKind::Failed, "saving stopped: " + file.string());
    return picture;
}

std::string line(const std::filesystem::path& file, const ViewRequest& view, const std::string& how) {
    return "saved " + file.string() + " (" + std::to_string(view.width) + "x" + std::to_string(view.height) +
           ", " + how + ")";
}

}  // namespace

ViewRequest viewRequest(const Session& session) {
    ViewRequest request;
    request.scene = session.sharedScene();
    request.tracing = session.tracing();
    request.camera = session.packedCamera();
    request.lens = hasLens(session.camera());
    request.width = session.width();
    request.height = session.height();
    return request;
}

SeenRequest seenRequest(const Session& session, const std::filesystem::path& file, const Display& display) {
    SeenRequest request;
    request.view = viewRequest(session);
    request.file = file;
    request.layer = session.settings().layer;
    request.display = display;
    request.samples = session.samples();
    request.hasData = session.hasData();
    if (isExr(file)) {
        request.picture = session.picture();
    } else if (session.ready()) {
        request.canvas = session.canvas(display);
    }
    return request;
}

std::string save(const gpu::Device& device, const RenderRequest& request, JobControl& control) {
    const Claim claim(request.file);
    const std::string conflict = samplingConflict(request.sampling);
    if (!conflict.empty()) throw Error(ErrorKind::Failed, "not saved: " + conflict);
    Request wanted = requestOf(request.sampling, request.view.lens);
    wanted.data = wanted.cost = isExr(request.file);
    Picture picture = rendered(device, request.view, wanted, request.file, control);
    if (!isExr(request.file)) applyDisplay(picture.color, request.display);
    const std::vector<Aov> one = {Aov::Radiance};
    writeLayers(request.file, makeLayers(picture, isExr(request.file) ? allLayers() : one));
    return line(request.file, request.view,
                "samples per pixel: " + std::to_string(request.sampling.samplesPerPixel));
}

std::string save(const gpu::Device& device, SeenRequest request, JobControl& control) {
    const Claim claim(request.file);
    const bool exr = isExr(request.file);
    const bool lacksColor = request.samples == 0 && (exr || !needsData(request.layer));
    const bool lacksData = !request.hasData && (exr || needsData(request.layer));
    if (!request.canvas && (lacksColor || lacksData)) {
        Request wanted;
        wanted.data = wanted.cost = lacksData;
        Picture traced = rendered(device, request.view, wanted, request.file, control);
        request.picture.region = traced.region;
        if (lacksColor) {
            request.picture.color = std::move(traced.color);
            request.samples = 1;
        }
        if (lacksData) request.picture.data = std::move(traced.data);
    }
    if (exr) {
        writeLayers(request.file, makeLayers(request.picture, allLayers()));
    } else {
        if (!request.canvas)
            request.canvas = colorize(request.picture, request.layer, request.display,
                                      rangeOf(request.picture, request.layer));
        writeImage(request.file, toImage(*request.canvas));
    }
    const bool data = !exr && needsData(request.layer);
    return line(request.file, request.view,
                "as seen: " + (data ? std::string(nameOf(request.layer))
                                    : std::to_string(request.samples) +
                                          (request.samples == 1 ? " sample" : " samples")));
}

VerifyResult verifyView(const gpu::Device& device, const ViewRequest& request, JobControl& control) {
    render::Renderer renderer(device, request.scene->packed, windowOptions(*request.scene));
    verify::Options options;
    ofView(request, control, options);
    verify::Report report = verify::verify(renderer, request.scene->packed, request.camera, options);
    VerifyResult result;
    result.passed = report.passed();
    char text[256];
    std::snprintf(
        text, sizeof(text), "%s: %llu pixels, %llu explained (%llu edges), %llu unexplained, RMSE %.3g",
        report.interrupted ? "stopped"
        : result.passed    ? "passed"
                           : "FAILED",
        static_cast<unsigned long long>(report.pixels), static_cast<unsigned long long>(report.explained()),
        static_cast<unsigned long long>(report.edges), static_cast<unsigned long long>(report.unexplained),
        report.rmse);
    result.text = text;
    result.difference = std::move(report.difference);
    return result;
}

Image traceReference(const ViewRequest& request, const PackedSamples& samples, JobControl& control) {
    Request wanted;
    ofView(request, control, wanted);
    wanted.samples = samples;
    Picture picture = reference::render(request.scene->packed, request.camera, wanted);
    if (!picture.complete) throw Error(ErrorKind::Failed, "the reference was stopped");
    return std::move(picture.color);
}

std::filesystem::path claimName(const std::filesystem::path& folder, const std::string& stem,
                                const std::string& extension) {
    for (int i = 1; i < 10000; ++i) {
        char number[24];
        std::snprintf(number, sizeof(number), "-view-%03d", i);
        const std::filesystem::path candidate = folder / (stem + number + extension);
        // "x": fails if the file is there, and nobody can come in between.
        if (std::FILE* file = std::fopen(candidate.c_str(), "wx")) {
            std::fclose(file);
            return candidate;
        }
        if (errno != EEXIST) throw Error(ErrorKind::Failed, candidate.string() + ": " + std::strerror(errno));
    }
    throw Error(ErrorKind::Failed, folder.string() + ": holds 9999 saved views of this scene; remove some");
}

}  // namespace glint::view
