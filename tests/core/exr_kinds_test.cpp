// EXR files as other programs write them, made by OpenEXR: tiles, compressions, sample types, windows, parts.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfTiledOutputFile.h>

#include <bit>
#include <cmath>

#include "core/file_io.h"
#include "core/image_io.h"
#include "support/support.h"

namespace glint::exr_kinds_test {
using test::errorOf;

class ExrKinds : public test::FolderTest {
  protected:
    // The image that a reader finds in the file of one part.
    Image written(const Imf::Header& header, const Imf::FrameBuffer& buffer, int rows) {
        {
            Imf::OutputFile out(file("a.exr").c_str(), header);
            out.setFrameBuffer(buffer);
            out.writePixels(rows);
        }
        return readImage(file("a.exr"));
    }
};

constexpr int kWidth = 70, kHeight = 45;
constexpr const char* kNames[] = {"R", "G", "B"};

// Multiples of 1/64 below 8: halves hold them.
Image wave() {
    Image image(kWidth, kHeight, 3);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            for (int c = 0; c < 3; ++c) image.at(x, y, c) = static_cast<float>(x + 3 * y + 100 * c) / 64;
    return image;
}

Imf::FrameBuffer bufferOf(Image& image) {
    const size_t pixel = sizeof(float) * static_cast<size_t>(image.channels);
    Imf::FrameBuffer buffer;
    for (int c = 0; c < 3; ++c)
        buffer.insert(kNames[c], Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(image.pixels.data() + c),
                                            pixel, pixel * static_cast<size_t>(image.width)));
    return buffer;
}

Imf::Header headerOf(Imf::Compression compression) {
    Imf::Header header(kWidth, kHeight);
    header.compression() = compression;
    for (const char* name : kNames) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    return header;
}

TEST_F(ExrKinds, EveryCompression) {
    Image image = wave();
    for (int kind = 0; kind < Imf::NUM_COMPRESSION_METHODS; ++kind) {
        SCOPED_TRACE(kind);
        const auto compression = static_cast<Imf::Compression>(kind);
        const Image back = written(headerOf(compression), bufferOf(image), kHeight);
        // PXR24 keeps 24 bits of floats; B44 leaves floats as they are; DWA is lossy by its level.
        const bool dwa = compression == Imf::DWAA_COMPRESSION || compression == Imf::DWAB_COMPRESSION;
        const float bound = compression == Imf::PXR24_COMPRESSION ? 1e-4f : dwa ? 0.1f : 0.0f;
        ASSERT_EQ(back.pixels.size(), image.pixels.size());
        for (size_t i = 0; i < image.pixels.size(); ++i)
            ASSERT_LE(std::abs(back.pixels[i] - image.pixels[i]), bound) << i;
    }
}

TEST_F(ExrKinds, TilesAndTheirLevels) {
    Image image = wave();
    for (const auto mode : {Imf::ONE_LEVEL, Imf::MIPMAP_LEVELS}) {
        {
            Imf::Header header = headerOf(Imf::ZIP_COMPRESSION);
            header.setTileDescription(Imf::TileDescription(32, 16, mode));
            Imf::TiledOutputFile out(file("a.exr").c_str(), header);
            out.setFrameBuffer(bufferOf(image));
            for (int level = 0; level < out.numLevels(); ++level)
                out.writeTiles(0, out.numXTiles(level) - 1, 0, out.numYTiles(level) - 1, level);
        }
        EXPECT_EQ(readImage(file("a.exr")).pixels, image.pixels);
    }
}

TEST_F(ExrKinds, HalvesAndWholeNumbers) {
    Image image = wave();
    Imf::Header header(kWidth, kHeight);
    header.lineOrder() = Imf::DECREASING_Y;
    for (const char* name : kNames) header.channels().insert(name, Imf::Channel(Imf::HALF));
    std::vector<half> halves(image.pixels.begin(), image.pixels.end());
    Imf::FrameBuffer buffer;
    for (size_t c = 0; c < 3; ++c)
        buffer.insert(kNames[c],
                      Imf::Slice(Imf::HALF, reinterpret_cast<char*>(halves.data() + c), 6, 6 * kWidth));
    EXPECT_EQ(written(header, buffer, kHeight).pixels, image.pixels);

    Imf::Header whole(2, 1);
    whole.channels().insert("Y", Imf::Channel(Imf::UINT));
    unsigned numbers[] = {7, 4000000000u};
    Imf::FrameBuffer ids;
    ids.insert("Y", Imf::Slice(Imf::UINT, reinterpret_cast<char*>(numbers), 4, 8));
    EXPECT_EQ(written(whole, ids, 1).pixels, (std::vector<float>{7.0f, 4e9f}));
}

