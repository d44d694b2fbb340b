// Ranks as threads, with messages that never leave the process: what dies, hangs and comes back.
#include "farm/ranks.h"

#include <atomic>
#include <functional>
#include <memory>
#include <set>
#include <thread>

#include "support.h"

namespace glint::farm::test::ranks_test {
namespace {

using namespace std::chrono_literals;
using glint::test::errorOf;

constexpr double kLease = 0.5;

// A rank that is cut off neither hears nor is heard, as if its machine had gone.
class Net {
  public:
    explicit Net(int size) : inboxes_(static_cast<size_t>(size)), cutOff_(static_cast<size_t>(size)) {}
    Post::Open open(int rank) {
        return [this, rank] { return std::make_unique<Line>(*this, rank); };
    }
    // Longer messages are refused.
    void limit(size_t bytes) { limit_ = bytes; }
    void cutOff(int rank, bool cut = true) { cutOff_[static_cast<size_t>(rank)] = cut; }

  private:
    class Line : public Transport {
      public:
        Line(Net& net, int rank) : net_(net), rank_(rank) {}
        int rank() const override { return rank_; }
        int size() const override { return static_cast<int>(net_.inboxes_.size()); }
        void send(int to, const std::vector<uint8_t>& bytes) override {
            if (net_.cutOff_[static_cast<size_t>(rank_)] || net_.cutOff_[static_cast<size_t>(to)]) return;
            if (bytes.size() > net_.limit_) throw Error(ErrorKind::Failed, "too long a message");
            const std::lock_guard lock(net_.mutex_);
            net_.inboxes_[static_cast<size_t>(to)].push_back({rank_, bytes});
        }
        std::optional<Message> receive() override {
            const std::lock_guard lock(net_.mutex_);
            auto& inbox = net_.inboxes_[static_cast<size_t>(rank_)];
            if (inbox.empty() || net_.cutOff_[static_cast<size_t>(rank_)]) return std::nullopt;
            Message message = std::move(inbox.front());
            inbox.pop_front();
            return message;
        }
        int pending() const override { return 0; }
        void leave(bool) override {}

      private:
        Net& net_;
        int rank_;
    };
    std::mutex mutex_;
    std::vector<std::deque<Transport::Message>> inboxes_;
    std::vector<std::atomic<bool>> cutOff_;
    size_t limit_ = SIZE_MAX;
};

class Ranks : public glint::test::WorkingFolderTest {
  protected:
    static UnitHeader header(int units, const std::string& scene = "a") {
        return {{{{"scene", scene}}}, {0, 0, 8, 8 * units}, {Aov::Radiance}, units};
    }
    static UnitResult resultOf(int unit, int units, int rank) {
        UnitResult result;
        result.unit = {0, unit, units};
        result.producer = {"rank " + std::to_string(rank), "", true};
        result.blocks.push_back(
            {{0, 8 * (unit - 1), 8, 8 * unit}, Image(8, 8, 4, static_cast<float>(unit)), {}});
        return result;
    }

    // What a rank does with a unit; false: it never comes back.
    using Work = std::function<bool(int unit)>;

    // Another rank's thread.
    std::thread other(Net& net, int rank, Work work, std::string scene = "a") {
        return std::thread([this, &net, rank, work = std::move(work), scene = std::move(scene)] {
            Post post(net.open(rank));
            OtherRank mine(post, kLease);
            try {
                if (wantsScene_) mine.files()->read("scene");
                mine.begin(header(units_, scene));
                while (const auto unit = mine.next()) {
                    ++begun_;
                    if (!work(*unit)) break;
                    if (!mine.isDone(*unit)) mine.put(resultOf(*unit, units_, rank));
                }
            } catch (const OtherRank::Ended&) {
                ++ended_;
            } catch (const Error& error) {
                mine.fail(error);
            }
            codes_ += mine.end();
        });
    }

    // Rank 0, which draws nothing itself unless `draws`. The numbers of the units as they came.
    std::vector<int> first(FirstRank& ranks, bool draws = false) {
        ranks.begin(header(units_), units_);
        std::thread drawer([&] {
            try {
                while (draws) {
                    const auto unit = ranks.next([] {});
                    if (!unit) break;
                    ranks.put(resultOf(*unit, units_, 0));
                }
            } catch (const Error&) {
            }
        });
        std::vector<int> came;
        std::exception_ptr error;
        try {
            while (const auto result = ranks.take()) {
                came.push_back(result->unit.part);
                ranks.settle(result->unit.part);
            }
        } catch (...) {
            error = std::current_exception();
        }
        drawer.join();
        if (error) std::rethrow_exception(error);
        std::sort(came.begin(), came.end());
        return came;
    }
    std::vector<int> all() const {
        std::vector<int> numbers;
        for (int unit = 1; unit <= units_; ++unit) numbers.push_back(unit);
        return numbers;
    }

