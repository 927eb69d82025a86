// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "calibration/calibration.hpp"
#include "engine/error.hpp"

namespace fathom {
namespace {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blank = " \t\r\"";
  const std::size_t first = text.find_first_not_of(blank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blank) - first + 1);
}

std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> fields;
  for (std::size_t start = 0; start <= line.size();) {
    const std::size_t end = std::min(line.find(',', start), line.size());
    fields.push_back(trimmed(line.substr(start, end - start)));
    start = end + 1;
  }
  return fields;
}

[[noreturn]] void refuse(std::string_view name, int line, const std::string& why) {
  throw Error(ErrorCode::bad_data, fmt::format("{} line {}: {}", name, line, why));
}

/// Which column has this name; exactly one must.
std::size_t column_of(const std::vector<std::string_view>& names, std::string_view wanted,
                      std::string_view name, int line) {
  const auto found = std::find(names.begin(), names.end(), wanted);
  if (found == names.end() || std::find(found + 1, names.end(), wanted) != names.end()) {
    refuse(name, line, fmt::format("the header must name the column {} once", wanted));
  }
  return static_cast<std::size_t>(found - names.begin());
}

/// Which columns hold what, and how many there are.
struct Header {
  std::size_t position, distance_mm, count;
};

double number(std::string_view text, std::string_view name, int line) {
  double value = 0;
  const auto [next, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc() || next != text.data() + text.size() || !std::isfinite(value)) {
    refuse(name, line, fmt::format("\"{}\" is not a number", text));
  }
  return value;
}

double positive_number(std::string_view text, std::string_view name, int line) {
  const double value = number(text, name, line);
  if (value <= 0) refuse(name, line, fmt::format("\"{}\" is not above 0", text));
  return value;
}

}  // namespace

std::vector<CalibrationPoint> parse_calibration_points(std::string_view csv,
                                                       std::string_view name) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";  // spreadsheets write it
  if (csv.starts_with(kByteOrderMark)) csv.remove_prefix(kByteOrderMark.size());
  std::vector<CalibrationPoint> points;
  std::optional<Header> header;
  int line_number = 0;
  for (std::size_t start = 0; start < csv.size();) {
    const std::size_t end = std::min(csv.find('\n', start), csv.size());
    const std::string_view line = trimmed(csv.substr(start, end - start));
    start = end + 1;
    ++line_number;
    if (line.empty() || line.front() == '#') continue;
    const auto fields = fields_of(line);
    if (!header) {
      header = Header{column_of(fields, "position", name, line_number),
                      column_of(fields, "distance_mm", name, line_number), fields.size()};
      continue;
    }
    // More fields than columns are a decimal comma, or a comma in a note: never guess which.
    if (fields.size() != header->count) {
      refuse(name, line_number,
             fmt::format("{} fields under {} columns; decimals need a point", fields.size(),
                         header->count));
    }
    points.push_back({number(fields[header->position], name, line_number),
                      positive_number(fields[header->distance_mm], name, line_number)});
  }
  return points;
}

}  // namespace fathom
