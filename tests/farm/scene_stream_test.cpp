#include "farm/scene_stream.h"

#include <deque>
#include <filesystem>

#include "import/load.h"
#include "support/support.h"

namespace glint::farm::test::scene_stream_test {
using glint::test::errorOf;
using glint::test::writeText;

namespace fs = std::filesystem;

class SceneStream : public glint::test::WorkingFolderTest {
  protected:
    std::shared_ptr<RecordedFiles> recorded() {
        return std::make_shared<RecordedFiles>(fileSystem(),
                                               [this](const Bytes& piece) { pieces_.push_back(piece); });
    }
    std::shared_ptr<ReplayedFiles> replayed() {
        return std::make_shared<ReplayedFiles>([this] {
            if (pieces_.empty()) throw Error(ErrorKind::Failed, "nothing left");
            Bytes piece = std::move(pieces_.front());
            pieces_.pop_front();
            return piece;
        });
    }
    static LoadOptions from(std::shared_ptr<FileSource> files) {
        LoadOptions options;
        options.source = std::move(files);
        return options;
    }

    std::deque<Bytes> pieces_;
};

// Files of several kinds, in another folder, through a link; and then there are none.
TEST_F(SceneStream, ScenesAreReadWithoutTheirFiles) {
    fs::create_directories("real/sub");
    writeText("real/a.json", R"({"camera": {"eye": [0, 0, 5], "target": [0, 0, 0]},
        "meshes": {"m": {"file": "sub/m.obj"}, "n": {"file": "sub/../sub/m.obj"}},
        "objects": [{"type": "mesh", "mesh": "m"}, {"type": "mesh", "mesh": "n", "transform": [{"translate": [1, 0, 0]}]}]})");
    writeText("real/sub/m.obj", "mtllib m.mtl none.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n");
    writeText("real/sub/m.mtl", "newmtl red\nKd 1 0 0\n");
    fs::create_directory_symlink("real", "linked");
    const auto record = recorded();
    const Scene first = loadScene("linked/a.json", from(record));
    ASSERT_EQ(first.sources.size(), 3u);
    fs::remove_all("real");
    fs::remove("linked");
    const Scene second = loadScene("linked/a.json", from(replayed()));
    ASSERT_EQ(second.sources.size(), 3u);
    for (size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(second.sources[i].name, first.sources[i].name);
        EXPECT_EQ(second.sources[i].hash, first.sources[i].hash);
    }
    EXPECT_EQ(second.objects.size(), 2u);
    EXPECT_EQ(second.warnings, first.warnings);
    EXPECT_EQ(second.warnings.size(), 1u);  // there is no none.mtl
    EXPECT_TRUE(pieces_.empty());
}

TEST_F(SceneStream, ErrorsAreTheSame) {
    writeText("a.json",
              R"({"meshes": {"m": {"file": "m.ply"}}, "objects": [{"type": "mesh", "mesh": "m"}]})");
    for (const bool empty : {false, true}) {
        if (empty) writeText("m.ply", "");
        pieces_.clear();
        const auto record = recorded();
        const std::string here = errorOf(ErrorKind::Scene, [&] { loadScene("a.json", from(record)); });
        EXPECT_EQ(errorOf(ErrorKind::Scene, [&] { loadScene("a.json", from(replayed())); }), here);
        EXPECT_HAS(here, empty ? "empty" : "no such file");
    }
}

TEST_F(SceneStream, AnotherSceneIsFoundOut) {
    writeText("a.json", "{}");
    writeText("b.json", "{}");
    const auto record = recorded();
    record->read("a.json", {});
    const auto replay = replayed();
    EXPECT_EQ(errorOf(ErrorKind::Failed, [&] { replay->read("b.json", {}); }),
              "b.json: is read where rank 0 read a.json: the processes do not render the same image");
}

TEST_F(SceneStream, LargeFilesGoInPieces) {
    std::string text;
    for (int i = 0; i < 500'000; ++i) text += std::to_string(int64_t{i} * 7919 % 100'000) + "\n";
    writeText("large", text);
    const auto record = recorded();
    record->read("large", {});
    EXPECT_GE(pieces_.size(), 3u);
    EXPECT_EQ(replayed()->read("large", {}), text);
}

}  // namespace glint::farm::test::scene_stream_test
