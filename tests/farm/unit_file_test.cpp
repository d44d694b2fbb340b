// Files of units, the checkpoints made of them and the identities that they hold.
#include <cmath>
#include <functional>
#include <limits>

#include "core/file_io.h"
#include "farm/checkpoint.h"
#include "farm/merge.h"
#include "farm/unit.h"
#include "farm/unit_file.h"
#include "support.h"

namespace glint::farm::test::unit_file_test {

using glint::test::errorOf;
using glint::test::writeBytes;

UnitResult result() {
    UnitResult made;
    made.part = 2;
    made.producer = {"a device", "a driver", true};
    made.notFinite = 5;
    made.firstNotFinite = {4, 1};
    made.losses.depth.add(7, std::numeric_limits<double>::infinity());
    made.losses.crowdedMedia = 2;
    Block block;
    block.region = {2, 1, 5, 3};
    block.color = Image(3, 2, 4, 0.25f);
    block.layers.push_back({"depth", Image(3, 2, 1, std::numeric_limits<float>::quiet_NaN())});
    made.blocks.push_back(block);
    return made;
}

const UnitHeader kHeader = {
    {{{"size", "8x4"}, {"", "empty name"}}}, {0, 0, 8, 4}, {Aov::Depth, Aov::Radiance}, 2};

class UnitFiles : public glint::test::WorkingFolderTest {
  protected:
    // The error for a part of these bytes.
    static std::string errorOfPart(const std::vector<uint8_t>& bytes) {
        writeBytes("a.part", bytes);
        return errorOf(ErrorKind::Failed, [] { readPart("a.part"); });
    }
};

TEST_F(UnitFiles, KeepEveryBit) {
    writeBytes("a.part", encodePart(kHeader, result()));
    const PartOutline outline = outlineOf("a.part");
    EXPECT_EQ(outline.header.identity, kHeader.identity);
    EXPECT_EQ(outline.header.aovs, kHeader.aovs);
    EXPECT_EQ(outline.header.region.x1, 8);
    EXPECT_EQ(outline.part, 2);
    EXPECT_EQ(outline.bytes, std::filesystem::file_size("a.part"));
    const UnitResult read = readPart("a.part");
    EXPECT_EQ(read.part, 2);
    EXPECT_EQ(read.producer, result().producer);
    EXPECT_EQ(read.notFinite, 5u);
    EXPECT_EQ(read.firstNotFinite, glm::ivec2(4, 1));
    EXPECT_EQ(read.losses.depth.count, 7u);
    EXPECT_TRUE(std::isinf(read.losses.depth.greatest));
    EXPECT_EQ(read.losses.crowdedMedia, 2u);
    ASSERT_EQ(read.blocks.size(), 1u);
    EXPECT_EQ(read.blocks[0].color.pixels, result().blocks[0].color.pixels);
    EXPECT_TRUE(std::isnan(read.blocks[0].layers[0].image.pixels[5]));
}

// Every byte that is changed and every length that a file may be cut to is found out.
TEST_F(UnitFiles, NoDamageGoesUnnoticed) {
    const std::vector<uint8_t> whole = encodePart(kHeader, result());
    for (size_t i = 0; i < whole.size(); ++i) {
        std::vector<uint8_t> bytes = whole;
        bytes[i] ^= static_cast<uint8_t>(1u << i % 8);
        const std::string error = errorOfPart(bytes);
        EXPECT_STARTS(error, "a.part: damaged: ") << i;
        bytes.assign(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(i));
        EXPECT_EQ(errorOfPart(bytes), "a.part: damaged: it ends early") << i;
    }
    std::vector<uint8_t> longer = whole;
    longer.push_back(0);
    EXPECT_EQ(errorOfPart(longer), "a.part: damaged: something follows its end");
    const std::string picture = "P6 640 480 255 and so on, a picture";
    EXPECT_EQ(errorOfPart({picture.begin(), picture.end()}),
              "a.part: damaged: glint render --part or --checkpoint did not write it");
}

// Numbers that are right in form, and would make merge count to two thousand millions.
TEST_F(UnitFiles, NobodyHasSoManyParts) {
    for (const int parts : {0, -1, kMostParts + 1, std::numeric_limits<int>::max()}) {
        UnitHeader header = kHeader;
        header.parts = parts;
        EXPECT_EQ(errorOfPart(encodePart(header, result())),
                  "a.part: damaged: its header names an image of " + std::to_string(parts) + " parts");
    }
}

// Records with the right hash whose images do not fit their regions.
TEST_F(UnitFiles, ImagesFitTheirRegions) {
    const auto errorWith = [](const std::function<void(Block&)>& change) {
        UnitResult wrong = result();
        change(wrong.blocks[0]);
        return errorOfPart(encodePart(kHeader, wrong));
    };
    const std::string size = "a.part: damaged: an image has another size than its region";
    EXPECT_EQ(errorWith([](Block& b) { b.color.pixels.pop_back(); }), size);
    EXPECT_EQ(errorWith([](Block& b) { b.color.width = 2; }), size);
    EXPECT_EQ(errorWith([](Block& b) { b.layers[0].image.channels = 3; }), size);
    EXPECT_EQ(errorWith([](Block& b) { b.layers.clear(); }),
              "a.part: damaged: a unit has other layers than the image");
    EXPECT_EQ(errorWith([](Block& b) { b.region.x1 = 9; }),
              "a.part: damaged: a region lies outside the image");
}

// Units that were appended until the process ended, whenever that was.
TEST_F(UnitFiles, UnfinishedFilesHoldTheirWholeUnits) {
    const std::vector<uint8_t> head = encodeHeader(kHeader), unit = encodeUnit(result());
    std::vector<uint8_t> bytes = head;
    for (int i = 0; i < 2; ++i) bytes.insert(bytes.end(), unit.begin(), unit.end());
    for (size_t size = head.size(); size <= bytes.size(); ++size) {
        writeBytes("a.part", {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)});
        const UnitFile file = readUnits("a.part");
        EXPECT_EQ(file.results.size(), (size - head.size()) / unit.size());
        EXPECT_EQ(file.wholeBytes, head.size() + file.results.size() * unit.size());
    }
}

