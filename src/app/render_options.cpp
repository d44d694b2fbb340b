#include "app/render_options.h"

#include <algorithm>

#include "app/common.h"
#include "core/error.h"
#include "core/interrupt.h"

namespace glint::app {

bool needsData(const RenderCommand& command) {
    return std::any_of(command.aovs.begin(), command.aovs.end(),
                       [](Aov aov) { return glint::needsData(aov); });
}

std::filesystem::path outputOf(const RenderCommand& command) {
    if (!command.output.empty()) return command.output;
    return command.scene.scene.filename().replace_extension(".png");
}

void checkNotRead(const RenderCommand& command, const Scene& scene) {
    const std::filesystem::path output = outputOf(command);
    for (const SourceFile& file : scene.sources) {
        std::error_code ignored;  // where there is no such file there is nothing to lose
        if (std::filesystem::equivalent(command.scene.scene.parent_path() / file.name, output, ignored))
            throw Error(ErrorKind::Argument,
                        output.string() + ": is read by the scene; name another file with --output");
    }
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
