// When work that takes long tells how far it is, by a clock of the test's.

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <vector>

#include "engines/long_work.h"
#include "formats/progress_pace.h"

namespace nuno {
namespace {

using namespace std::chrono_literals;

/// The seconds of its work at which a line is due, of one that would tell one each second.
std::vector<int> seconds_told(ProgressPace& pace, ProgressPace::Time begun, int seconds) {
  std::vector<int> told;
  for (int second = 0; second <= seconds; ++second) {
    if (pace.is_due(begun + std::chrono::seconds(second))) told.push_back(second);
  }
  return told;
}

TEST(ProgressPace, TellsAfterTenSecondsAndThenEveryHalfMinute) {
  ProgressPace pace;
  const std::vector<int> wanted = {10, 40, 70, 100};
  EXPECT_EQ(seconds_told(pace, ProgressPace::Time(1h), 129), wanted);
  pace.end();  // the next work is told of as if it were the first
  EXPECT_EQ(seconds_told(pace, ProgressPace::Time(1h + 130s), 129), wanted);
}

TEST(ProgressPace, TellsOneLineForWorkThatIsSilentLong) {
  ProgressPace pace;
  const ProgressPace::Time begun(1h);
  EXPECT_FALSE(pace.is_due(begun));
  EXPECT_TRUE(pace.is_due(begun + 100s));
  EXPECT_FALSE(pace.is_due(begun + 129s));
  EXPECT_TRUE(pace.is_due(begun + 130s));
}

/// What is told of work that takes `seconds` in all.
std::vector<std::string> told_of(std::chrono::seconds seconds) {
  std::vector<std::string> lines;
  std::chrono::seconds now = 0s;
  tell_of_long_work(
      "flag: this takes about 90 s", "flag", 89.6,
      [&](std::chrono::seconds time) {
        now += time;
        return now < seconds;
      },
      [&](const std::string& line) { lines.push_back(line); });
  return lines;
}

TEST(LongWork, TellsWhatItWillTakeAndThenEveryHalfMinuteWhatItHas) {
  EXPECT_EQ(told_of(2s), std::vector<std::string>()) << "it ended at once";
  const std::vector<std::string> wanted = {"flag: this takes about 90 s", "flag: 32 s of about 90",
                                           "flag: 62 s of about 90", "flag: 92 s of about 90"};
  EXPECT_EQ(told_of(32s), std::vector(wanted.begin(), wanted.begin() + 1));
  EXPECT_EQ(told_of(33s), std::vector(wanted.begin(), wanted.begin() + 2));
  EXPECT_EQ(told_of(100s), wanted) << "an estimate that was too low is no reason to be silent";
}

}  // namespace
}  // namespace nuno
