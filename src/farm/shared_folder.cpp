#include "farm/shared_folder.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "core/error.h"
#include "core/file_io.h"
#include "core/text_file.h"

namespace glint::farm {

namespace {

namespace fs = std::filesystem;

constexpr const char* kPicture = "picture";  // which one the folder is for
constexpr const char* kNote = "written";
constexpr const char* kMerge = "merge";

std::string unitName(int part) {
    return "unit-" + std::to_string(part);
}

[[noreturn]] void refuse(const fs::path& path, const std::string& what) {
    throw Error(ErrorKind::Failed, path.string() + ": " + what);
}

// Of two that begin at once, one makes the file, and both read it.
void agree(const fs::path& folder, const UnitHeader& header) {
    const fs::path path = folder / kPicture;
    std::error_code code;
    if (!fs::exists(path, code)) {
        const fs::path mine = folder / ("." + std::string(kPicture) + "." + newHolder());
        writeFile(mine, encodeHeader(header));
        fs::create_hard_link(mine, path, code);
        const bool noLinks = code && !fs::exists(path);
        if (noLinks) fs::rename(mine, path, code);
        std::error_code ignored;
        fs::remove(mine, ignored);
        if (noLinks && code) refuse(path, "cannot write: " + code.message());
    }
    const std::string other = difference(readUnits(path, true).header.identity, header.identity);
    if (!other.empty()) refuse(folder, "is the folder of another picture: " + other);
}

const fs::path& ready(const fs::path& folder, const UnitHeader& header) {
    std::error_code code;
    fs::create_directories(folder, code);
    if (!fs::is_directory(folder))
        refuse(folder, "cannot be used: " + (code ? code.message() : "not a folder"));
    if (::access(folder.c_str(), R_OK | W_OK | X_OK) != 0)
        refuse(folder, "cannot be used: " + std::generic_category().message(errno));
    agree(folder, header);
    return folder;
}

}  // namespace

SharedFolder::SharedFolder(const fs::path& folder, const UnitHeader& header, double lease)
    : folder_(ready(folder, header)),
      header_(header),
      claims_(folder, lease),
      there_(static_cast<size_t>(header.parts), false) {}

fs::path SharedFolder::resultPath(int part) const {
    return folder_ / (unitName(part) + kPartExtension);
}

int SharedFolder::done() {
    std::error_code code;
    for (int part = 1; part <= header_.parts; ++part)
        if (!there_[static_cast<size_t>(part) - 1] && fs::exists(resultPath(part), code))
            there_[static_cast<size_t>(part) - 1] = true;
    return static_cast<int>(std::count(there_.begin(), there_.end(), true));
}

bool SharedFolder::has(int part) const {
    std::error_code code;
    return fs::exists(resultPath(part), code);
}

std::optional<int> SharedFolder::next(std::optional<double> patience) {
    done();
    std::vector<std::string> names;
    std::vector<int> parts;
    for (int part = 1; part <= header_.parts; ++part) {
        if (there_[static_cast<size_t>(part) - 1]) continue;
        names.push_back(unitName(part));
        parts.push_back(part);
    }
    const auto name = claims_.claim(names, patience);
    if (!name) return std::nullopt;
    const auto at = std::find(names.begin(), names.end(), *name) - names.begin();
    return parts[static_cast<size_t>(at)];
}

void SharedFolder::put(const UnitResult& result) {
    writeFile(resultPath(result.unit.part), encodePart(header_, result));
    there_[static_cast<size_t>(result.unit.part) - 1] = true;
    claims_.release();
}

bool SharedFolder::mayMerge() {
    return claims_.claim({kMerge}).has_value();
}

void SharedFolder::forEach(const std::function<void(const UnitResult&)>& add) const {
    for (int part = 1; part <= header_.parts; ++part) {
        const fs::path path = resultPath(part);
        const UnitFile file = readUnits(path);
        const std::string other = difference(file.header.identity, header_.identity);
        if (!other.empty()) refuse(path, "belongs to another picture: " + other);
        for (const UnitResult& result : file.results) add(result);
    }
}

std::optional<std::string> SharedFolder::note() const {
    std::error_code code;
    if (!fs::exists(folder_ / kNote, code)) return std::nullopt;
    return readWholeFile(folder_ / kNote);
}

void SharedFolder::setNote(const std::string& text) {
    writeTextFile(folder_ / kNote, text);
    claims_.release();
}

}  // namespace glint::farm
