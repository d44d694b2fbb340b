#include "farm/checkpoint.h"

#include "core/file_io.h"
#include "farm/merge.h"
#include "support.h"

namespace glint::farm::test::checkpoint_test {
using glint::test::errorOf;
using glint::test::readBytes;
using glint::test::writeBytes;

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

// Cut off anywhere, as a process that is killed leaves it, it holds the units that were whole, goes on, and
// the picture has the bits of one that was never stopped.
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
        "a.check: is a checkpoint of another picture: scene is uneven.json there and b.json here; remove it, "
        "or give another name");
    glint::test::writeText("a.check", "something else");
    EXPECT_EQ(errorOfOpening(header_),
              "a.check: damaged: it is no file that glint render --part or --checkpoint wrote");
}

TEST_F(Checkpoints, HaveOneWriter) {
    Checkpoint checkpoint("a.check", header_, nothingFound);
    EXPECT_EQ(errorOfOpening(header_), "a.check: another glint writes this checkpoint");
    checkpoint.remove();
    EXPECT_TRUE(names().empty());
}

}  // namespace glint::farm::test::checkpoint_test
