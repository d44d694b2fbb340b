#include "app/render_identity.h"

#include "app/common.h"
#include "app/version.h"
#include "core/content_hash.h"
#include "core/text_file.h"
#include "scene/sampling.h"

namespace glint::app {

namespace {

std::string samplesText(const ImageSettings& image) {
    std::string text = std::to_string(image.samplesPerPixel) + " " + std::string(nameOf(samplerOf(image))) +
                       ", filter " + std::string(nameOf(image.filter)) + " " + describe(image.filterRadius) +
                       ", seed " + std::to_string(image.seed);
    if (image.adaptive)
        text += ", adaptive " + std::to_string(image.adaptive->maxSamples) + "," +
                describe(image.adaptive->threshold);
    return text;
}

std::string regionText(const Region& r) {
    return std::to_string(r.x0) + "," + std::to_string(r.y0) + "," + std::to_string(r.x1) + "," +
           std::to_string(r.y1);
}

std::string layersText(const std::vector<Aov>& aovs) {
    std::string text;
    for (const Aov aov : aovs) text += (text.empty() ? "" : ",") + std::string(nameOf(aov));
    return text;
}

}  // namespace

farm::Identity identityOf(const RenderCommand& command, const LoadedScene& loaded, const Request& request) {
    const Scene& scene = loaded.scene;
    farm::Identity identity;
    const auto add = [&](const std::string& name, const std::string& value) {
        identity.facts.emplace_back(name, value);
    };
    add("glint", std::string(GLINT_VERSION) + " of commit " + builtCommit());
    add("scene", command.scene.scene.filename().string());
    for (const SourceFile& file : scene.sources) add("file " + file.name, hashText(file.hash));
    if (!command.scene.camera.empty()) add("camera", command.scene.camera);
    if (command.scene.time) add("time", describe(*command.scene.time));
    add("size", std::to_string(request.width) + "x" + std::to_string(request.height));
    add("crop", regionText(regionOf(request)));
    add("samples", samplesText(request.image));
    add("maxDepth", std::to_string(depthOf(loaded, request)));
    add("min-contribution", describe(command.scene.minContribution));
    add("intersector", std::string(nameOf(command.scene.methods.triangles)));
    add("sphere", std::string(nameOf(command.scene.methods.spheres)));
    add("layers", layersText(command.aovs));
    add("backend", std::string(nameOf(command.backend)));
    add("traversal", std::string(nameOf(command.device.traversal)));
    add("build-quality", std::string(nameOf(command.scene.buildQuality)));
    return identity;
}

}  // namespace glint::app
