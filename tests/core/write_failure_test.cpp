// Writing that fails must state the reason, leave nothing behind and keep the old files.
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>

#include "core/file_io.h"
#include "core/image_io.h"
#include "support/support.h"

namespace glint::write_failure_test {
namespace fs = std::filesystem;
using test::errorOf;
using test::readBytes;
using test::writeBytes;

const std::vector<uint8_t> kOld = {'o', 'l', 'd'};

class WriteFailure : public test::FolderTest {
  protected:
    static void expectUnwritable(const std::string& path, const std::string& reason) {
        EXPECT_EQ(errorOf(ErrorKind::Failed, [&] { writeImage(path, Image(1, 1, 3)); }),
                  path + ": cannot write: " + reason);
    }
    // An image with the layers color and normal.
    void expectLayersUnwritable(const std::string& reason) {
        const std::vector<Layer> layers = {{"color", Image(1, 1, 3)}, {"normal", Image(1, 1, 3)}};
        EXPECT_EQ(errorOf(ErrorKind::Failed, [&] { writeLayers(file("x.pfm"), layers); }),
                  file("x.normal.pfm").string() + ": cannot write: " + reason);
        EXPECT_EQ(names(), std::set<std::string>{"x.normal.pfm"});
    }
};

// No file may grow beyond `bytes` while this exists: the stand-in for a full disk.
class FileSizeLimit {
  public:
    explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
        getrlimit(RLIMIT_FSIZE, &old_);
        const rlimit limit{bytes, old_.rlim_max};
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FileSizeLimit() {
        setrlimit(RLIMIT_FSIZE, &old_);
        std::signal(SIGXFSZ, handler_);
    }
    FileSizeLimit(const FileSizeLimit&) = delete;
    FileSizeLimit& operator=(const FileSizeLimit&) = delete;

  private:
    rlimit old_{};
    void (*handler_)(int);
};

TEST_F(WriteFailure, PlacesThatTakeNoFile) {
    writeBytes(file("out"), kOld);
    fs::create_directory(file("x.png"));
    for (const char* name : {"no/x.png", "no/x.exr", "no/x.pfm", "no/x.hdr"})
        expectUnwritable(file(name), "there is no folder " + file("no").string());
    expectUnwritable(file("x.png"), "Is a directory");
    expectUnwritable(file("out/x.png"), file("out").string() + " is not a folder");
    EXPECT_EQ(names(), (std::set<std::string>{"out", "x.png"}));
}

TEST_F(WriteFailure, NoPermission) {
    fs::create_directory(file("locked"));
    fs::permissions(file("locked"), fs::perms::owner_read | fs::perms::owner_exec);
    test::withoutPrivileges(folder_, [&] { expectUnwritable(file("locked/x.png"), "Permission denied"); });
    fs::permissions(file("locked"), fs::perms::owner_all);

    // Renaming would replace a write-protected file against its owner's intention.
    const std::string path = file("protected.png").string();
    writeBytes(path, kOld);
    fs::permissions(path, fs::perms::owner_read);
    test::withoutPrivileges(folder_, [&] { expectUnwritable(path, "Permission denied"); });
    EXPECT_EQ(readBytes(path), kOld);
}

TEST_F(WriteFailure, FullDiskKeepsTheOldFile) {
    const std::string path = file("x.pfm").string();
    writeBytes(path, kOld);
    std::string message;
    {
        const FileSizeLimit limit(1000);
        message = errorOf(ErrorKind::Failed, [&] { writeImage(path, Image(64, 64, 3)); });
    }
    EXPECT_EQ(message, path + ": cannot write: File too large");
    EXPECT_EQ(readBytes(path), kOld);
    EXPECT_EQ(names(), std::set<std::string>{"x.pfm"});
}

TEST_F(WriteFailure, FullDiskForTheSecondLayerLeavesNone) {
    const std::string path = file("x.pfm").string();
    const std::vector<Layer> layers = {{"color", Image(8, 8, 1)}, {"normal", Image(8, 8, 3)}};
    std::string message;
    {
        // Grey needs 8 * 8 * 4 = 256 bytes and a header, normals three times as much.
        const FileSizeLimit limit(500);
        message = errorOf(ErrorKind::Failed, [&] { writeLayers(path, layers); });
    }
    EXPECT_EQ(message, file("x.normal.pfm").string() + ": cannot write: File too large");
    EXPECT_TRUE(names().empty());
}

TEST_F(WriteFailure, LaterLayerFailsAfterTheFirstIsInPlace) {
    ASSERT_TRUE(fs::is_character_file("/dev/full"));
    fs::create_symlink("/dev/full", file("x.normal.pfm"));
    expectLayersUnwritable("No space left on device");
    EXPECT_TRUE(fs::is_symlink(file("x.normal.pfm")));
}

TEST_F(WriteFailure, LayerThatIsAFolderStopsAllOfThem) {
    fs::create_directory(file("x.normal.pfm"));
    expectLayersUnwritable("Is a directory");
}

class WriteFiles : public test::FolderTest {};

TEST_F(WriteFiles, DevicesStayDevices) {
    fs::create_symlink("/dev/null", file("null.png"));
    writeImage(file("null.png"), Image(1, 1, 3));
    EXPECT_TRUE(fs::is_symlink(file("null.png")));
    EXPECT_TRUE(fs::is_character_file("/dev/null"));
    EXPECT_EQ(names(), std::set<std::string>{"null.png"});
}

TEST_F(WriteFiles, LinksAreFollowedWhetherOrNotTheirFileExists) {
    fs::create_symlink("real.txt", file("link.txt"));
    for (const bool exists : {false, true}) {
        if (exists) writeBytes(file("real.txt"), kOld);
        writeTextFile(file("link.txt"), "new");
        EXPECT_TRUE(fs::is_symlink(file("link.txt"))) << exists;
        EXPECT_EQ(readBytes(file("real.txt")), (std::vector<uint8_t>{'n', 'e', 'w'})) << exists;
        EXPECT_EQ(names(), (std::set<std::string>{"link.txt", "real.txt"})) << exists;
    }
}

TEST_F(WriteFiles, ModesAreKept) {
    writeBytes(file("a.txt"), kOld);
    const fs::perms mode = fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_read;
    fs::permissions(file("a.txt"), mode);
    writeTextFile(file("a.txt"), "new");
    EXPECT_EQ(fs::status(file("a.txt")).permissions(), mode);
}

TEST_F(WriteFiles, NewFilesObeyTheUmask) {
    const mode_t old = ::umask(027);
    writeTextFile(file("a.txt"), "new");
    ::umask(old);
    struct stat status {};
    ASSERT_EQ(::stat(file("a.txt").c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777, 0640u);
}

TEST_F(WriteFiles, LongNames) {
    // 255 bytes, the most that Linux file systems take: the temporary name must not be longer.
    const std::string name = std::string(251, 'n') + ".txt";
    writeTextFile(file(name), "text");
    EXPECT_EQ(names(), std::set<std::string>{name});
}

TEST_F(WriteFiles, SmallAndLargeTextsComeBackWhole) {
    for (size_t size : {size_t{1}, size_t{65536}, size_t{3'000'000}}) {
        std::string text(size, 'a');
        for (size_t i = 0; i < size; ++i) text[i] = static_cast<char>(i * 31 % 251);
        writeTextFile(file("a.bin"), text);
        EXPECT_TRUE(test::readText(file("a.bin")) == text) << size;
    }
}

}  // namespace glint::write_failure_test
