// Several layers of one picture: channels of an EXR file, files of the other formats.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>

#include <bit>
#include <limits>
#include <map>

#include "core/image_io.h"
#include "png_file.h"
#include "support/support.h"

namespace glint::layers_test {
using test::errorOf;
using test::readPng;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

class Layers : public test::FolderTest {};

// A 2 x 1 picture with every number of channels a layer can have; sample c of pixel x is base + 10 c + x.
Layer layer(const std::string& name, int channels, float base) {
    Layer result{name, Image(2, 1, channels)};
    for (int x = 0; x < 2; ++x) {
        for (int c = 0; c < channels; ++c) {
            result.image.at(x, 0, c) = base + 10.0f * static_cast<float>(c) + static_cast<float>(x);
        }
    }
    return result;
}

struct ExrFile {
    std::vector<std::string> order;  // channels as they stand in the file
    std::map<std::string, std::vector<float>> planes;
    std::vector<Imf::PixelType> types;
};

ExrFile readExr(const std::filesystem::path& path) {
    ExrFile result;
    Imf::InputFile file(path.c_str());
    const auto& window = file.header().dataWindow();
    const auto width = static_cast<size_t>(window.max.x + 1), height = static_cast<size_t>(window.max.y + 1);
    Imf::FrameBuffer target;
    const Imf::ChannelList& channels = file.header().channels();
    for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
        result.order.emplace_back(channel.name());
        result.types.push_back(channel.channel().type);
        std::vector<float>& plane = result.planes[channel.name()];
        plane.resize(width * height);
        target.insert(channel.name(), Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(plane.data()),
                                                 sizeof(float), sizeof(float) * width));
    }
    file.setFrameBuffer(target);
    file.readPixels(window.min.y, window.max.y);
    return result;
}

TEST_F(Layers, ExrChannelNames) {
    Layer depth = layer("depth", 1, 5);
    depth.image.at(1, 0, 0) = kInfinity;
    const std::vector<Layer> layers = {layer("color", 3, 0), layer("alpha", 1, 100), depth,
                                       layer("normal", 3, 200), layer("uv", 2, 300)};
    EXPECT_EQ(writeLayers(file("a.exr"), layers), std::vector<std::filesystem::path>{file("a.exr")});
    const ExrFile exr = readExr(file("a.exr"));
    const std::vector<std::string> order = {"A",        "B",        "G",        "R",    "depth.Y",
                                            "normal.X", "normal.Y", "normal.Z", "uv.U", "uv.V"};
    EXPECT_EQ(exr.order, order);
    EXPECT_EQ(exr.types, std::vector<Imf::PixelType>(order.size(), Imf::FLOAT));
    const std::map<std::string, std::vector<float>> planes = {{"R", {0, 1}},
                                                              {"G", {10, 11}},
                                                              {"B", {20, 21}},
                                                              {"A", {100, 101}},
                                                              {"depth.Y", {5, kInfinity}},
                                                              {"normal.X", {200, 201}},
                                                              {"normal.Y", {210, 211}},
                                                              {"normal.Z", {220, 221}},
                                                              {"uv.U", {300, 301}},
                                                              {"uv.V", {310, 311}}};
    EXPECT_EQ(exr.planes, planes);
}

TEST_F(Layers, ExrReadsBackItsColor) {
    writeLayers(file("a.exr"), {layer("normal", 3, 200), layer("color", 3, 0), layer("alpha", 1, 100)});
    const Image image = readImage(file("a.exr"));
    EXPECT_EQ(image.channels, 4);
    EXPECT_EQ(image.pixels, (std::vector<float>{0, 10, 20, 100, 1, 11, 21, 101}));
}

TEST_F(Layers, AlphaLayerReplacesTheFourthChannel) {
    writeLayers(file("a.exr"), {layer("color", 4, 0), layer("alpha", 1, 100)});
    EXPECT_EQ(readImage(file("a.exr")).pixels, (std::vector<float>{0, 10, 20, 100, 1, 11, 21, 101}));
    Layer color{"color", Image(1, 1, 4, 1.0f)};
    writeLayers(file("a.png"), {color, {"alpha", Image(1, 1, 1, 0.5f)}});
    EXPECT_EQ(readPng(file("a.png")).samples, (std::vector<uint8_t>{255, 255, 255, 128}));
}

TEST_F(Layers, ExrWithOneLayerOfData) {
    writeLayers(file("a.exr"), {layer("normal", 3, 7)});
    EXPECT_EQ(readImage(file("a.exr")).pixels, (std::vector<float>{7, 17, 27, 8, 18, 28}));
    writeLayers(file("a.exr"), {layer("depth", 1, 7)});
    EXPECT_EQ(readImage(file("a.exr")).pixels, (std::vector<float>{7, 8}));
}

TEST_F(Layers, ExrWithoutColorCannotBeReadAsOnePicture) {
    const std::string path = file("a.exr").string();
    writeLayers(path, {layer("normal", 3, 7), layer("depth", 1, 7)});
    EXPECT_EQ(errorOf(ErrorKind::Failed, [&] { readImage(path); }),
              path +
                  ": the EXR file has neither R, G, B nor Y, and more than one layer (channels depth.Y, "
                  "normal.X, normal.Y, normal.Z)");
}

