// SPDX-License-Identifier: Apache-2.0
// The golden values and the file that holds them, one score a line:
//
//   SPEC CONTENT BITS SEED SCORE [S]      # or a comment
//
// The picture is make_pixels(CONTENT, BITS, N, N, SEED), the window all of it. SCORE is a
// hexadecimal double; S is the integer sum N^2 |W| (i^2 + j^2) of metrics whose scores are exact.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace fathom::test {

struct Golden {
  std::string spec;
  std::string content;
  int bits = 8;
  std::uint64_t seed = 0;
  double score = 0;
  std::optional<std::uint64_t> sum;
};

/// Reads the file. Throws std::runtime_error for one that is missing, empty or malformed.
inline std::vector<Golden> read_golden(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  std::vector<Golden> values;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream fields(line);
    Golden value;
    std::string score;
    char* end = nullptr;
    fields >> value.spec >> value.content >> value.bits >> value.seed >> score;
    if (!fields) throw std::runtime_error(path + ": cannot read \"" + line + "\"");
    value.score = std::strtod(score.c_str(), &end);
    if (*end != '\0') throw std::runtime_error(path + ": no number: \"" + score + "\"");
    if (std::uint64_t sum = 0; fields >> sum) value.sum = sum;
    values.push_back(std::move(value));
  }
  if (values.empty()) throw std::runtime_error(path + " holds no values");
  return values;
}

}  // namespace fathom::test
