// The display for a waiting person, by time; the clock is the test's own.
#include "core/progress.h"

#include <atomic>
#include <limits>
#include <sstream>
#include <thread>

#include "support/support.h"

namespace glint::progress_test {
class ProgressTest : public ::testing::Test {
  protected:
    Progress::Clock clock() {
        return [this] { return now_.load(); };
    }

    // What has been written since the last call.
    std::string output() {
        const std::string text = sink_.str();
        sink_.str("");
        return text;
    }

    // The text that an update to `part` writes, so many seconds after 100.
    std::string shown(Progress& progress, double seconds, double part) {
        now_ = 100 + seconds;
        progress.update(part);
        return output();
    }

    std::atomic<double> now_{100.0};
    std::ostringstream sink_;
};

TEST_F(ProgressTest, BarShowsPartAndTimes) {
    Progress progress("render", ProgressMode::Bar, sink_, false, clock());
    // 9.4 of 20 marks; 12 s * 0.53 / 0.47 = 13.5 s left
    EXPECT_EQ(shown(progress, 12, 0.47), "\rrender  [#########-----------]  47 %  0:12 elapsed, 0:14 left");
}

TEST_F(ProgressTest, NothingInTheFirstSecond) {
    for (ProgressMode mode : {ProgressMode::Bar, ProgressMode::Plain}) {
        now_ = 100.0;
        Progress progress("render", mode, sink_, true, clock());
        output();  // where the bar before has been cleared
        EXPECT_EQ(shown(progress, 0.99, 0.9), "");
        EXPECT_NE(shown(progress, 1.01, 0.9), "");
    }
}

TEST_F(ProgressTest, BarIsRedrawnTenTimesASecondAtMost) {
    Progress progress("render", ProgressMode::Bar, sink_, true, clock());
    int draws = 0;
    for (int i = 0; i < 1000; ++i) {  // from 102 s to 103 s
        now_ = 102.0 + i / 1000.0;
        progress.update(i / 1000.0);
        draws += output().empty() ? 0 : 1;
    }
    EXPECT_GE(draws, 9);
    EXPECT_LE(draws, 10);
}

TEST_F(ProgressTest, FinishClearsTheBar) {
    Progress progress("render", ProgressMode::Bar, sink_, true, clock());
    const size_t length = shown(progress, 10, 0.5).size() - 1;  // without \r
    progress.finish();
    EXPECT_EQ(output(), std::string("\r").append(length, ' ') + "\r");
    now_ = 120.0;
    progress.update(0.6);
    progress.finish();
    EXPECT_EQ(output(), "");
}

TEST_F(ProgressTest, ShorterLinesCoverLongerOnes) {
    Progress progress("render", ProgressMode::Bar, sink_, true, clock());
    // 10 s * 0.998 / 0.002 = 4990 s = 1:23:10
    const std::string longLine = shown(progress, 10, 0.002);
    EXPECT_HAS(longLine, "0:10 elapsed, 1:23:10 left");
    const std::string shortLine = shown(progress, 11, 0.5);
    EXPECT_EQ(shortLine.size(), longLine.size());
    EXPECT_ENDS(shortLine, "0:11 left   ");
}

TEST_F(ProgressTest, NoEstimateWithoutProgress) {
    Progress progress("build", ProgressMode::Bar, sink_, true, clock());
    EXPECT_EQ(shown(progress, 61, 0.0), "\rbuild  [--------------------]   0 %  1:01 elapsed");
}

TEST_F(ProgressTest, NeverGoesBackAndStaysInItsRange) {
    Progress progress("render", ProgressMode::Bar, sink_, true, clock());
    EXPECT_HAS(shown(progress, 10, 0.5), " 50 %");
    EXPECT_HAS(shown(progress, 11, 0.25), " 50 %");
    EXPECT_HAS(shown(progress, 12, std::numeric_limits<double>::quiet_NaN()), " 50 %");
    EXPECT_EQ(shown(progress, 13, 7.0), "\rrender  [####################]  100 %  0:13 elapsed, 0:00 left");
}

TEST_F(ProgressTest, PlainLinesEveryTwoSecondsOrTenPercent) {
    Progress progress("render", ProgressMode::Plain, sink_, false, clock());
    EXPECT_EQ(shown(progress, 2, 0.02),
              "render   2 %  0:02 elapsed, 1:38 left\n");  // 2 s * 0.98 / 0.02 = 98 s
    EXPECT_EQ(shown(progress, 3, 0.05), "");
    EXPECT_EQ(shown(progress, 4, 0.08), "render   8 %  0:04 elapsed, 0:46 left\n");  // 4 s * 0.92 / 0.08
    EXPECT_EQ(shown(progress, 4.5, 0.125),
              "render  12 %  0:04 elapsed, 0:32 left\n");  // 4.5 s * 0.875 / 0.125 = 31.5 s
    EXPECT_EQ(shown(progress, 5, 0.15), "");
    progress.finish();
    EXPECT_EQ(output(), "");
}

TEST_F(ProgressTest, AutoIsABarOnATerminalOnly) {
    for (bool terminal : {true, false}) {
        now_ = 100.0;
        Progress progress("render", ProgressMode::Auto, sink_, terminal, clock());
        EXPECT_EQ(shown(progress, 10, 0.5).starts_with("\rrender  [###"), terminal);
    }
}

TEST_F(ProgressTest, ShortComputationsAndNoneLeaveNoTrace) {
    for (const auto& [mode, seconds] : {std::pair{ProgressMode::Bar, 0.5}, {ProgressMode::None, 10.0}}) {
        {
            now_ = 100.0;
            Progress progress("render", mode, sink_, true, clock());
            EXPECT_EQ(shown(progress, seconds, 1.0), "");
        }
        EXPECT_EQ(output(), "") << "at its end";
    }
}

TEST_F(ProgressTest, UpdatesFromManyThreadsGiveWholeLines) {
    Progress progress("render", ProgressMode::Plain, sink_, false, clock());
    const auto work = [&] {
        for (int i = 0; i < 1000; ++i) {
            now_ = now_ + 0.05;
            progress.update(i / 1000.0);
        }
    };
    {
        std::vector<std::jthread> threads;
        for (int i = 0; i < 4; ++i) threads.emplace_back(work);
    }
    std::istringstream lines(output());
    std::string line;
    int count = 0;
    int last = 0;
    while (std::getline(lines, line)) {
        int percentage = -1;
        ASSERT_EQ(std::sscanf(line.c_str(), "render %d %%", &percentage), 1) << line;
        ASSERT_TRUE(line.ends_with(" left") || line.ends_with(" elapsed")) << line;
        ASSERT_GE(percentage, last);
        last = percentage;
        ++count;
    }
    EXPECT_GT(count, 5);
}

}  // namespace glint::progress_test
