// Files beside the image: those of the scene, and what is remembered of scenes between windows.
#include "view/files.h"

#include <sys/prctl.h>
#include <sys/stat.h>

#include <set>

#include "import/load.h"
#include "support.h"

namespace glint::view::test::files_test {
namespace fs = std::filesystem;
using glint::test::ScopedEnvironment;

class Recent : public glint::test::FolderTest {
  protected:
    fs::path scene(const std::string& name) const {
        writeText(file(name), "{}");
        return file(name);
    }
    const fs::path list_ = file("state") / "glint" / "recent";
};

TEST_F(Recent, LiesWhereTheSpecificationSays) {
    const ScopedEnvironment home("HOME", "/home/me");
    {
        const ScopedEnvironment state("XDG_STATE_HOME", "/var/state");
        EXPECT_EQ(stateFile("x"), "/var/state/glint/x");
    }
    for (const char* none : {static_cast<const char*>(nullptr), "", "relative/path"}) {
        const ScopedEnvironment state("XDG_STATE_HOME", none);
        EXPECT_EQ(stateFile("x"), "/home/me/.local/state/glint/x");
    }
    const ScopedEnvironment state("XDG_STATE_HOME", nullptr);
    const ScopedEnvironment homeless("HOME", nullptr);
    EXPECT_EQ(stateFile("x"), "");
}

TEST_F(Recent, TheLatestComesFirstAndEachOnce) {
    const fs::path a = scene("a.json"), b = scene("b.json");
    RecentFiles first(list_);
    EXPECT_TRUE(first.list().empty());
    first.add(a);
    first.add(b);
    first.add(file(".") / "a.json");  // the same file
    EXPECT_EQ(RecentFiles(list_).list(), (std::vector<std::string>{a, b}));
    struct stat status {};
    ASSERT_EQ(stat(list_.parent_path().c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777, 0700u);
}

// Two windows at a time do not forget each other's scenes.
TEST_F(Recent, OtherWindowsScenesStay) {
    const fs::path a = scene("a.json"), b = scene("b.json"), c = scene("c.json");
    RecentFiles one(list_), two(list_);
    one.add(a);
    two.add(b);
    one.add(c);
    EXPECT_EQ(one.list(), (std::vector<std::string>{c, b, a}));
}

TEST_F(Recent, FilesThatAreGoneAreLeftOutAndTheListIsShort) {
    RecentFiles recent(list_);
    for (int i = 0; i < 20; ++i) recent.add(scene(std::to_string(i) + ".json"));
    EXPECT_EQ(recent.list().size(), Remembered::kMost);
    EXPECT_EQ(recent.list().front(), file("19.json"));
    fs::remove(file("18.json"));
    EXPECT_EQ(RecentFiles(list_).list().at(1), file("17.json"));
    recent.add(file("19.json"));
    EXPECT_LACKS(glint::test::readText(list_), "18.json");
}

// The list belongs to the user, who may have put anything there.
TEST_F(Recent, NothingThatIsThereIsAnError) {
    const fs::path a = scene("a.json");
    fs::create_directories(list_.parent_path());
    writeText(list_,
              "relative.json\n\n\xff\xfe\n" + a.string() + "\n" + a.string() + "\n" + file("b").string());
    EXPECT_EQ(RecentFiles(list_).list(), std::vector<std::string>{a});
    writeText(list_, std::string(5 << 20, '/'));
    EXPECT_TRUE(RecentFiles(list_).list().empty());
    fs::remove(list_);
    fs::create_directories(list_);  // a folder of that name
    RecentFiles stubborn(list_);
    stubborn.add(a);
    EXPECT_EQ(stubborn.list(), std::vector<std::string>{a});
    RecentFiles nowhere("/proc/glint/recent");  // where nobody can make anything
    nowhere.add(a);
    EXPECT_EQ(nowhere.list(), std::vector<std::string>{a});
    RecentFiles forgetful;
    forgetful.add(a);
    EXPECT_EQ(forgetful.list(), std::vector<std::string>{a});
}

// A hint goes once it has been followed, for later windows too.
TEST_F(Recent, HintsGoOnceFollowed) {
    const fs::path state = file("state") / "glint" / "hints";
    Hints first(state);
    EXPECT_TRUE(first.wanted(Hint::Turn) && first.wanted(Hint::Compare));
    EXPECT_FALSE(first.done(Hint::Turn));
    EXPECT_FALSE(first.done(Hint::Turn));
    Hints second(state);
    EXPECT_FALSE(second.wanted(Hint::Turn));
    EXPECT_TRUE(second.any());
    EXPECT_FALSE(second.done(Hint::Save));
    EXPECT_FALSE(second.done(Hint::Pick));
    EXPECT_TRUE(second.done(Hint::Compare)) << "the last one";
    EXPECT_FALSE(second.done(Hint::Compare));
    EXPECT_FALSE(Hints(state).any());
    fs::remove(state);
    Hints closed(state);
    closed.close();
    EXPECT_FALSE(Hints(state).any());
    writeText(state, "turn\nnonsense\n\xff");
    EXPECT_TRUE(Hints(state).any());
    EXPECT_FALSE(Hints(state).wanted(Hint::Turn));
    Hints nowhere("/proc/glint/hints");
    EXPECT_FALSE(nowhere.done(Hint::Pick));
    EXPECT_FALSE(nowhere.wanted(Hint::Pick));
}

// The name of this thread is a file that root cannot replace either.
TEST_F(Recent, HintsOfAFileThatCannotBeWrittenGoOnceFollowed) {
    prctl(PR_SET_NAME, "turn");
    Hints hints("/proc/self/comm");
    EXPECT_FALSE(hints.wanted(Hint::Turn));
    EXPECT_FALSE(hints.done(Hint::Pick));
    EXPECT_FALSE(hints.done(Hint::Save));
    EXPECT_FALSE(hints.wanted(Hint::Pick));
    hints.close();
    EXPECT_FALSE(hints.any());
}

// ---- of the scene ----

class SceneFiles : public FolderTest {};

TEST_F(SceneFiles, AreThoseThatTheSceneWasReadFrom) {
    std::filesystem::create_directories("parts");
    writeText("parts/a.obj", "mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    writeText("parts/a.mtl", "newmtl m\nKd 1 0 0\n");
    writeText("scene.json", R"({ // a comment
      "meshes": {"a": {"file": "parts/a.obj"}}, "objects": [{"type": "mesh", "mesh": "a"}]})");
    std::set<std::string> names;
    for (const auto& file : sceneFiles("scene.json", loadScene("scene.json"))) names.insert(file.string());
    EXPECT_EQ(names, (std::set<std::string>{"scene.json", "parts/a.obj", "parts/a.mtl"}));
}

TEST_F(SceneFiles, ReportsAChangeOnceItIsOver) {
    FileWatch watch;
    watch.watch({"scene.json"});
    EXPECT_FALSE(watch.changed());
    writeText("scene.json", "{}");
    EXPECT_FALSE(watch.changed());  // may still be being written
    EXPECT_TRUE(watch.changed());
    EXPECT_FALSE(watch.changed());
    std::filesystem::remove("scene.json");
    EXPECT_FALSE(watch.changed());
    EXPECT_TRUE(watch.changed());
}

}  // namespace glint::view::test::files_test