    int units_ = 12;
    bool wantsScene_ = false;
    std::atomic<int> begun_{0}, ended_{0}, codes_{0};
};

bool draw(int) {
    std::this_thread::sleep_for(3ms);
    return true;
}

TEST_F(Ranks, EachUnitComesOnce) {
    Net net(4);
    std::vector<std::thread> threads;
    for (int rank = 1; rank < 4; ++rank) threads.push_back(other(net, rank, draw));
    Post post(net.open(0));
    FirstRank ranks(post, kLease);
    EXPECT_EQ(first(ranks, true), all());
    EXPECT_TRUE(ranks.lost().empty());
    EXPECT_TRUE(ranks.end(0));
    for (auto& thread : threads) thread.join();
    EXPECT_EQ(codes_, 0);
}

TEST_F(Ranks, UnitsOfTheDeadAreDrawnByOthers) {
    Net net(3);
    std::thread victim = other(net, 1, [&](int) {
        net.cutOff(1);
        return true;
    });
    // The others do not finish before it has got a unit.
    const auto wait = [&](int unit) {
        const Stopwatch watch;
        while (begun_ < 2 && watch.seconds() < 10) std::this_thread::sleep_for(1ms);
        return draw(unit);
    };
    std::thread survivor = other(net, 2, wait);
    Post post(net.open(0));
    FirstRank ranks(post, kLease);
    EXPECT_EQ(first(ranks), all());
    EXPECT_FALSE(ranks.end(0));
    EXPECT_EQ(ranks.lost().size(), 1u);
    survivor.join();
    victim.join();
    EXPECT_EQ(codes_, 1);  // the victim's, for which rank 0 is gone
}

TEST_F(Ranks, WhoComesBackIsWelcome) {
    Net net(2);
    std::atomic<int> drawn{0};
    std::thread sleeper = other(net, 1, [&](int) {
        if (drawn++ > 0) return true;
        net.cutOff(1);
        std::this_thread::sleep_for(std::chrono::duration<double>(1.5 * kLease));
        net.cutOff(1, false);
        return true;
    });
    Post post(net.open(0));
    FirstRank ranks(post, kLease);
    std::atomic<bool> over{false}, seenLost{false};
    std::thread watcher([&] {
        for (; !over; std::this_thread::sleep_for(1ms)) seenLost = seenLost || !ranks.lost().empty();
    });
    EXPECT_EQ(first(ranks), all());
    over = true;
    watcher.join();
    EXPECT_TRUE(seenLost);
    EXPECT_TRUE(ranks.lost().empty());
    EXPECT_TRUE(ranks.end(0));
    sleeper.join();
    EXPECT_EQ(codes_, 0);
}

// Of seven, the one that hands the scene on to two others is dead from the start.
TEST_F(Ranks, TheSceneComesRoundTheDead) {
    glint::test::writeText("scene", std::string(3'000'000, 'x'));
    wantsScene_ = true;
    Net net(7);
    net.cutOff(1);
    // Each has one unit at a time, so that five are begun when all five ranks have read the scene.
    std::atomic<bool> late{false};
    const auto waitForAll = [&](int) {
        const Stopwatch watch;
        while (begun_ < 5 && !late) {
            std::this_thread::sleep_for(1ms);
            late = watch.seconds() > 10;
        }
        return true;
    };
    std::vector<std::thread> threads;
    for (int rank = 1; rank < 7; ++rank) threads.push_back(other(net, rank, waitForAll));
    Post post(net.open(0));
    FirstRank ranks(post, kLease);
    ranks.files()->read("scene");
    ranks.begin(header(units_), units_);
    std::set<std::string> drew;
    for (int count = 0; count < units_; ++count) {
        const auto result = ranks.take();  // rank 0 draws nothing
        drew.insert(result->producer.device);
        ranks.settle(result->unit.part);
    }
    EXPECT_FALSE(late);
    EXPECT_FALSE(drew.contains("rank 1"));
    EXPECT_FALSE(ranks.end(0));
    for (auto& thread : threads) thread.join();
    EXPECT_EQ(ended_, 1);  // rank 1, for which rank 0 is dead
    EXPECT_EQ(codes_, 1);
}

// As of MPI, which counts bytes by an int.
TEST_F(Ranks, AMessageThatCannotBeSentIsAnError) {
    Net net(2);
    net.limit(900);  // less than a unit
    std::thread draws = other(net, 1, draw);
    Post post(net.open(0));
    FirstRank ranks(post, kLease);
    const std::string said = errorOf(ErrorKind::Failed, [&] { first(ranks); });
    EXPECT_TRUE(said.starts_with("rank 1 (") && said.ends_with("): too long a message")) << said;
    ranks.end(1);
    draws.join();
    EXPECT_EQ(codes_, 1);
}

TEST_F(Ranks, AnErrorEndsAllWithItsKind) {
    Net net(3);
    units_ = 1000;
    std::thread fails = other(net, 1, [](int) -> bool { throw Error(ErrorKind::Device, "no device"); });
    std::thread draws = other(net, 2, draw);
    Post post(net.open(0));
    FirstRank ranks(post, kLease);
    const std::string said = errorOf(ErrorKind::Device, [&] { first(ranks); });
    EXPECT_TRUE(said.starts_with("rank 1 (")) << said;
    EXPECT_TRUE(said.ends_with("): no device")) << said;
    ranks.end(4);
    fails.join();
    draws.join();
    EXPECT_EQ(codes_, 8);
}

TEST_F(Ranks, AnotherPictureIsRefused) {
    Net net(2);
    std::thread thread = other(net, 1, draw, "b");
    Post post(net.open(0));
    FirstRank ranks(post, kLease);
    const std::string said = errorOf(ErrorKind::Failed, [&] { first(ranks); });
    EXPECT_TRUE(said.ends_with("would draw another picture: scene is b there and a here")) << said;
    ranks.end(1);
    thread.join();
}

TEST_F(Ranks, TheOthersEndWithoutRankZero) {
    Net net(2);
    std::thread thread = other(net, 1, draw);
    thread.join();
    EXPECT_EQ(codes_, 1);
}

}  // namespace
}  // namespace glint::farm::test::ranks_test