using glint::test::readBytes;

const std::vector<Aov> kAovs = {Aov::Radiance};

void nothingFound(const UnitResult& result) {
    ADD_FAILURE() << result.part;
}

class Checkpoints : public glint::test::WorkingFolderTest {
  protected:
    const Request request_ = requestFor(64, 48);
    const UnitHeader header_ = headerOf(request_, 4, kAovs);
    const std::vector<UnitResult> results_ = partsOf(request_, 4, kAovs);
    std::string errorOfOpening(const UnitHeader& header) const {
        return errorOf(ErrorKind::Failed, [&] { Checkpoint checkpoint("a.check", header, nothingFound); });
    }
};

// A checkpoint that is cut off anywhere, as by a killed process, holds its whole units and continues. The
// image has the same bits as without interruption.
TEST_F(Checkpoints, GoOnFromWhereverTheyWereCutOff) {
    {
        Checkpoint checkpoint("a.check", header_, nothingFound);
        for (int i = 0; i < 3; ++i) checkpoint.append(results_[i]);
    }
    const std::vector<uint8_t> whole = readBytes("a.check");
    const size_t head = encodeHeader(header_).size();
    for (size_t size = head; size <= whole.size(); size += 1 + (whole.size() - head) / 23) {
        writeBytes("a.check", {whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)});
        Assembly assembly(header_.region, kAovs);
        size_t found = 0;
        Checkpoint checkpoint("a.check", header_, [&](const UnitResult& result) {
            assembly.add(result);
            ++found;
        });
        for (size_t i = found; i < results_.size(); ++i) {
            checkpoint.append(results_[i]);
            assembly.add(results_[i]);
        }
        EXPECT_TRUE(assembly.complete());
        EXPECT_EQ(assembly.take().picture.color.pixels, draw(request_).color.pixels);
        EXPECT_EQ(readUnits("a.check").results.size(), 4u) << size;
    }
}

TEST_F(Checkpoints, OfAnotherPictureAreRefused) {
    { Checkpoint checkpoint("a.check", header_, nothingFound); }
    UnitHeader other = header_;
    other.identity.facts[0].second = "b.json";
    EXPECT_EQ(
        errorOfOpening(other),
        "a.check: is a checkpoint of another render: scene is uneven.json there and b.json here; remove it, "
        "or give another name");
    glint::test::writeText("a.check", "something else");
    EXPECT_EQ(errorOfOpening(header_),
              "a.check: damaged: glint render --part or --checkpoint did not write it");
}

TEST_F(Checkpoints, HaveOneWriter) {
    Checkpoint checkpoint("a.check", header_, nothingFound);
    EXPECT_EQ(errorOfOpening(header_), "a.check: another glint writes this checkpoint");
    checkpoint.remove();
    EXPECT_TRUE(names().empty());
}

const Identity kHere = {{{"glint", "1"}, {"file a.obj", "12"}, {"size", "4x3"}}};

TEST(Identity, NamesTheFirstFactThatDiffers) {
    Identity there = kHere;
    EXPECT_EQ(difference(there, kHere), "");
    there.facts[0].second = "2";
    EXPECT_EQ(difference(there, kHere), "glint is 2 there and 1 here");
    there = kHere;
    there.facts[2].second = "8x6";
    EXPECT_EQ(difference(there, kHere), "size is 8x6 there and 4x3 here");
    there.facts[1].second = "13";
    EXPECT_EQ(difference(there, kHere), "file a.obj has other contents there");
    there = kHere;
    there.facts.erase(there.facts.begin() + 1);
    EXPECT_EQ(difference(there, kHere), "file a.obj is used here alone");
    EXPECT_EQ(difference(kHere, there), "file a.obj is used there alone");
    there = kHere;
    there.facts.emplace_back("cut", "1");
    EXPECT_EQ(difference(there, kHere), "cut is used there alone");
    std::swap(there.facts[0], there.facts[3]);
    there.facts.pop_back();
    EXPECT_NE(difference(there, kHere), "");
}

}  // namespace glint::farm::test::unit_file_test
