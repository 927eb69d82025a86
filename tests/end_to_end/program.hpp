// SPDX-License-Identifier: Apache-2.0
// Runs the program as a shell would, in a folder of its own.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.hpp"

namespace fathom::test {

/// What a command came to.
struct Outcome {
  int status = -1;
  std::string out;
  std::string err;

  /// Standard output as JSON, one object a line.
  std::vector<nlohmann::json> lines() const {
    std::vector<nlohmann::json> objects;
    std::istringstream stream(out);
    for (std::string line; std::getline(stream, line);)
      objects.push_back(nlohmann::json::parse(line));
    return objects;
  }
};

inline std::string contents(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

class Program : public ::testing::Test {
 protected:
  /// Runs `fathom ARGUMENTS` with the test's folder as working folder and as home of the runs.
  /// prefix: shell text before the command, such as "ulimit -f 1;".
  Outcome fathom(const std::string& arguments, const std::string& prefix = "") {
    const std::string out = path("stdout.txt"), err = path("stderr.txt");
    const std::string command = "cd " + folder_.path().string() + " && " + prefix +
                                " env XDG_STATE_HOME=" + folder_.path().string() +
                                "/state " FATHOM_PROGRAM " " + arguments + " >" + out + " 2>" +
                                err + " </dev/null";
    const int raw = std::system(command.c_str());
    Outcome outcome{WIFEXITED(raw) ? WEXITSTATUS(raw) : 128 + WTERMSIG(raw), contents(out),
                    contents(err)};
    EXPECT_LT(outcome.status, 4) << command << "\n" << outcome.err;
    return outcome;
  }

  /// The command must fail with this status and say all of these words in one line.
  void expect_refusal(const std::string& arguments, int status,
                      const std::vector<std::string>& words) {
    const Outcome outcome = fathom(arguments);
    EXPECT_EQ(outcome.status, status) << arguments << "\n" << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_EQ(outcome.err.rfind("fathom: ", 0), 0u) << outcome.err;
    for (const std::string& word : words) {
      EXPECT_NE(outcome.err.find(word), std::string::npos)
          << "no \"" << word << "\" in " << outcome.err;
    }
  }

  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  void write(const std::string& name, const std::string& bytes) const {
    std::ofstream(path(name), std::ios::binary) << bytes;
  }

 private:
  TemporaryFolder folder_;
};

}  // namespace fathom::test
