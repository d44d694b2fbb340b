#include "target.h"

#include <unistd.h>
#include <algorithm>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string_view>

#include "core/image_io.h"

namespace glint::fuzz {

namespace {

namespace fs = std::filesystem;

class Folder {
  public:
    Folder() {
        const fs::path shared = "/dev/shm";
        std::string name =
            ((fs::is_directory(shared) ? shared : fs::temp_directory_path()) / "glint-fuzz.XXXXXX").string();
        if (mkdtemp(name.data()) == nullptr) std::abort();
        path = name;
        std::ofstream(path / "m.obj")
            << "mtllib input.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
               "usemtl a\nf 1/1 2/2 3/3\nusemtl b\nf 1 2 3\nusemtl c\nf 3 2 1\n";
        std::ofstream(path / "m.mtl") << "newmtl a\nKd 1 0 0\nnewmtl b\nKd 0 1 0\n";
        std::ofstream(path / "b.bin") << std::string(256, '\0');
        writeImage(path / "t.png", Image(2, 2, 3));
    }
    ~Folder() {
        std::error_code ignored;
        fs::remove_all(path, ignored);
    }
    fs::path path;
};

// Without the controls of ASCII and those that UTF-8 has in two bytes, and no longer than anybody reads.
bool isOneLine(std::string_view text) {
    unsigned char before = 0;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 0x20 || byte == 0x7f || (before == 0xc2 && byte < 0xa0)) return false;
        before = byte;
    }
    return !text.empty() && text.size() < 8192;
}

// Scene files report up to ten errors, a line each, and that there are more.
bool areFewLines(std::string_view text) {
    for (int line = 0; line < 11; ++line) {
        const size_t end = text.find('\n');
        if (!isOneLine(text.substr(0, end))) return false;
        if (end == std::string_view::npos) return true;
        text.remove_prefix(end + 1);
        text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
    }
    return false;
}

[[noreturn]] void complain(const char* what, const char* message) {
    std::fprintf(stderr, "%s: %s\n", what, message);
    std::abort();
}

}  // namespace

const fs::path& folder() {
    static const Folder theFolder;
    return theFolder.path;
}

fs::path write(const std::string& name, Input input) {
    fs::path path = folder() / name;
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file.write(reinterpret_cast<const char*>(input.data()), static_cast<std::streamsize>(input.size()));
    if (!file.flush()) complain("cannot write", path.c_str());
    return path;
}

void expectAnswer(ErrorKind kind, const std::function<void()>& read) {
    try {
        read();
    } catch (const Error& error) {
        if (error.kind() != kind) complain("an error of the wrong kind", error.what());
        if (!areFewLines(error.what())) complain("an error that is not a few printable lines", error.what());
    }
}

}  // namespace glint::fuzz
