// SPDX-License-Identifier: Apache-2.0
// The golden values and the file that holds them, one window a line:
//
//   SPEC CONTENT BITS SEED VALUE[,VALUE...] [S]      # or a comment
//
// The picture is make_pixels(CONTENT, BITS, N, N, SEED), the window all of it. A VALUE is a
// hexadecimal double, K of them for rings; S is the integer sum N^2 |W| (i^2 + j^2) of moments that
// are exact.
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
  std::vector<double> values;  ///< As many as the metric gives.
  std::optional<std::uint64_t> sum;
};

/// Reads "0x1p-3,0x1p-4". Throws std::runtime_error, naming the path, for anything else.
inline std::vector<double> read_values(const std::string& text, const std::string& path) {
  std::vector<double> values;
  for (const char* at = text.c_str();; ++at) {
    char* end = nullptr;
    values.push_back(std::strtod(at, &end));
    if (end == at || (*end != ',' && *end != '\0'))
      throw std::runtime_error(path + ": no numbers: \"" + text + "\"");
    if (*end == '\0') return values;
    at = end;
  }
}

/// Reads the file. Throws std::runtime_error for one that is missing, empty or malformed.
inline std::vector<Golden> read_golden(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  std::vector<Golden> values;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream fields(line);
    Golden value;
    std::string texts;
    fields >> value.spec >> value.content >> value.bits >> value.seed >> texts;
    if (!fields) throw std::runtime_error(path + ": cannot read \"" + line + "\"");
    value.values = read_values(texts, path);
    if (std::uint64_t sum = 0; fields >> sum) value.sum = sum;
    values.push_back(std::move(value));
  }
  if (values.empty()) throw std::runtime_error(path + " holds no values");
  return values;
}

}  // namespace fathom::test
