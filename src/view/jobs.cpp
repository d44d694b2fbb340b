#include "view/jobs.h"

#include <cmath>
#include <cstdio>

#include "core/error.h"
#include "core/image_io.h"
#include "pack/pack_samples.h"
#include "scene/sampling.h"
#include "verify/verify.h"

namespace glint::view {

namespace {

bool isExr(const std::filesystem::path& file) {
    return file.extension() == ".exr" || file.extension() == ".EXR";
}

}  // namespace

SaveRequest saveRequest(const Session& session, const std::filesystem::path& file, int samplesPerPixel,
                        double exposure) {
    SaveRequest request;
    request.file = file;
    request.scene = session.sharedScene();
    request.tracing = session.tracing();
    request.camera = session.packedCamera();
    request.width = session.width();
    request.height = session.height();
    request.samplesPerPixel = samplesPerPixel;
    request.exposure = exposure;
    return request;
}

std::string save(const gpu::Device& device, SaveRequest request, JobControl& control) {
    ImageSettings image = request.scene->scene.image;
    image.samplesPerPixel = request.samplesPerPixel;
    const std::string conflict = samplingConflict(image);
    if (!conflict.empty()) return "not saved: " + conflict;
    image.width = request.width;
    image.height = request.height;
    Request wanted = requestOf(image, false);  // the window's camera is a pinhole
    static_cast<Tracing&>(wanted) = request.tracing;
    wanted.data = wanted.cost = isExr(request.file);
    wanted.progress = [&](double fraction) { control.progress = fraction; };
    wanted.cancelled = [&] { return control.cancelled.load(); };
    render::Renderer renderer(device, request.scene->packed, windowOptions(*request.scene));
    Picture picture = renderer.render(request.camera, wanted);
    if (!picture.complete) return "saving stopped";
    if (!isExr(request.file) && request.exposure != 0) {
        const auto gain = static_cast<float>(std::exp2(request.exposure));
        for (size_t i = 0; i < picture.color.pixels.size(); ++i) {
            if (i % 4 != 3) picture.color.pixels[i] *= gain;
        }
    }
    std::vector<Aov> layers = {Aov::Radiance};
    if (isExr(request.file)) {
        layers.clear();
        for (const EnumEntry<Aov>& entry : kEnumEntries<Aov>) {
            // The number of samples is the same for all pixels, and nobody has judged their error.
            if (entry.value != Aov::Error && entry.value != Aov::Samples) layers.push_back(entry.value);
        }
    }
    writeLayers(request.file, makeLayers(picture, layers));
    return "saved " + request.file.string() + " (" + std::to_string(request.width) + "x" +
           std::to_string(request.height) +
           ", samples per pixel: " + std::to_string(request.samplesPerPixel) + ")";
}

VerifyResult verifyView(const gpu::Device& device, SaveRequest request, JobControl& control) {
    render::Renderer renderer(device, request.scene->packed, windowOptions(*request.scene));
    verify::Options options;
    static_cast<Tracing&>(options) = request.tracing;
    options.width = request.width;
    options.height = request.height;
    options.progress = [&](double fraction) { control.progress = fraction; };
    options.cancelled = [&] { return control.cancelled.load(); };
    verify::Report report = verify::verify(renderer, request.scene->packed, request.camera, options);
    VerifyResult result;
    result.passed = report.passed();
    char text[256];
    std::snprintf(text, sizeof(text),
                  "%s: %llu pixels, %llu explained (%llu ties, %llu edges), %llu unexplained, RMSE %.3g",
                  report.interrupted ? "stopped"
                  : result.passed    ? "passed"
                                     : "FAILED",
                  static_cast<unsigned long long>(report.pixels),
                  static_cast<unsigned long long>(report.explained()),
                  static_cast<unsigned long long>(report.ties), static_cast<unsigned long long>(report.edges),
                  static_cast<unsigned long long>(report.unexplained), report.rmse);
    result.text = text;
    result.difference = std::move(report.difference);
    return result;
}

std::filesystem::path freeName(const std::filesystem::path& folder, const std::string& stem,
                               const std::string& extension) {
    for (int i = 1; i < 10000; ++i) {
        char number[24];
        std::snprintf(number, sizeof(number), "-view-%03d", i);
        const std::filesystem::path candidate = folder / (stem + number + extension);
        std::error_code error;
        if (!std::filesystem::exists(candidate, error)) return candidate;
    }
    throw Error(ErrorKind::Failed, folder.string() + ": holds 9999 saved views of this scene; remove some");
}

}  // namespace glint::view