TEST_F(ExrKinds, TheDataWindowCounts) {
    Image image = wave();
    Imf::Header header = headerOf(Imf::ZIP_COMPRESSION);
    header.displayWindow() = {{0, 0}, {999, 999}};
    header.dataWindow() = {{-20, 300}, {-20 + kWidth - 1, 300 + kHeight - 1}};
    const auto pixel = static_cast<std::ptrdiff_t>(3 * sizeof(float));
    Imf::FrameBuffer buffer;
    for (int c = 0; c < 3; ++c)
        buffer.insert(kNames[c],
                      Imf::Slice::Make(Imf::FLOAT, image.pixels.data() + c, header.dataWindow(),
                                       static_cast<size_t>(pixel), static_cast<size_t>(pixel * kWidth)));
    const Image back = written(header, buffer, kHeight);
    EXPECT_EQ(back.width, kWidth);
    EXPECT_EQ(back.pixels, image.pixels);
}

TEST_F(ExrKinds, TheFirstOfSeveralParts) {
    Image image = wave(), other(kWidth, kHeight, 3, 9.0f);
    std::vector<Imf::Header> headers(2, headerOf(Imf::ZIP_COMPRESSION));
    headers[0].setName("first");
    headers[1].setName("second");
    for (Imf::Header& header : headers) header.setType(Imf::SCANLINEIMAGE);
    {
        Imf::MultiPartOutputFile out(file("a.exr").c_str(), headers.data(), 2);
        for (int i = 0; i < 2; ++i) {
            Imf::OutputPart part(out, i);
            part.setFrameBuffer(bufferOf(i == 0 ? image : other));
            part.writePixels(kHeight);
        }
    }
    EXPECT_EQ(readImage(file("a.exr")).pixels, image.pixels);
}

TEST_F(ExrKinds, LuminanceWithAlpha) {
    float samples[] = {0.25f, 0.5f, 0.75f, 1.0f};
    Imf::Header header(2, 1);
    Imf::FrameBuffer buffer;
    for (const char* name : {"Y", "A"}) {
        header.channels().insert(name, Imf::Channel(Imf::FLOAT));
        buffer.insert(
            name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(samples + (name[0] == 'A' ? 2 : 0)), 4, 8));
    }
    EXPECT_EQ(written(header, buffer, 1).pixels,
              (std::vector<float>{0.25f, 0.25f, 0.25f, 0.75f, 0.5f, 0.5f, 0.5f, 1.0f}));
}

TEST_F(ExrKinds, ColoursOfTheOnlyLayer) {
    float samples[] = {1, 2, 3, 4};
    for (const std::string channels : {"RGB", "RGBA", "rgba"}) {
        Imf::Header header(1, 1);
        Imf::FrameBuffer buffer;
        for (size_t i = 0; i < channels.size(); ++i) {
            header.channels().insert(std::string("beauty.") + channels[i], Imf::Channel(Imf::FLOAT));
            buffer.insert(std::string("beauty.") + channels[i],
                          Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(samples + i), 4, 4));
        }
        EXPECT_EQ(written(header, buffer, 1).pixels, std::vector<float>(samples, samples + channels.size()));
    }
}

TEST_F(ExrKinds, SubsampledChannelsAreRefused) {
    float samples[4] = {};
    Imf::Header header(2, 2);
    header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
    header.channels().insert("RY", Imf::Channel(Imf::FLOAT, 2, 2));
    Imf::FrameBuffer buffer;
    buffer.insert("Y", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(samples), 4, 8));
    buffer.insert("RY", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(samples), 4, 4, 2, 2));
    EXPECT_EQ(errorOf(ErrorKind::Failed, [&] { written(header, buffer, 2); }),
              file("a.exr").string() + ": EXR files with subsampled channels are not supported");
}

class ExrFloats : public ExrKinds {
  protected:
    // Floats of all kinds, quiet and signalling NaN among them.
    static Image anyBits() {
        Image image = wave();
        for (size_t i = 0; i < image.pixels.size(); i += 7)
            image.pixels[i] = std::bit_cast<float>(static_cast<uint32_t>(i * 2654435761u));
        image.pixels[1] = std::bit_cast<float>(0x7f800001u);
        image.pixels[2] = std::bit_cast<float>(0xffc12345u);
        return image;
    }
    Image writtenAmongOthers(Imf::Header header, Image& image) {
        // One that is not requested, before and after the others.
        std::vector<float> other(image.pixels.size(), 9.0f);
        Imf::FrameBuffer buffer = bufferOf(image);
        for (const char* name : {"A.id", "Z"}) {
            header.channels().insert(name, Imf::Channel(Imf::FLOAT));
            buffer.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(other.data()), 4, 4 * kWidth));
        }
        return written(header, buffer, kHeight);
    }
};

TEST_F(ExrFloats, KeepTheirBits) {
    Image image = anyBits();
    for (const auto kind :
         {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION, Imf::ZIP_COMPRESSION}) {
        for (const auto order : {Imf::INCREASING_Y, Imf::DECREASING_Y}) {
            SCOPED_TRACE(std::to_string(kind) + ", " + std::to_string(order));
            Imf::Header header = headerOf(kind);
            header.lineOrder() = order;
            EXPECT_TRUE(test::sameBytes(writtenAmongOthers(header, image).pixels, image.pixels));
        }
    }
}

}  // namespace glint::exr_kinds_test
