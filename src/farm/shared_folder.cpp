#include "farm/shared_folder.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <set>
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
      groupSize_(header.parts > kMostFlat ? kGroup : header.parts),
      there_(static_cast<size_t>(header.parts), false) {
    for (int first = 1; first <= header.parts; first += groupSize_)
        left_.push_back(std::min(groupSize_, header.parts + 1 - first));
}

std::string SharedFolder::nameOfUnit(int part) const {
    const int first = (part - 1) / groupSize_ * groupSize_ + 1;
    return (left_.size() > 1 ? "units-" + std::to_string(first) + "/" : "") + "unit-" + std::to_string(part);
}

fs::path SharedFolder::resultPath(int part) const {
    return folder_ / (nameOfUnit(part) + kPartExtension);
}

void SharedFolder::remember(int part) {
    const auto index = static_cast<size_t>(part) - 1;
    if (there_[index]) return;
    there_[index] = true;
    --left_[index / static_cast<size_t>(groupSize_)];
    ++done_;
}

// Appends the group's units whose results are not there. True if nobody has claimed one of them.
bool SharedFolder::look(int group, std::vector<Work>& works, std::vector<int>& parts) {
    const int first = group * groupSize_ + 1, end = std::min(first + groupSize_, header_.parts + 1);
    const fs::path folder = (folder_ / nameOfUnit(first)).parent_path();
    const FolderContent content = contentOf(folder);
    if (!content.exists) {
        std::error_code code;
        fs::create_directory(folder, code);
        if (code) refuse(folder, "cannot write: " + code.message());
    }
    const std::set<std::string> files(content.others.begin(), content.others.end());
    bool free = false;
    for (int part = first; part < end; ++part) {
        const std::string name = fs::path(nameOfUnit(part)).filename().string();
        if (files.contains(name + kPartExtension)) remember(part);
        if (there_[static_cast<size_t>(part) - 1]) continue;
        const auto claim = content.claims.find(name);
        const bool claimed = claim != content.claims.end();
        works.push_back({nameOfUnit(part), claimed ? std::optional(claim->second) : std::nullopt});
        parts.push_back(part);
        free = free || !claimed;
    }
    return free;
}

bool SharedFolder::has(int part) const {
    std::error_code code;
    return fs::exists(resultPath(part), code);
}

std::optional<int> SharedFolder::next(std::optional<double> patience) {
    while (true) {
        const auto part = claimOne(patience);
        if (!part || !has(*part)) return part;
        claims_.release();  // its holder was done between the look and the claim
    }
}

std::optional<int> SharedFolder::claimOne(std::optional<double> patience) {
    std::vector<Work> works;
    std::vector<int> parts;
    // Units are claimed in their order, so nobody is at those that follow one that is free.
    for (size_t group = 0; group < left_.size(); ++group)
        if (left_[group] > 0 && look(static_cast<int>(group), works, parts)) break;
    const auto name = claims_.claimOf(works, patience);
    if (!name) return std::nullopt;
    const auto at = std::find_if(works.begin(), works.end(), [&](const Work& w) { return w.name == *name; });
    return parts[static_cast<size_t>(at - works.begin())];
}

void SharedFolder::put(const UnitResult& result) {
    writeFile(resultPath(result.unit.part), encodePart(header_, result));
    remember(result.unit.part);
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
