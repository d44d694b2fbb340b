#include "core/file_source.h"

#include <map>
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
        const fs::path last = path.filename();
        std::error_code code;
        // A name that is no link lies in its folder, which is resolved once.
        if (last.empty() || last == "." || last == ".." || fs::is_symlink(fs::symlink_status(path, code)))
            return found(path, path);
        if (code && code != std::errc::no_such_file_or_directory && code != std::errc::not_a_directory)
            return found(path, path);
        const fs::path parent = path.parent_path();
        auto folder = folders_.find(parent.string());
        if (folder == folders_.end()) folder = folders_.emplace(parent.string(), found(parent, path)).first;
        return folder->second / last;
    }

  private:
    // With all links followed; `name` is what the message is about.
    static fs::path found(const fs::path& path, const fs::path& name) {
        std::error_code code;
        // Absolute, for one that does not exist stays relative else.
        const fs::path whole = fs::absolute(path.empty() ? "." : path);
        fs::path real = fs::canonical(whole, code);
        // This takes any path, and several calls of the system for each of its folders.
        if (code) real = fs::weakly_canonical(whole, code);
        if (code)
            throw Error(ErrorKind::Scene, printable(name.string() + ": cannot be read: " + code.message()));
        return real;
    }

    std::map<std::string, fs::path> folders_;  // by name, where found() found them
};

}  // namespace

std::shared_ptr<FileSource> fileSystem() {
    return std::make_shared<FileSystem>();
}

}  // namespace glint
