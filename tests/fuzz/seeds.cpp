// Writes seeds that need glint's own encoders: fuzz_seeds FOLDER.

#include "core/file_io.h"
#include "core/image_io.h"
#include "farm/unit_file.h"

namespace {

using namespace glint;

Image gradient(int width, int height, int channels) {
    Image image(width, height, channels);
    for (size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = static_cast<float>(i % 17) / 16;
    return image;
}

void writeParts(const std::filesystem::path& folder) {
    const Region all = {0, 0, 8, 6};
    for (const bool layers : {false, true}) {
        farm::UnitHeader header;
        header.identity.facts = {{"scene", "a.json"}, {"size", "8x6"}};
        header.region = all;
        header.aovs = {Aov::Radiance};
        if (layers) header.aovs.insert(header.aovs.end(), {Aov::Alpha, Aov::Depth, Aov::Normal, Aov::Uv});
        farm::UnitResult result;
        result.producer = {"llvmpipe", "Mesa", true};
        farm::Block block{all, gradient(all.width(), all.height(), 4), {}};
        for (const auto& [name, channels] : farm::layerShapes(header.aovs))
            block.layers.push_back({name, gradient(all.width(), all.height(), channels)});
        result.blocks.push_back(std::move(block));
        writeFiles({{folder / (layers ? "layers.part" : "color.part"), farm::encodePart(header, result)}});
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    const std::filesystem::path folder = argv[1];
    for (const int channels : {1, 3, 4})
        for (const char* kind : {".png", ".exr", ".pfm", ".hdr"})
            writeImage(folder / ("picture" + std::to_string(channels) + kind), gradient(12, 9, channels));
    writeLayers(folder / "layers.exr", {{"color", gradient(12, 9, 3)},
                                        {"alpha", gradient(12, 9, 1)},
                                        {"depth", gradient(12, 9, 1)},
                                        {"normal", gradient(12, 9, 3)}});
    writeParts(folder);
    return 0;
}
