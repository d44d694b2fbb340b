// Ranks as threads, with messages that never leave the process.
#include "farm/ranks.h"

#include <algorithm>
#include <atomic>
#include <functional>
#include <memory>
#include <numeric>
#include <thread>

#include "support.h"

namespace glint::farm::test::ranks_test {
using glint::test::errorOf;

class Net {
  public:
    explicit Net(int size) : inboxes_(static_cast<size_t>(size)) {
        for (int rank = 0; rank < size; ++rank) lines_.push_back(std::make_unique<Line>(*this, rank));
    }
    Transport& line(int rank) { return *lines_[static_cast<size_t>(rank)]; }
    // Longer messages are refused.
    void limit(size_t bytes) { limit_ = bytes; }

  private:
    class Line : public Transport {
      public:
        Line(Net& net, int rank) : net_(net), rank_(rank) {}
        int rank() const override { return rank_; }
        int size() const override { return static_cast<int>(net_.inboxes_.size()); }
        void send(int to, const Bytes& bytes) override {
            if (bytes.size() > net_.limit_) throw Error(ErrorKind::Failed, "too long a message");
            const std::lock_guard lock(net_.mutex_);
            net_.inboxes_[static_cast<size_t>(to)].push_back({rank_, bytes});
        }
        std::optional<Message> receive() override {
            const std::lock_guard lock(net_.mutex_);
            auto& inbox = net_.inboxes_[static_cast<size_t>(rank_)];
            if (inbox.empty()) return std::nullopt;
            Message message = std::move(inbox.front());
            inbox.pop_front();
            return message;
        }
        bool sending() override { return false; }
        void finish() override {}
        void abort(int) override {}

      private:
        Net& net_;
        int rank_;
    };
    std::mutex mutex_;
    std::vector<std::deque<Transport::Message>> inboxes_;
    std::vector<std::unique_ptr<Line>> lines_;
    size_t limit_ = SIZE_MAX;
};

class Ranks : public glint::test::WorkingFolderTest {
  protected:
    static UnitHeader header(int units, const std::string& scene = "a") {
        return {{{{"scene", scene}}}, {0, 0, 8, 8 * units}, {Aov::Radiance}, units};
    }
    static UnitResult resultOf(int unit, int rank) {
        UnitResult result;
        result.part = unit;
        result.producer = {"rank " + std::to_string(rank), "", true};
        result.blocks.push_back(
            {{0, 8 * (unit - 1), 8, 8 * unit}, Image(8, 8, 4, static_cast<float>(unit)), {}});
        return result;
    }

    using Work = std::function<void(int unit)>;

    std::jthread other(Net& net, int rank, Work work, std::string scene = "a") {
        return std::jthread([this, &net, rank, work = std::move(work), scene = std::move(scene)] {
            OtherRank mine(net.line(rank));
            try {
                if (wantsScene_) read_ += mine.files()->read("scene", {}).size();
                mine.begin(header(units_, scene));
                while (const auto unit = mine.next()) {
                    work(*unit);
                    mine.put(resultOf(*unit, rank));
                }
            } catch (const Error& error) {
                mine.fail(error);
            }
        });
    }

    // Renders as rank 0 until all is there or something failed, and lets the others go. Units as they came.
    std::vector<int> first(Net& net, int window = 1000) {
        std::vector<int> came;
        FirstRank ranks(net.line(0));
        try {
            if (wantsScene_) ranks.files()->read("scene", {});
            ranks.begin(header(units_), window,
                        [&](const UnitResult& result) { came.push_back(result.part); });
            while (const auto unit = ranks.next([] {})) ranks.put(resultOf(*unit, 0));
        } catch (const Error&) {
            ranks.end();
            throw;
        }
        ranks.end();
        return came;
    }
    // Rank 0 renders nothing and waits for another rank's error.
    std::string errorOfOthers(Net& net, ErrorKind kind) {
        return errorOf(kind, [&] {
            FirstRank ranks(net.line(0));
            ranks.begin(header(units_), units_, [](const UnitResult&) {});
            while (!ranks.failed()) std::this_thread::yield();
            ranks.end();
            ranks.next([] {});
        });
    }
    std::vector<int> all() const {
        std::vector<int> numbers(static_cast<size_t>(units_));
        std::iota(numbers.begin(), numbers.end(), 1);
        return numbers;
    }

    int units_ = 40;
    bool wantsScene_ = false;
    std::atomic<size_t> read_{0};
};

void draw(int) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

TEST_F(Ranks, EachUnitComesOnce) {
    Net net(4);
    std::vector<std::jthread> threads;
    for (int rank = 1; rank < 4; ++rank) threads.push_back(other(net, rank, draw));
    std::vector<int> came = first(net);
    std::sort(came.begin(), came.end());
    EXPECT_EQ(came, all());
}

TEST_F(Ranks, TheSceneReachesAllRanksOfTheTree) {
    glint::test::writeText("scene", std::string(3'000'000, 'x'));
    wantsScene_ = true;
    Net net(7);
    std::vector<std::jthread> threads;
    for (int rank = 1; rank < 7; ++rank) threads.push_back(other(net, rank, draw));
    first(net);
    threads.clear();  // waits for them
    EXPECT_EQ(read_, 6 * 3'000'000u);
}

// With a window of one unit, each unit is handed out only after the one before it.
TEST_F(Ranks, TheWindowKeepsUnitsInOrder) {
    Net net(3);
    const std::jthread a = other(net, 1, draw), b = other(net, 2, draw);
    EXPECT_EQ(first(net, 1), all());
}

// As in MPI, which counts bytes by an int.
TEST_F(Ranks, AMessageThatCannotBeSentIsAnError) {
    Net net(2);
    net.limit(900);  // less than a unit
    const std::jthread draws = other(net, 1, draw);
    const std::string said = errorOfOthers(net, ErrorKind::Failed);
    EXPECT_TRUE(said.starts_with("rank 1 (") && said.ends_with("): too long a message")) << said;
}

TEST_F(Ranks, AnErrorOfARankKeepsItsKind) {
    Net net(3);
    const std::jthread fails = other(net, 1, [](int) { throw Error(ErrorKind::Device, "no device"); });
    const std::jthread draws = other(net, 2, draw);
    const std::string said = errorOfOthers(net, ErrorKind::Device);
    EXPECT_TRUE(said.starts_with("rank 1 (") && said.ends_with("): no device")) << said;
}

TEST_F(Ranks, AnotherImageIsRefused) {
    Net net(2);
    const std::jthread thread = other(net, 1, draw, "b");
    EXPECT_EQ(errorOfOthers(net, ErrorKind::Failed),
              "rank 1 would render another image: scene is b there and a here");
}

}  // namespace glint::farm::test::ranks_test