TEST_F(Layers, PfmGetsAFileForEachLayer) {
    const std::vector<Layer> layers = {layer("color", 3, 0), layer("alpha", 1, 100), layer("uv", 2, 300)};
    const std::vector<std::filesystem::path> expected = {file("a.pfm"), file("a.alpha.pfm"),
                                                         file("a.uv.pfm")};
    EXPECT_EQ(writeLayers(file("a.pfm"), layers), expected);
    EXPECT_EQ(names(), (std::set<std::string>{"a.pfm", "a.alpha.pfm", "a.uv.pfm"}));
    EXPECT_EQ(readImage(file("a.pfm")).pixels, layers[0].image.pixels);
    EXPECT_EQ(readImage(file("a.alpha.pfm")).pixels, (std::vector<float>{100, 101}));
    EXPECT_EQ(readImage(file("a.uv.pfm")).pixels, (std::vector<float>{300, 310, 0, 301, 311, 0}));
}

TEST_F(Layers, FileNamesKeepInnerDots) {
    EXPECT_EQ(writeLayers(file("frame.0001.pfm"), {layer("depth", 1, 1)}),
              std::vector<std::filesystem::path>{file("frame.0001.depth.pfm")});
}

TEST_F(Layers, PngPutsAlphaIntoThePicture) {
    const Layer color{"color", Image(2, 1, 3, 0.5f)};
    Layer alpha{"alpha", Image(2, 1, 1)};
    alpha.image.pixels = {0.25f, 1.0f};
    EXPECT_EQ(writeLayers(file("a.png"), {alpha, color}), std::vector<std::filesystem::path>{file("a.png")});
    const test::PngFile png = readPng(file("a.png"));
    EXPECT_EQ(png.colorType, 6);
    // 0.25 * 255 = 63.75, without the sRGB curve
    EXPECT_EQ(png.samples, (std::vector<uint8_t>{188, 188, 188, 64, 188, 188, 188, 255}));
}

TEST_F(Layers, PngScalesData) {
    Layer depth{"depth", Image(4, 1, 1)};
    depth.image.pixels = {10.0f, 20.0f, 50.0f, kInfinity};
    Layer uv{"uv", Image(2, 1, 2)};
    uv.image.pixels = {1.0f, 2.0f, 3.0f, 5.0f};
    writeLayers(file("a.png"), {depth});
    // (v - 10) / 40 * 255; infinity is no depth
    EXPECT_EQ(readPng(file("a.depth.png")).samples, (std::vector<uint8_t>{0, 64, 255, 0}));
    EXPECT_EQ(readPng(file("a.depth.png")).colorType, 0);
    writeLayers(file("a.png"), {uv});
    // (v - 1) / 4 * 255, then a third channel of 0
    EXPECT_EQ(readPng(file("a.uv.png")).samples, (std::vector<uint8_t>{0, 64, 0, 128, 255, 0}));
}

TEST_F(Layers, PngOfAlphaAloneIsNotScaled) {
    Layer alpha{"alpha", Image(2, 1, 1)};
    alpha.image.pixels = {0.25f, 0.5f};
    EXPECT_EQ(writeLayers(file("a.png"), {alpha}), std::vector<std::filesystem::path>{file("a.alpha.png")});
    EXPECT_EQ(readPng(file("a.alpha.png")).samples, (std::vector<uint8_t>{64, 128}));
}

TEST_F(Layers, HdrOfTwoChannelsIsPadded) {
    Layer uv{"uv", Image(1, 1, 2)};
    uv.image.pixels = {0.5f, 1.0f};
    writeLayers(file("a.hdr"), {uv});
    EXPECT_EQ(readImage(file("a.uv.hdr")).pixels, (std::vector<float>{0.5f, 1.0f, 0.0f}));
}

TEST_F(Layers, LayersThatDoNotFit) {
    const std::string path = file("a.exr").string();
    EXPECT_EQ(errorOf(ErrorKind::Failed, [&] { writeLayers(path, {}); }),
              path + ": there is no layer to write");
    EXPECT_EQ(errorOf(ErrorKind::Failed,
                      [&] {
                          writeLayers(path, {layer("color", 3, 0), {"depth", Image(3, 1, 1)}});
                      }),
              path + ": the layers \"color\" and \"depth\" differ in size");
    EXPECT_EQ(errorOf(ErrorKind::Failed, [&] { writeLayers(path, {layer("alpha", 3, 0)}); }),
              path + ": the layer \"alpha\" must have one channel");
    EXPECT_EQ(errorOf(ErrorKind::Failed, [&] { writeLayers(path, {layer("normal", 4, 0)}); }),
              path + ": a layer \"normal\" of 2x1 pixels with 4 channels cannot be written");
    EXPECT_TRUE(names().empty());
}

}  // namespace glint::layers_test
