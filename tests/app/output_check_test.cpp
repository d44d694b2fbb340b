// Images that cannot be written or do not fit into memory: an error before rendering, exit code 1, no files.
#include "app/commands.h"

#include <algorithm>
#include <functional>
#include <limits>

#include "core/available_memory.h"
#include "core/error.h"
#include "support.h"

namespace glint::app::test::output_check_test {
std::string messageOf(const std::function<void()>& call) {
    return errorOf(ErrorKind::Failed, call);
}

class OutputCheck : public FolderTest {};

// By the class that writes files, whose messages tests/core/write_failure_test.cpp checks.
TEST_F(OutputCheck, SaysWhatIsInTheWay) {
    writeText("file", "x");
    EXPECT_EQ(messageOf([] { checkPicturePath("file/a.png"); }),
              "file/a.png: cannot write: file is not a folder");
    const std::string longName = std::string(300, 'a') + ".png";
    EXPECT_EQ(messageOf([&] { checkPicturePath(longName); }),
              longName + ": cannot write: File name too long");
    std::filesystem::create_symlink("round.png", "round.png");
    EXPECT_EQ(messageOf([] { checkPicturePath("round.png"); }),
              "round.png: cannot write: Too many levels of symbolic links");
    EXPECT_EQ(messageOf([] { makeFolder("file"); }), "file: cannot write: file is not a folder");
    std::filesystem::create_directory("sub");
    std::filesystem::permissions("sub", std::filesystem::perms::owner_read);
    glint::test::withoutPrivileges(folder_, [] {
        EXPECT_EQ(messageOf([] { makeFolder("sub"); }), "sub: cannot write: Permission denied");
    });
    std::filesystem::permissions("sub", std::filesystem::perms::owner_all);
    EXPECT_EQ(names(), (std::set<std::string>{"file", "round.png", "sub"}));
}

TEST_F(OutputCheck, AllowsWhatCanBeWritten) {
    writeText("old.png", "x");
    std::filesystem::create_directory("sub");
    std::filesystem::create_symlink("/dev/null", "null.png");
    std::filesystem::create_symlink("nowhere.png", "dangling.png");
    for (const char* path :
         {"new.png", "new.EXR", "old.png", "sub/a.pfm", "./a.hdr", "null.png", "dangling.png"}) {
        EXPECT_EQ(messageOf([&] { checkPicturePath(path); }), "no error") << path;
    }
    EXPECT_EQ(messageOf([] { makeFolder("sub"); }), "no error");
}

TEST_F(OutputCheck, FoldersTakeTheNameOfTheScene) {
    writeSmallScene("a.json");
    std::filesystem::create_directory("old");
    EXPECT_EQ(runGlint("render a.json --backend cpu -q -o old").err, "");
    EXPECT_EQ(runGlint("render a.json --backend cpu -q -o new/").err, "");
    EXPECT_TRUE(std::filesystem::exists("old/a.png") && std::filesystem::exists("new/a.png"));
}

// A folder in /proc refuses files to everyone, root included.
TEST_F(OutputCheck, FolderThatRefusesAtTheEndLeavesNothing) {
    writeSmallScene("a.json");
    const Ran ran = runGlint("render a.json --backend cpu -o /proc/self/a.png");
    EXPECT_EQ(ran.code, 1);
    EXPECT_STARTS(ran.err, "glint: /proc/self/a.png: cannot write: ");
    EXPECT_EQ(ran.out, "");
}

TEST_F(OutputCheck, ComesBeforeTheSceneIsRead) {
    writeText("a.json", "{\"objekts\": []}");
    expectError("render no.json -o no/a.png", 1, "no/a.png: cannot write: there is no folder no");
    expectError("verify a.json --artifacts a.json", 1, "a.json: cannot write: a.json is not a folder");
    expectError("diff no.png no.png -o no/d.png", 1, "no/d.png: cannot write: there is no folder no");
}

TEST_F(OutputCheck, MemoryIsComparedWithWhatIsFree) {
    constexpr uint64_t kGibibyte = uint64_t{1} << 30;
    EXPECT_EQ(messageOf([] { checkMemory(1024, 1024, 1024, kGibibyte); }), "no error");
    EXPECT_EQ(messageOf([] { checkMemory(1024, 1024, 1025, kGibibyte); }),
              "an image of 1024x1024 pixels takes 1.0 GiB of memory, 1.0 GiB are free; ask for a smaller "
              "--size (1023x1023 fits), or for parts with glint render --crop");
    EXPECT_EQ(messageOf([] { checkMemory(65536, 65536, 1000, std::numeric_limits<uint64_t>::max()); }),
              "no error");
    EXPECT_GT(availableMemory(), uint64_t{1} << 20);
}

// 65536^2 pixels times 17 bytes, and times more than 200 with all layers, are beyond this machine, or the
// test must ask for more.
TEST_F(OutputCheck, HugePicturesAreRefused) {
    ASSERT_LT(availableMemory(), uint64_t{68} << 30);
    writeSmallScene("a.json");
    const std::pair<const char*, const char*> cases[] = {
        {"render a.json --aov color,alpha,depth,position,normal,uv,object,primitive,material,bounces,cost",
         ""},
        {"bench a.json", "68.0 GiB of memory, "}};
    for (const auto& [command, size] : cases) {
        const Ran ran = runGlint(command + Words("--backend cpu --size 65536x65536"));
        EXPECT_STARTS(ran.err, std::string("glint: an image of 65536x65536 pixels takes ") + size);
        EXPECT_ENDS(ran.err, "\n");
        EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1);
        EXPECT_EQ(ran.code, 1);
    }
    EXPECT_EQ(names(), std::set<std::string>{"a.json"});
}

}  // namespace glint::app::test::output_check_test
