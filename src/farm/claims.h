// Work shared out by a folder that several machines see: who does what, and what becomes of it if he dies.
//
// Work has names. Whoever makes the file NAME.claim-0, which only one can, has the work called NAME, and from
// then on changes a number in that file every second or so. Whoever sees that the file stays as it is for the
// whole of a lease, by his own clock, may make NAME.claim-1 and has the work; and so on. So no clocks are
// compared, nothing is locked, and nothing is ever renamed or removed that another may be looking at. If the
// first one was only slow, the work is done twice, to the same bits.
#pragma once

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace glint::farm {

// A name that no other has: host, process, and 64 random bits, as containers on one host may have the name of
// the host and the numbers of processes in common. Fit for a file's name.
std::string newHolder();

// What stands in a folder of work.
struct FolderContent {
    bool exists = false;
    std::map<std::string, int> claims;  // of each work the number of its newest claim
    std::vector<std::string> others;    // files that are no claims
};
// Throws Error(Failed) if it cannot be read.
FolderContent contentOf(const std::filesystem::path& folder);

// Some work, and the number of its newest claim, if somebody has claimed it.
struct Work {
    std::string name;
    std::optional<int> claim;
};

class Claims {
  public:
    using Clock = std::chrono::steady_clock;

    // The folder must be there. `lease`: seconds; a holder writes ten times in it.
    Claims(const std::filesystem::path& folder, double lease);
    ~Claims();  // gives back what is held

    // Tries to get one of `works`, none of which is done, and whose names may lie in folders below: the first
    // that nobody has, else the first whose
    // holder has given it back or shown no life for a lease that this object has seen pass. Nothing if all
    // are held. Of those the first whose newest claim this object has seen for `patience` seconds, if that is
    // given: its holder lives, but is slow, and the work may be done twice. A holder on this host that has
    // ended is known to have without waiting. Throws Error(Failed) if the folder cannot be written.
    std::optional<std::string> claimOf(const std::vector<Work>& works,
                                       std::optional<double> patience = std::nullopt);
    // The same with a look at the folder.
    std::optional<std::string> claim(const std::vector<std::string>& names,
                                     std::optional<double> patience = std::nullopt);

    // The work that is held is done, or given up: another may have it at once.
    void release();

  private:
    struct Seen {
        int generation = 0;
        std::string text;
        Clock::time_point since, begun;  // it has had this text, and been there at all
    };
    const Seen& look(const std::string& name, int generation);
    bool lapsed(const std::string& name, int generation);
    bool take(const std::string& name, int generation);
    void beat();
    std::string text() const;

    const std::filesystem::path folder_;
    const Clock::duration lease_;
    const std::string holder_;
    std::map<std::string, Seen> seen_;  // of the newest claim on work that another has

    std::mutex mutex_;  // guards what follows
    std::condition_variable changed_;
    std::filesystem::path held_;  // the claim; empty: none
    uint64_t beats_ = 0;
    bool ending_ = false;
    std::thread thread_;
};

}  // namespace glint::farm
