// One picture drawn by the ranks of a transport: rank 0 reads the scene and hands its files on, hands out
// units, draws some itself, and gets the results; the others draw.
//
// Nothing waits for a rank that has ended. Each shows life ten times in a lease; one that did not for a whole
// lease, or that is known to have ended (farm/process_name.h), loses what it had to others, and has it back
// in time if it was only stopped. Files go from rank to rank down a tree, whose ranks r hand on to 2 r + 1
// and 2 r + 2, piece by piece, so that reading takes about as long for a thousand ranks as for two; a rank
// that misses pieces which rank 0 has published asks rank 0 for them.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/stopwatch.h"
#include "farm/bytes.h"
#include "farm/hand_out.h"
#include "farm/post.h"
#include "farm/unit_file.h"

namespace glint::farm {

// Rank 0. All members may be called from any thread; those that wait, or say so, throw what went wrong on
// another rank.
class FirstRank : private Post::Handler {
  public:
    // `lease`: seconds.
    FirstRank(Post& post, double lease);
    ~FirstRank() override;

    // The scene is to be read from these.
    std::shared_ptr<FileSource> files() { return files_; }

    // What others draw must be the same. `window`: how many units may lie between the first that settle() has
    // not been called for, and the last that is handed out.
    void begin(const UnitHeader& header, int window);

    // A unit for rank 0 to draw; nothing once all are done, or Ctrl-C was pressed. Waits,
    // and calls `waiting` now and then.
    std::optional<int> next(const std::function<void()>& waiting);
    // True if somebody else has drawn it meanwhile, or all is over.
    bool isDone(int unit);
    void put(UnitResult result);

    // Results, each unit once, in the order in which they come; nothing once all have been taken. Waits.
    std::optional<UnitResult> take();
    // The result needs no memory any more.
    void settle(int unit);

    // Of the units, those that are done.
    double share();
    // From a thread that failed: the others throw the same.
    void fail(const Error& error) override;
    void check();  // throws it

    // All ranks may go, with the exit code. Waits until they do, if all are there. Returns whether they were.
    bool end(int exitCode);

    // Ranks that are gone now: "rank 3 (node7)".
    std::vector<std::string> lost();

  private:
    struct Peer {
        std::string process, host;
        double silent = 0;
        bool lost = false;
        bool wants = false;                // asked for a unit and has not got one
        bool bye = false;                  // heard that the picture is done
        bool direct = false;               // gets the scene's pieces from here
        std::optional<UnitHeader> header;  // once it has read the scene
    };
    struct Arrived {
        std::optional<UnitResult> own;
        std::vector<uint8_t> bytes;  // another's
    };
    void receive(int from, std::vector<uint8_t> bytes) override;
    void tick(double passed) override;
    void publish(Bytes piece);
    void handle(int from, ByteReader& in);
    void greet(int from, ByteReader& in);
    void judge(int rank);
    void accept(int from, ByteReader& in);
    void finished(int unit, int by);
    void serve();  // those who want something
    void look(double passed);
    std::string called(int rank) const;
    void checkLocked() const;
    double now() const { return clock_.seconds(); }

    Post& post_;
    const double lease_;
    std::shared_ptr<RecordedFiles> files_;
    const Stopwatch clock_;

    std::mutex mutex_;  // guards what follows
    std::condition_variable changed_;
    std::vector<Peer> peers_;  // by rank
    std::vector<Bytes> pieces_;
    std::optional<UnitHeader> header_;
    std::optional<HandOut> handOut_;
    std::deque<Arrived> results_;
    int taken_ = 0;
    std::optional<Error> error_;
    double sinceBeat_ = 0, sinceLook_ = 0;
};

// Any other.
class OtherRank : private Post::Handler {
  public:
    OtherRank(Post& post, double lease);
    ~OtherRank() override;

    // Reading from these waits for rank 0, and throws Ended if that has given up.
    std::shared_ptr<FileSource> files() { return files_; }

    // The scene is read. Throws Ended.
    void begin(const UnitHeader& header);
    // A unit to draw; nothing once the picture is done. Waits. Throws Ended.
    std::optional<int> next();
    // True if the unit is not wanted any more, or all is over.
    bool isDone(int unit);
    void put(const UnitResult& result);

    // Tells rank 0, which ends all.
    void fail(const Error& error) override;

    // Waits until rank 0 lets everybody go, and goes. Returns the exit code for this process.
    int end();

    // Rank 0 said so, or is gone.
    struct Ended {};

  private:
    void receive(int from, std::vector<uint8_t> bytes) override;
    void tick(double passed) override;
    void receivePiece(const Bytes& message);
    void handle(const Bytes& message);
    void checkLocked() const;
    Bytes nextPiece();
    void send(std::vector<uint8_t> bytes);

    Post& post_;
    const double lease_;
    std::shared_ptr<ReplayedFiles> files_;

    std::mutex mutex_;  // guards what follows
    std::condition_variable changed_;
    std::deque<Bytes> pieces_;  // of the scene, not yet read
    uint32_t received_ = 0;     // pieces in all
    uint32_t published_ = 0;    // that rank 0 has said there are
    double missing_ = 0;        // seconds for which some have been missing
    double silent_ = 0;         // rank 0
    double sinceBeat_ = 0;
    std::optional<int> unit_;  // to draw
    int drawing_ = 0;          // 0: none
    bool dropped_ = false;     // `drawing_` is not wanted
    bool finished_ = false;    // the picture is
    bool ended_ = false, together_ = false, gone_ = false;
    int exitCode_ = 0;
};

}  // namespace glint::farm
