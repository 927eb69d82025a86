// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <charconv>
#include <optional>

#include "engine/error.hpp"
#include "ranging/calibration.hpp"

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

/// Which columns hold what.
struct Header {
  std::size_t position = std::string_view::npos;
  std::size_t distance_mm = std::string_view::npos;

  explicit Header(const std::vector<std::string_view>& names) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (names[i] == "position") position = i;
      if (names[i] == "distance_mm") distance_mm = i;
    }
  }
  bool complete() const {
    return position != std::string_view::npos && distance_mm != std::string_view::npos;
  }
};

double field(const std::vector<std::string_view>& fields, std::size_t column, std::string_view name,
             int line) {
  const std::string_view text = column < fields.size() ? fields[column] : std::string_view();
  double value = 0;
  const auto [next, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc() || next != text.data() + text.size()) {
    throw Error(ErrorCode::bad_data,
                fmt::format("{} line {}: \"{}\" is not a number", name, line, text));
  }
  return value;
}

}  // namespace

std::vector<CalibrationPoint> parse_calibration_points(std::string_view csv,
                                                       std::string_view name) {
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
      header = Header(fields);
      if (header->complete()) continue;
      throw Error(
          ErrorCode::bad_data,
          fmt::format("{} line {}: the header must name the columns position and distance_mm", name,
                      line_number));
    }
    points.push_back({field(fields, header->position, name, line_number),
                      field(fields, header->distance_mm, name, line_number)});
  }
  return points;
}

}  // namespace fathom
