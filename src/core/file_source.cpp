#include "core/file_source.h"

#include <system_error>

#include "core/error.h"
#include "core/text_file.h"

namespace glint {

namespace {

namespace fs = std::filesystem;

class FileSystem : public FileSource {
  public:
    std::string read(const fs::path& path, const Context& context) override {
        return readWholeFile(path, context);
    }

    FileStatus status(const fs::path& path) override {
        std::error_code code;
        FileStatus found;
        const fs::file_status status = fs::status(path, code);
        found.exists = fs::exists(status);
        found.regular = fs::is_regular_file(status);
        if (found.regular) found.size = fs::file_size(path, code);
        if (code) found.size = 0;
        return found;
    }

    fs::path real(const fs::path& path) override {
        std::error_code code;
        // weakly_canonical keeps a relative path to a missing file relative.
        const fs::path whole = fs::absolute(path.empty() ? "." : path);
        const fs::path found = fs::weakly_canonical(whole, code);
        if (code)
            throw Error(ErrorKind::Scene, printable(path.string() + ": cannot be read: " + code.message()));
        return found;
    }
};

}  // namespace

std::shared_ptr<FileSource> fileSystem() {
    return std::make_shared<FileSystem>();
}

}  // namespace glint
