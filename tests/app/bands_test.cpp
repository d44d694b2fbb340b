// Pictures in bands: the pixels, and what is said of them, are those of a picture that was drawn at once.
#include <limits>

#include "core/content_hash.h"
#include "core/image_io.h"
#include "support.h"

namespace glint::app::test::bands_test {
class Bands : public SmallSceneTest {
  protected:
    static nlohmann::json render(const std::string& output, const Words& more) {
        return jsonOf("render a.json --backend cpu --stats json -o" + Words(output) + more);
    }

    static void expectSamePixels(const std::string& a, const std::string& b) {
        const Image first = readImage(a), second = readImage(b);
        EXPECT_EQ(std::pair(first.width, first.height), std::pair(second.width, second.height));
        EXPECT_EQ(first.channels, second.channels);
        EXPECT_EQ(first.pixels, second.pixels);
    }

    // In bands of every height, the last one shorter or not.
    static void compare(const std::string& kind, const Words& options, bool sameBytes) {
        const auto whole = render("whole" + kind, options);
        for (const int rows : {1, 8, 16, 40, 1000}) {
            const auto bands = render("bands" + kind, options + ("--band-rows " + std::to_string(rows)));
            EXPECT_EQ(bands.at("hash"), whole.at("hash")) << kind << rows;
            EXPECT_EQ(bands.at("samplesTaken"), whole.at("samplesTaken"));
            EXPECT_EQ(bands.at("lost"), whole.at("lost"));
            EXPECT_EQ(bands.at("complete"), true);
            EXPECT_EQ(bands.at("bands"), rows == 1 ? 6 : (48 + rows - 1) / rows) << rows;
            ASSERT_EQ(bands.at("files").size(), whole.at("files").size());
            for (size_t i = 0; i < whole.at("files").size(); ++i) {
                const std::string a = whole.at("files")[i], b = bands.at("files")[i];
                if (sameBytes)
                    EXPECT_EQ(readBytes(a), readBytes(b)) << b;
                else
                    expectSamePixels(a, b);
            }
        }
    }
};

const std::string kLayers = "color,alpha,depth,position,normal,uv,object,primitive,material,bounces,samples";

TEST_F(Bands, EveryFormatHasTheSamePixels) {
    compare(".png", {}, false);
    compare(".png", "--aov color,alpha", false);
    compare(".png", "--aov alpha", false);
    compare(".exr", {"--aov", kLayers}, true);
    compare(".pfm", {"--aov", kLayers}, true);
}

TEST_F(Bands, SamplesAndCropsToo) {
    compare(".exr", "--spp 4 --sampler jittered --adaptive 12,0.05", true);
    const auto whole = render("whole.pfm", "--crop 5,3,50,30");
    const auto bands = render("bands.pfm", "--crop 5,3,50,30 --band-rows 8");
    EXPECT_EQ(readBytes("whole.pfm"), readBytes("bands.pfm"));
    EXPECT_EQ(bands.at("bands"), 4);
}

// Of a picture that shows nothing the reason is told once; of one whose upper bands are empty, none.
TEST_F(Bands, AdviceIsOfTheWholePicture) {
    writeText("empty.json",
              sceneText(32, 32, R"("objects": [{"type": "sphere", "center": [0, 0, 50], "radius": 1}])"));
    const Ran whole = runGlint("render empty.json --backend cpu");
    const Ran bands = runGlint("render empty.json --backend cpu --band-rows 8");
    EXPECT_HAS(whole.err, "shows only background");
    EXPECT_EQ(bands.err, whole.err);
    writeText(
        "low.json",
        sceneText(32, 32,
                  R"("ambient": 1, "objects": [{"type": "sphere", "center": [0, -4, 0], "radius": 1}])"));
    EXPECT_EQ(runGlint("render low.json --backend cpu --band-rows 8").err, "");
}

TEST_F(Bands, WhereThereCanBeNone) {
    const Words bands = "render a.json --backend cpu --band-rows 8 -o";
    const std::string where = ": bands go into .png (layers color and alpha alone), .exr and .pfm";
    expectError(bands + "a.hdr", 2, "a.hdr" + where);
    expectError(bands + "a.png --aov color,depth", 2, "a.png" + where);
    EXPECT_EQ(names(), std::set<std::string>{"a.json"});
}

// Equal rows at the end: pixels, and in EXR and PFM bytes, as of rows that came together.
TEST_F(Bands, RowsAlikeAtTheEnd) {
    const int width = 120;
    const auto rowsOf = [&](int rows, bool alike, float depth) {
        std::vector<Layer> layers = {{"color", Image(width, rows, 4)}, {"depth", Image(width, rows, 1)}};
        for (size_t i = 0; i < layers[0].image.pixels.size(); ++i)
            layers[0].image.pixels[i] =
                alike ? static_cast<float>(i % (4 * width) % 7) / 8 : static_cast<float>(i * i % 1009) / 1008;
        layers[1].image.pixels.assign(layers[1].image.pixels.size(), depth);
        return layers;
    };
    const auto write = [&](const std::string& name, int above, int alike, bool fill, float depth) {
        const auto taken = [&](std::vector<Layer> layers) {
            if (name.ends_with(".png")) layers.pop_back();
            return layers;
        };
        PictureRows file(name, width, above + alike, taken(rowsOf(0, false, 0)));
        if (above > 0) file.add(taken(rowsOf(above, false, 1)));
        if (fill)
            file.fill(taken(rowsOf(1, true, depth)));
        else if (alike > 0)
            file.add(taken(rowsOf(alike, true, depth)));
        return file.finish();
    };
    const auto compareKind = [&](const std::string& kind, int above, int alike, float depth) {
        SCOPED_TRACE(kind + " " + std::to_string(above) + " " + std::to_string(alike));
        const auto one = write("one" + kind, above, alike, false, depth);
        const auto all = write("all" + kind, above, alike, true, depth);
        ASSERT_EQ(one.size(), all.size());
        for (size_t i = 0; i < one.size(); ++i) {
            if (kind == ".png")
                expectSamePixels(one[i], all[i]);
            else
                EXPECT_EQ(readBytes(one[i]), readBytes(all[i]));
        }
    };
    for (const auto& [above, alike] : {std::pair(3, 60000), {0, 60000}, {5, 2}, {5, 1}, {7, 0}})
        compareKind(".png", above, alike, 0);
    for (const auto& [above, alike] : {std::pair(3, 2500), {0, 2500}, {5, 2}, {5, 1}, {7, 0}})
        for (const float depth : {0.0f, std::numeric_limits<float>::infinity()}) {
            compareKind(".exr", above, alike, depth);
            compareKind(".pfm", above, alike, depth);
        }
}

TEST_F(Bands, HashOfRowsAlike) {
    Image row(5, 1, 4), rows(5, 9, 4);
    for (size_t i = 0; i < row.pixels.size(); ++i) row.pixels[i] = static_cast<float>(i);
    for (size_t i = 0; i < rows.pixels.size(); ++i) rows.pixels[i] = row.pixels[i % row.pixels.size()];
    PictureHash one, all;
    one.add(rows);
    all.add(row);
    all.fill(8, row);
    EXPECT_EQ(one.text(), all.text());
}

// A file appears whole or not at all.
TEST_F(Bands, WhatIsNotFinishedLeavesNoFile) {
    {
        PictureRows rows("a.png", 8, 8, {{"color", Image(0, 0, 3)}});
        rows.add({{"color", Image(8, 4, 3)}});
    }
    EXPECT_EQ(names(), std::set<std::string>{"a.json"});
    std::filesystem::create_symlink("/dev/null", "null.pfm");
    EXPECT_EQ(errorOf(ErrorKind::Failed,
                      [] {
                          PictureRows("null.pfm", 8, 8, {{"color", Image(0, 0, 3)}});
                      }),
              "null.pfm: is not a regular file, as images in bands need");
}

}  // namespace glint::app::test::bands_test
