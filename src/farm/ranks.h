// One image rendered by the ranks of a transport. Rank 0 reads the scene's files and passes them on, hands
// out units, renders units itself and takes all results; the other ranks render.
//
// The files go down a binary tree: rank r passes each piece on to 2 r + 1 and 2 r + 2. A rank that fails
// sends the error to rank 0 and waits; rank 0 fails with it, and the caller then ends all processes.
#pragma once

#include <atomic>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "core/error.h"
#include "farm/scene_stream.h"
#include "farm/transport.h"
#include "farm/unit_file.h"

namespace glint::farm {

class ByteReader;

// Rank 0. Functions that wait return early after Ctrl-C.
class FirstRank {
  public:
    // Gets each unit's result once, in any order, one call at a time, from two threads.
    using Take = std::function<void(const UnitResult&)>;

    explicit FirstRank(Transport& transport);
    ~FirstRank();
    FirstRank(const FirstRank&) = delete;
    FirstRank& operator=(const FirstRank&) = delete;

    // Reading the scene from these publishes it.
    std::shared_ptr<FileSource> files() { return files_; }

    // Starts a thread that serves the others. A unit is handed out only if fewer than `window` units lie
    // between it and the first one that is missing.
    void begin(const UnitHeader& header, int window, Take take);

    // Waits for a unit that rank 0 is to render, and calls `waiting` every 50 ms; nothing once all units are
    // there. Throws the error of any rank.
    std::optional<int> next(const std::function<void()>& waiting);
    void put(const UnitResult& result);

    // True once any rank has failed.
    bool failed() const { return failed_; }
    // Share of the units that are there.
    double share() const { return static_cast<double>(done_) / header_->parts; }

    // Lets the others go, once all of them have read the scene, or at once if one has failed.
    void end();

  private:
    void publish(const Bytes& piece);
    void serve();
    bool receive();
    void handle(int from, ByteReader& in);
    void judge(int from, const UnitHeader& header);
    void accept(const UnitResult& result);
    std::optional<int> take();
    void handOut();
    void fail(const Error& error);

    Transport& transport_;
    std::shared_ptr<RecordedFiles> files_;
    std::thread thread_;
    std::atomic<bool> stopping_{false}, failed_{false};
    std::atomic<int> done_{0};

    std::mutex mutex_;  // guards the transport and the members below
    std::optional<UnitHeader> header_;
    std::vector<std::pair<int, UnitHeader>> early_;  // from ranks that had read the scene before rank 0
    int ready_ = 0;                                  // ranks that have read the scene
    Take take_;
    int window_ = 1, next_ = 1, firstMissing_ = 1;
    std::vector<bool> there_;  // by unit
    std::deque<int> idle_;     // ranks without a unit
    std::optional<Error> error_;
};

// Any other rank, used by one thread.
class OtherRank {
  public:
    explicit OtherRank(Transport& transport);

    // Reading from these waits for rank 0.
    std::shared_ptr<FileSource> files() { return files_; }

    // The scene has been read.
    void begin(const UnitHeader& header);
    // Waits for a unit; nothing once rank 0 needs no more, or after Ctrl-C.
    std::optional<int> next();
    void put(const UnitResult& result);
    // Sends the error to rank 0, and waits until rank 0 lets this rank go or ends the process.
    void fail(const Error& error);

  private:
    Bytes nextPiece();

    Transport& transport_;
    std::shared_ptr<ReplayedFiles> files_;
    bool ended_ = false;  // rank 0 has sent Word::End
};

}  // namespace glint::farm
