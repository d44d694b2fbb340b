#include "farm/merge.h"

#include <algorithm>
#include <cstring>
#include <optional>
#include <random>

#include "core/file_io.h"
#include "farm/cut.h"
#include "support.h"

namespace glint::farm::test::merge_test {
using glint::test::errorOf;

const std::vector<Aov> kAll = {Aov::Depth,      Aov::Radiance, Aov::Alpha,    Aov::Position,
                               Aov::Normal,     Aov::Uv,       Aov::ObjectId, Aov::PrimitiveId,
                               Aov::MaterialId, Aov::Bounces,  Aov::Cost,     Aov::Samples};

bool sameBits(const Image& a, const Image& b) {
    return a.width == b.width && a.height == b.height && a.channels == b.channels &&
           std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(float)) == 0;
}

// Any number of parts, cut by either map, put together in any order.
TEST(Merge, HasTheBitsOfThePictureInEveryLayer) {
    Request request = requestFor(75, 43);
    request.region = {9, 2, 70, 41};
    request.data = request.cost = true;
    const Picture whole = draw(request);
    const std::vector<Layer> expected = makeLayers(whole, kAll);
    std::mt19937 random(7);
    for (const int count : {1, 2, 5, 40, 300}) {
        for (const bool even : {false, true}) {
            std::vector<UnitResult> parts = partsOf(request, count, kAll, even);
            std::shuffle(parts.begin(), parts.end(), random);
            Assembly assembly(whole.region, kAll);
            for (const UnitResult& part : parts) {
                EXPECT_FALSE(assembly.complete() && !part.blocks.empty());
                assembly.add(part);
            }
            EXPECT_TRUE(assembly.complete());
            const Rows rows = assembly.take();
            ASSERT_EQ(rows.layers.size(), expected.size());
            for (size_t i = 0; i < rows.layers.size(); ++i) {
                EXPECT_EQ(rows.layers[i].name, expected[i].name);
                EXPECT_TRUE(sameBits(rows.layers[i].image, expected[i].image))
                    << rows.layers[i].name << ' ' << count;
            }
            EXPECT_TRUE(sameBits(rows.picture.color, whole.color));
            EXPECT_EQ(assembly.flaws().losses.depth.count, whole.losses.depth.count);
        }
    }
}

// Rows are there as soon as nothing above them is missing, once, and all of them in the end.
TEST(Merge, RowsCanBeTakenAsTheyBecomeComplete) {
    Request request = requestFor(75, 43);
    request.region = {9, 2, 70, 41};
    const Picture whole = draw(request);
    std::mt19937 random(11);
    for (const int count : {1, 5, 40, 300}) {
        std::vector<UnitResult> parts = partsOf(request, count, {Aov::Radiance});
        if (count != 40) std::shuffle(parts.begin(), parts.end(), random);
        Assembly assembly(whole.region, {Aov::Radiance});
        Image all(whole.region.width(), 0, 4);
        int y = whole.region.y0, pieces = 0;
        for (const UnitResult& part : parts) {
            assembly.add(part);
            const Rows rows = assembly.take();
            EXPECT_EQ(rows.picture.region.y0, y);
            y = rows.picture.region.y1;
            if (rows.picture.region.height() > 0) ++pieces;
            const std::vector<float>& pixels = rows.picture.color.pixels;
            all.pixels.insert(all.pixels.end(), pixels.begin(), pixels.end());
        }
        all.height = y - whole.region.y0;
        EXPECT_TRUE(sameBits(all, whole.color)) << count;
        EXPECT_GE(pieces, count == 40 ? 5 : 1);
        EXPECT_EQ(assembly.take().picture.region.height(), 0);
        const std::string error = errorOf(ErrorKind::Failed, [&] {
            for (const UnitResult& part : parts) assembly.add(part);
        });
        EXPECT_ENDS(error, " has pixels that another part has too");
    }
}

class MergeFiles : public glint::test::WorkingFolderTest {
  protected:
    void SetUp() override {
        results_ = partsOf(request_, 4, {Aov::Radiance});
        for (int i = 0; i < 4; ++i) write(i);
    }
    void write(int i) { writeFiles({{paths_[i], encodePart(header_, results_[static_cast<size_t>(i)])}}); }
    static std::string errorIn(const std::vector<std::filesystem::path>& paths) {
        return errorOf(ErrorKind::Failed, [&] { merge(paths); });
    }
    static Assembly merge(const std::vector<std::filesystem::path>& paths) {
        std::optional<Assembly> assembly;
        mergeParts(
            paths, [&](const UnitHeader& header, uint64_t) { assembly.emplace(header.region, header.aovs); },
            [&](const UnitResult& result) { assembly->add(result); });
        return std::move(*assembly);
    }

    const Request request_ = requestFor(64, 48);
    const UnitHeader header_ = headerOf(request_, 4, {Aov::Radiance});
    std::vector<UnitResult> results_;
    const std::vector<std::filesystem::path> paths_ = {"1.part", "2.part", "3.part", "4.part"};
};

TEST_F(MergeFiles, WrongPartsAreNamed) {
    EXPECT_EQ(errorIn({paths_[0], paths_[2]}), "parts 2, 4 of 4 are missing");
    EXPECT_EQ(errorIn({paths_[0], paths_[2], paths_[3]}), "part 2 of 4 is missing");
    EXPECT_EQ(errorIn({paths_[0], paths_[1], paths_[0]}),
              "1.part: holds part 1 of 4, which it holds already");
    std::filesystem::copy_file("2.part", "again.part");
    EXPECT_EQ(errorIn({paths_[0], paths_[1], "again.part"}),
              "again.part: holds part 2 of 4, which 2.part holds already");
    EXPECT_EQ(errorIn({"no.part"}), "no.part: no such file");
}

TEST_F(MergeFiles, PartsThatOverlapAreRefused) {
    results_[1].blocks = results_[0].blocks;
    write(1);
    EXPECT_EQ(errorIn(paths_), "part 2 has pixels that another part has too");
}

TEST(PartNames, AreShort) {
    EXPECT_EQ(namesOfParts({3}, 9), "part 3 of 9");
    EXPECT_EQ(namesOfParts({3, 4}, 9), "parts 3, 4 of 9");
    EXPECT_EQ(namesOfParts({1, 3, 4, 5, 6, 9}, 9), "parts 1, 3 to 6, 9 of 9");
}

}  // namespace glint::farm::test::merge_test
