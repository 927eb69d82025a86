// SPDX-License-Identifier: Apache-2.0
// bench, as a user types it. How fast anything is depends on the machine and is not tested here.
#include <sched.h>

#include <algorithm>
#include <set>

#include "tests/end_to_end/program.hpp"

namespace fathom::test {
namespace {

/// A metric that is fast to time, on the backend that has threads.
const std::string kCpu = "bench --backend cpu --metric walsh-sequency:8 --json";

int processors() {
  cpu_set_t set;
  return sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 1;
}

class Bench : public Program {
 protected:
  /// The rows' threads, in the order of the rows.
  std::vector<int> threads_of(const std::string& arguments, const std::string& prefix = "") {
    const Outcome outcome = fathom(arguments, prefix);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    std::vector<int> threads;
    for (const auto& row : outcome.lines()) {
      EXPECT_EQ(row.at("backend"), "cpu");
      EXPECT_GT(row.at("us_per_window"), 0);
      threads.push_back(row.at("threads"));
    }
    return threads;
  }
};

TEST_F(Bench, ARowHasTheKeysOfTheInterface) {
  const Outcome outcome =
      fathom("bench --metric walsh-sequency:8 --backend reference --batch 2 --json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto rows = outcome.lines();
  ASSERT_EQ(rows.size(), 1u);  // `reference` has one thread, however many there are
  const auto& row = rows[0];
  EXPECT_EQ(row.size(), 13u);
  EXPECT_EQ(row.at("backend"), "reference");
  EXPECT_EQ(row.at("metric"), "walsh-sequency:8");
  EXPECT_EQ(row.at("batch"), 2);
  EXPECT_EQ(row.at("threads"), 1);
  EXPECT_TRUE(row.at("device").is_string());
  const double us = row.at("us_per_window");
  EXPECT_GT(us, 0);
  EXPECT_DOUBLE_EQ(row.at("windows_per_s"), 1e6 / us);
  EXPECT_GT(row.at("min_us"), 0);
  EXPECT_LE(row.at("min_us"), us);
  EXPECT_GE(row.at("max_us"), us);
  EXPECT_LE(row.at("min_us"), row.at("lower_quartile_us"));
  EXPECT_LE(row.at("lower_quartile_us"), us);
  EXPECT_GE(row.at("upper_quartile_us"), us);
  EXPECT_LE(row.at("upper_quartile_us"), row.at("max_us"));
  EXPECT_DOUBLE_EQ(row.at("gigabytes_per_s"), 64 / us / 1000);
  EXPECT_GT(row.at("processor_share"), 0);
  EXPECT_LE(row.at("processor_share"), 1);
}

TEST_F(Bench, OnlyOneThreadThatNeverWaitsTellsOfABusyMachine) {
  for (const auto& row : fathom(kCpu + " --batch 64 --threads 1,2").lines()) {
    EXPECT_EQ(row.at("processor_share").is_null(), row.at("threads") == 2) << row;
  }
}

TEST_F(Bench, OptionsSelectRows) {
  std::set<std::string> rows;
  const std::string arguments =
      "bench --metric fft:8 --metric walsh-paley:8:hann --backend reference --batch 1,3 --batch 4";
  for (const auto& row : fathom(arguments + " --depth 16 --json").lines()) {
    rows.insert(row.at("metric").get<std::string>() + " " + row.at("batch").dump());
  }
  EXPECT_EQ(rows, (std::set<std::string>{"fft:8:hann 1", "fft:8:hann 3", "fft:8:hann 4",
                                         "walsh-paley:8:hann 1", "walsh-paley:8:hann 3",
                                         "walsh-paley:8:hann 4"}));
}

TEST_F(Bench, TheTableComparesWithTheThesisWhereItCan) {
  const Outcome outcome =
      fathom("bench --metric walsh-paley:8 --metric walsh-paley:64 --backend reference --batch 1");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  std::istringstream lines(outcome.out);
  int rows = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("walsh-paley:", 0) != 0) continue;
    ++rows;
    EXPECT_EQ(line.back() == '-', line.rfind("walsh-paley:8 ", 0) == 0) << line;
  }
  EXPECT_EQ(rows, 2);
  EXPECT_NE(outcome.out.find("17 s (Walsh)"), std::string::npos);
}

TEST_F(Bench, WhatItCannotTimeIsRefused) {
  expect_refusal("bench --backend abacus", 1, {"abacus", "reference"});
  expect_refusal("bench --metric dst", 2, {"dst", "walsh-sequency"});
  expect_refusal("bench --metric fft:9", 2, {"9", "power of two"});
  expect_refusal("bench --batch 0", 2, {"--batch"});
  expect_refusal("bench --threads 0", 2, {"--threads"});
  expect_refusal("bench --depth 12", 2, {"--depth", "12"});
}

TEST_F(Bench, ThreadsAreThoseThatCompute) {
  EXPECT_EQ(threads_of(kCpu + " --batch 64 --threads 1"), std::vector<int>{1});
  EXPECT_EQ(threads_of(kCpu + " --batch 64 --threads 7"), std::vector{std::min(7, processors())});
  EXPECT_EQ(threads_of(kCpu + " --batch 64 --threads 1,7").size(), processors() > 1 ? 2U : 1U);
  const std::string variable = "FATHOM_THREADS=7";
  EXPECT_EQ(threads_of(kCpu + " --batch 64", variable).back(), std::min(7, processors()));
}

TEST_F(Bench, ThreadsAreThoseOfTheProcessorsThatTheProcessMayUse) {
  const std::string one = "taskset -c " + std::to_string(sched_getcpu());
  ASSERT_EQ(std::system((one + " true").c_str()), 0) << "taskset is part of util-linux";
  EXPECT_EQ(threads_of(kCpu + " --batch 64", one), std::vector<int>{1}) << "one row, for both";
  EXPECT_EQ(threads_of(kCpu + " --batch 64 --threads 2", one), std::vector<int>{1});
}

TEST_F(Bench, NumberOfThreadsThatIsNoneIsRefusedBeforeTheFirstRow) {
  for (const char* threads : {"3x", "0", "2000", "many"}) {
    for (const char* format : {"", " --json"}) {
      const Outcome outcome = fathom(std::string("bench --backend cpu") + format,
                                     std::string("FATHOM_THREADS=") + threads);
      EXPECT_EQ(outcome.status, 2);
      EXPECT_EQ(outcome.out, "");
      EXPECT_NE(outcome.err.find(std::string("FATHOM_THREADS is \"") + threads), std::string::npos)
          << outcome.err;
    }
  }
  const Outcome outcome = fathom(kCpu + " --threads 1,2000");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.out, "");
}

TEST_F(Bench, EveryTimeOfTheThesisHasItsCounterpart) {
  const Outcome outcome = fathom("bench --thesis --json --backend cpu");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  std::vector<std::pair<double, double>> thesis;
  for (const auto& row : outcome.lines()) {
    thesis.emplace_back(row.at("thesis_least_s"), row.at("thesis_most_s"));
    EXPECT_GT(row.at("here_s"), 0);
    EXPECT_LT(row.at("here_s"), row.at("thesis_least_s"));
  }
  EXPECT_EQ(thesis,
            (std::vector<std::pair<double, double>>{{55, 55}, {17, 17}, {30, 90}, {1200, 1800}}));
  const Outcome table = fathom("bench --thesis --backend cpu");
  EXPECT_NE(table.out.find("20 to 30 min"), std::string::npos) << table.out;
}

TEST_F(Bench, OneMissingBackendDoesNotLoseTheOthers) {
  const Outcome outcome =
      fathom("bench --backend abacus --backend reference --metric walsh-paley:8 --batch 1 --json");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_EQ(outcome.lines().size(), 1u);
  EXPECT_NE(outcome.err.find("abacus"), std::string::npos);
}

}  // namespace
}  // namespace fathom::test
