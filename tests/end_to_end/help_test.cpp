// SPDX-License-Identifier: Apache-2.0
// What the program says of itself: help of every verb, topics, and the version.
#include <algorithm>

#include "tests/end_to_end/program.hpp"

namespace fathom::test {
namespace {

class Help : public Program {
 protected:
  /// Verbs as they are typed behind "fathom ", read off the help itself.
  std::vector<std::string> verbs_of(const std::string& parent) {
    std::istringstream help(fathom(parent + " --help").out);
    std::vector<std::string> verbs;
    bool is_list = false;
    for (std::string line; std::getline(help, line);) {
      if (is_list && line.starts_with("  ") && line[2] != ' ')
        verbs.push_back(parent + (parent.empty() ? "" : " ") +
                        line.substr(2, line.find(' ', 2) - 2));
      if (line.empty()) is_list = false;
      if (line == "Verbs:") is_list = true;
    }
    return verbs;
  }
};

std::size_t longest_line(const std::string& text) {
  std::istringstream lines(text);
  std::size_t longest = 0;
  for (std::string line; std::getline(lines, line);) longest = std::max(longest, line.size());
  return longest;
}

TEST_F(Help, OfEveryVerbHasItsOwnExampleAndFitsInto100Columns) {
  std::vector<std::string> verbs = verbs_of("");
  ASSERT_GE(verbs.size(), 20u);
  for (const char* parent : {"rigs", "runs"}) {
    const auto children = verbs_of(parent);
    EXPECT_EQ(children.size(), 3u) << parent;
    verbs.insert(verbs.end(), children.begin(), children.end());
  }
  for (const std::string& verb : verbs) {
    const Outcome help = fathom(verb + " --help");
    EXPECT_EQ(help.status, 0) << verb;
    EXPECT_LE(longest_line(help.out), 100u) << help.out;
    const std::size_t examples = help.out.find("\nExample");
    ASSERT_NE(examples, std::string::npos) << verb;
    EXPECT_NE(help.out.find("fathom " + verb, examples), std::string::npos) << help.out;
    if (verb == "rigs") continue;  // help rigs is the topic
    EXPECT_EQ(help.out, fathom("help " + verb).out);
  }
}

TEST_F(Help, TellsOfRigsMetricsAndSearchesOnceAndNotInEveryVerb) {
  const std::string rigs = fathom("help rigs").out, searches = fathom("help searches").out;
  for (const char* driver : {"sim ", "replay ", "v4l2 ", "target=usaf"})
    EXPECT_NE(rigs.find(driver), std::string::npos) << rigs;
  for (const char* search : {"golden ", "spectral ", "brent ", "evaluated "})
    EXPECT_NE(searches.find(search), std::string::npos) << searches;
  EXPECT_NE(fathom("help metrics").out.find("rings=K"), std::string::npos);
  for (const char* topic : {"rigs", "metrics", "searches"}) {
    EXPECT_LE(longest_line(fathom(std::string("help ") + topic).out), 100u) << topic;
    EXPECT_NE(fathom("help").out.find(topic), std::string::npos);
  }
  EXPECT_EQ(fathom("focus --help").out.find("target=usaf"), std::string::npos);
}

TEST_F(Help, RefusesWhatThereIsNoHelpOn) {
  expect_refusal("help lenses", 2, {"lenses", "searches", "focus"});
  expect_refusal("help --completion tcsh", 2, {"tcsh", "bash", "zsh", "fish"});
  EXPECT_NE(fathom("--version").out.find("fathom 0."), std::string::npos);
}

}  // namespace
}  // namespace fathom::test
