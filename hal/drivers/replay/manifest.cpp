// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/replay/manifest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <map>

#include "engine/error.hpp"

namespace fathom {
namespace {

constexpr std::string_view kSpace = " \t\r\v\f";

std::string_view trim(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

/// Reads one manifest, line by line; every refusal names the line.
class Parser {
 public:
  explicit Parser(const std::string& name) : name_(name) {}

  void line(std::string_view text) {
    ++line_;
    const std::string_view content = trim(text);
    if (content.empty()) return;
    if (content.front() == '#') return comment(content.substr(1));
    const std::vector<std::string> fields = split(content);
    if (columns_.empty()) return header(fields);
    entry(fields);
  }

  Manifest finish() {
    if (manifest_.entries.empty()) {
      throw Error(ErrorCode::bad_data,
                  fmt::format("{} lists no pictures; it needs a line file,position and one line "
                              "for every picture",
                              name_));
    }
    if (unit_) manifest_.unit = *unit_;
    return std::move(manifest_);
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw Error(ErrorCode::bad_data, fmt::format("{} line {}: {}", name_, line_, what));
  }

  /// The fields of one line, trimmed where they stand without quotes.
  std::vector<std::string> split(std::string_view text) const {
    std::vector<std::string> fields;
    for (;;) {
      text = trim(text);
      std::string field;
      if (text.starts_with('"')) {
        text = quoted(text, field);
      } else {
        const std::size_t comma = std::min(text.find(','), text.size());
        field = trim(text.substr(0, comma));
        text.remove_prefix(comma);
      }
      fields.push_back(std::move(field));
      if (text.empty()) return fields;
      text.remove_prefix(1);  // the comma
    }
  }

  /// Reads a quoted field; returns what follows it, which starts with a comma or is empty.
  std::string_view quoted(std::string_view text, std::string& field) const {
    std::size_t at = 1;
    for (;; ++at) {
      if (at >= text.size()) refuse("a quote is not closed");
      if (text[at] != '"') {
        field += text[at];
      } else if (text.substr(at).starts_with("\"\"")) {
        field += text[at++];
      } else {
        break;
      }
    }
    const std::string_view rest = trim(text.substr(at + 1));
    if (!rest.empty() && rest.front() != ',') refuse("text after a closing quote");
    return rest;
  }

  void comment(std::string_view text) {
    const std::size_t colon = text.find(':');
    if (colon == std::string_view::npos) return;
    const std::string_view key = trim(text.substr(0, colon));
    const std::string_view value = trim(text.substr(colon + 1));
    if (key == "unit") {
      if (value.empty()) refuse("the unit is empty");
      if (unit_) refuse("the unit is given twice");
      unit_ = value;
    } else if (key == "coarse_spacing") {
      const double spacing = number(value, "coarse_spacing");
      if (spacing <= 0) refuse("coarse_spacing must be above 0");
      if (manifest_.coarse_spacing) refuse("coarse_spacing is given twice");
      manifest_.coarse_spacing = spacing;
    }
  }

  void header(const std::vector<std::string>& fields) {
    for (const std::string& field : fields) {
      if (field != "file" && field != "position" && field != "page") {
        refuse(fmt::format("no column \"{}\"; the first line names file, position and perhaps page",
                           field));
      }
      if (std::count(fields.begin(), fields.end(), field) > 1) {
        refuse(fmt::format("column {} is there twice", field));
      }
    }
    for (const char* needed : {"file", "position"}) {
      if (std::find(fields.begin(), fields.end(), needed) == fields.end()) {
        refuse(fmt::format("column {} is missing; the first line is file,position", needed));
      }
    }
    columns_ = fields;
  }

  void entry(const std::vector<std::string>& fields) {
    if (fields.size() != columns_.size()) {
      refuse(
          fmt::format("{} fields where the first line names {}", fields.size(), columns_.size()));
    }
    ManifestEntry entry;
    entry.line = line_;
    for (std::size_t i = 0; i < fields.size(); ++i) {
      if (columns_[i] == "file") entry.file = fields[i];
      if (columns_[i] == "position") entry.position = number(fields[i], "position");
      if (columns_[i] == "page") entry.page = page(fields[i]);
    }
    if (entry.file.empty()) refuse("the file's name is missing");
    const auto [earlier, is_new] = line_of_position_.emplace(entry.position, line_);
    if (!is_new) {
      refuse(fmt::format("position {} is also on line {}; every picture needs its own",
                         entry.position, earlier->second));
    }
    manifest_.entries.push_back(std::move(entry));
  }

  double number(std::string_view text, const char* what) const {
    double value = 0;
    const char* const end = text.data() + text.size();
    const auto [next, problem] = std::from_chars(text.data(), end, value);
    if (problem != std::errc() || next != end || !std::isfinite(value)) {
      refuse(fmt::format("{} \"{}\" is not a number", what, text));
    }
    return value;
  }

  std::size_t page(std::string_view text) const {
    std::size_t value = 0;
    const char* const end = text.data() + text.size();
    const auto [next, problem] = std::from_chars(text.data(), end, value);
    if (problem != std::errc() || next != end) {
      refuse(fmt::format("page \"{}\" is not a page number, 0 or above", text));
    }
    return value;
  }

  const std::string& name_;
  int line_ = 0;
  std::vector<std::string> columns_;
  std::optional<std::string> unit_;
  std::map<double, int> line_of_position_;
  Manifest manifest_;
};

/// A field as it must stand in the file: in quotes, unless every character is harmless.
std::string field_text(const std::string& text) {
  const auto is_plain = [](unsigned char c) {
    return c >= 0x80 || std::isalnum(c) != 0 ||
           std::string_view("._-/").find(static_cast<char>(c)) != std::string_view::npos;
  };
  if (std::all_of(text.begin(), text.end(), is_plain)) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

}  // namespace

Manifest parse_manifest(std::string_view text, const std::string& name) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";  // spreadsheets write one
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  Parser parser(name);
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    parser.line(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return parser.finish();
}

std::string manifest_text(const Manifest& manifest) {
  const auto& entries = manifest.entries;
  const bool has_pages = std::any_of(entries.begin(), entries.end(),
                                     [](const ManifestEntry& entry) { return entry.page != 0; });
  std::string text = fmt::format("# unit: {}\n", manifest.unit);
  auto out = std::back_inserter(text);
  if (manifest.coarse_spacing)
    fmt::format_to(out, "# coarse_spacing: {}\n", *manifest.coarse_spacing);
  text += has_pages ? "file,position,page\n" : "file,position\n";
  for (const ManifestEntry& entry : entries) {
    if (entry.file.find('\n') != std::string::npos) {
      throw Error(ErrorCode::bad_argument, "a manifest cannot name a file with a line break in it");
    }
    fmt::format_to(out, "{},{}", field_text(entry.file), entry.position);
    if (has_pages) fmt::format_to(out, ",{}", entry.page);
    text += '\n';
  }
  try {
    parse_manifest(text, "the manifest");  // what cannot be read back must not be written
  } catch (const Error& error) {
    throw Error(ErrorCode::bad_argument, error.what());
  }
  return text;
}

}  // namespace fathom
