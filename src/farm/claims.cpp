#include "farm/claims.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <fstream>
#include <random>
#include <sstream>
#include <system_error>

#include "core/error.h"
#include "farm/process_name.h"

namespace glint::farm {

namespace {

namespace fs = std::filesystem;

constexpr const char* kMark = ".claim-";
constexpr const char* kReleased = "released\n";
constexpr int kBeatsOfLease = 10;

[[noreturn]] void cannotWrite(const fs::path& path, int number) {
    throw Error(ErrorKind::Failed,
                path.string() + ": cannot write: " + std::generic_category().message(number));
}

bool writeText(int file, const std::string& text) {
    return ::write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size());
}

std::string readText(const fs::path& path) {
    std::ifstream stream(path, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
}

// A link that a server made and whose answer got lost is refused when it is asked for again (open(2), on
// NFS).
bool hasTwoNames(const fs::path& path) {
    struct stat found {};
    return ::stat(path.c_str(), &found) == 0 && found.st_nlink == 2;
}

// False if there is such a file already. A link appears whole and is exclusive on file systems where O_EXCL
// may not be; where there are no links, O_EXCL.
bool createExclusively(const fs::path& path, const std::string& text, const fs::path& temporary) {
    const int file = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (file < 0) cannotWrite(temporary, errno);
    const bool written = writeText(file, text);
    int number = errno;
    if (::close(file) != 0 || !written) {
        ::unlink(temporary.c_str());
        cannotWrite(temporary, number);
    }
    bool linked = ::link(temporary.c_str(), path.c_str()) == 0;
    number = errno;
    linked = linked || hasTwoNames(temporary);
    ::unlink(temporary.c_str());
    if (linked) return true;
    if (number == EEXIST) return false;
    if (number != EPERM && number != ENOTSUP && number != EMLINK && number != ENOSYS)
        cannotWrite(path, number);
    const int direct = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (direct < 0 && errno == EEXIST) return false;
    if (direct < 0) cannotWrite(path, errno);
    const bool done = writeText(direct, text);
    number = errno;
    if (::close(direct) != 0 || !done) cannotWrite(path, number);
    return true;
}

}  // namespace

std::string newHolder() {
    std::array<char, 256> host{};
    if (::gethostname(host.data(), host.size() - 1) != 0) host = {'?'};
    std::random_device random;
    std::array<char, 17> token{};
    std::snprintf(token.data(), token.size(), "%08x%08x", random(), random());
    return std::string(host.data()) + "-" + std::to_string(::getpid()) + "-" + token.data();
}

FolderContent contentOf(const fs::path& folder) {
    FolderContent found;
    std::error_code code;
    fs::directory_iterator at(folder, code);
    if (code == std::errc::no_such_file_or_directory) return found;
    found.exists = true;
    for (const fs::directory_iterator end; !code && at != end; at.increment(code)) {
        std::string file = at->path().filename().string();
        const size_t mark = file.rfind(kMark);
        if (mark == std::string::npos) {
            found.others.push_back(std::move(file));
            continue;
        }
        const char* digits = file.data() + mark + std::char_traits<char>::length(kMark);
        int generation = 0;
        const auto [last, error] = std::from_chars(digits, file.data() + file.size(), generation);
        if (error != std::errc() || last != file.data() + file.size()) continue;
        int& known = found.claims.try_emplace(file.substr(0, mark), generation).first->second;
        known = std::max(known, generation);
    }
    if (code) throw Error(ErrorKind::Failed, folder.string() + ": cannot read: " + code.message());
    return found;
}

Claims::Claims(const fs::path& folder, double lease)
    : folder_(folder),
      lease_(std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(lease))),
      holder_(newHolder()),
      thread_([this] { beat(); }) {}

Claims::~Claims() {
    release();
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

std::string Claims::text() const {
    return holder_ + " " + nameOfThisProcess() + " " + std::to_string(beats_) + "\n";
}

const Claims::Seen& Claims::look(const std::string& name, int generation) {
    const std::string found = readText(folder_ / (name + kMark + std::to_string(generation)));
    const Clock::time_point now = Clock::now();
    const auto [at, isNew] = seen_.try_emplace(name, Seen{generation, found, now, now});
    Seen& seen = at->second;
    if (seen.generation != generation) seen = {generation, found, now, now};
    if (seen.text != found) {
        seen.text = found;
        seen.since = now;
    }
    return seen;
}

bool Claims::lapsed(const std::string& name, int generation) {
    const Seen& seen = look(name, generation);
    if (seen.text == kReleased || Clock::now() - seen.since >= lease_) return true;
    std::istringstream words(seen.text);
    std::string holder, process;
    words >> holder >> process;
    return hasEnded(process);
}

bool Claims::take(const std::string& name, int generation) {
    const fs::path path = folder_ / (name + kMark + std::to_string(generation));
    const std::lock_guard lock(mutex_);
    const fs::path temporary = path.parent_path() / ("." + path.stem().string() + "." + holder_);
    if (!createExclusively(path, text(), temporary)) return false;
    held_ = path;
    seen_.erase(name);
    changed_.notify_all();
    return true;
}

std::optional<std::string> Claims::claimOf(const std::vector<Work>& works, std::optional<double> patience) {
    release();
    for (const Work& work : works)
        if (!work.claim && take(work.name, 0)) return work.name;
    for (const Work& work : works)
        if (work.claim && lapsed(work.name, *work.claim) && take(work.name, *work.claim + 1))
            return work.name;
    for (const Work& work : works) {
        if (!patience || !work.claim) continue;
        const Seen& seen = look(work.name, *work.claim);
        if (Clock::now() - seen.begun >= std::chrono::duration<double>(*patience) &&
            take(work.name, *work.claim + 1))
            return work.name;
    }
    return std::nullopt;
}

std::optional<std::string> Claims::claim(const std::vector<std::string>& names,
                                         std::optional<double> patience) {
    const FolderContent content = contentOf(folder_);
    if (!content.exists)
        throw Error(ErrorKind::Failed, folder_.string() + ": cannot read: No such file or directory");
    std::vector<Work> works;
    for (const std::string& name : names) {
        const auto known = content.claims.find(name);
        works.push_back({name, known == content.claims.end() ? std::nullopt : std::optional(known->second)});
    }
    return claimOf(works, patience);
}

void Claims::release() {
    const std::lock_guard lock(mutex_);
    if (held_.empty()) return;
    const int file = ::open(held_.c_str(), O_WRONLY | O_TRUNC | O_CLOEXEC);
    if (file >= 0) {
        writeText(file, kReleased);  // if it cannot, the lease lapses
        ::close(file);
    }
    held_.clear();
}

void Claims::beat() {
    std::unique_lock lock(mutex_);
    while (!ending_) {
        changed_.wait_for(lock, lease_ / kBeatsOfLease);
        if (held_.empty() || ending_) continue;
        ++beats_;
        const int file = ::open(held_.c_str(), O_WRONLY | O_CLOEXEC);  // never made anew
        if (file < 0) continue;
        writeText(file, text());
        ::close(file);
    }
}

}  // namespace glint::farm
