#include "app/render_options.h"

#include <algorithm>
#include <cmath>

#include "app/common.h"
#include "core/error.h"
#include "core/image_io.h"
#include "core/interrupt.h"
#include "core/text_file.h"

namespace glint::app {

bool needsData(const RenderCommand& command) {
    return std::any_of(command.aovs.begin(), command.aovs.end(),
                       [](Aov aov) { return glint::needsData(aov); });
}

std::filesystem::path outputOf(const RenderCommand& command) {
    const std::filesystem::path name =
        command.scene.scene == "-" ? "stdin.png" : command.scene.scene.filename().replace_extension(".png");
    if (command.output.empty()) return name;
    return command.output.has_filename() ? command.output : command.output / name;
}

std::filesystem::path outputOf(const RenderCommand& command, const Scene& scene) {
    const auto isRead = [&](const std::filesystem::path& output) {
        return std::any_of(scene.sources.begin(), scene.sources.end(), [&](const SourceFile& file) {
            std::error_code ignored;  // a file that does not exist cannot be lost
            return std::filesystem::equivalent(command.scene.scene.parent_path() / file.name, output,
                                               ignored);
        });
    };
    std::filesystem::path output = outputOf(command);
    if (!isRead(output)) return output;
    const std::string name = output.string();
    if (command.output.empty() && !isRead(output.replace_extension(".render.png"))) return output;
    throw Error(ErrorKind::Argument, name + ": is read by the scene; name another file with --output");
}

float scaleOf(const std::filesystem::path& output, std::optional<double> exposure) {
    if (output == "-" || lowerExtension(output) == ".png")
        return static_cast<float>(std::exp2(exposure.value_or(0)));
    if (exposure && isWritableImagePath(output))
        throw Error(ErrorKind::Argument,
                    "--exposure: " + output.string() + " holds linear floats, which need none; use .png");
    return 0;
}

void expose(std::vector<Layer>& layers, float scale) {
    if (scale == 0 || scale == 1) return;
    for (Layer& layer : layers)
        if (layer.name == "color")
            for (size_t i = 0; i < layer.image.pixels.size(); ++i)
                if (layer.image.channels < 4 || i % 4 < 3) layer.image.pixels[i] *= scale;
}

std::vector<Layer> layersOf(const Picture& picture, const RenderCommand& command) {
    std::vector<Layer> layers = makeLayers(picture, command.aovs);
    expose(layers, scaleOf(outputOf(command), command.exposure));
    return layers;
}

uint64_t bytesPerPixel(const std::vector<Aov>& aovs, bool data) {
    return 4 * sizeof(float) + 1 + (data ? sizeof(PixelData) : 0) + aovs.size() * 3 * sizeof(float);
}

Request requestOf(const RenderCommand& command, const LoadedScene& loaded) {
    SceneOptions wishes = command.scene;
    wishes.untilError = command.target.error.has_value();
    Request request = requestOf(loaded, wishes);
    request.region = command.crop.value_or(Region{0, 0, request.width, request.height});
    if (request.region.x1 > request.width || request.region.y1 > request.height)
        throw Error(ErrorKind::Argument, "--crop: reaches beyond the picture of " +
                                             std::to_string(request.width) + "x" +
                                             std::to_string(request.height) + " pixels");
    request.data = needsData(command);
    request.cost = std::find(command.aovs.begin(), command.aovs.end(), Aov::Cost) != command.aovs.end();
    request.ledger = loaded.packed.features.transmission || command.json;
    request.cancelled = interrupted;
    return request;
}

}  // namespace glint::app
