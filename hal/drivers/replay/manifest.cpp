// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/replay/manifest.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <map>
#include <utility>

#include "engine/error.hpp"

namespace fathom {
namespace {

constexpr std::string_view kSpace = " \t\r\v\f";

std::string_view trim(std::string_view text, std::string_view space = kSpace) {
  const std::size_t first = text.find_first_not_of(space);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(space) - first + 1);
}

/// A piece of somebody's file as it may stand in a message: short, and without what a terminal would
/// take for an order.
std::string shown(std::string_view text) {
  constexpr std::size_t kMost = 60;
  std::string result;
  for (const char c : text.substr(0, kMost)) {
    const auto byte = static_cast<unsigned char>(c);
    result += byte < 0x20 || byte == 0x7f ? '?' : c;
  }
  return text.size() > kMost ? result + "..." : result;
}

/// UTF-16 begins with a mark, or has a zero beside every letter.
bool is_utf_16(std::string_view text) {
  const std::string_view start = text.substr(0, 2);
  return start == "\xff\xfe" || start == "\xfe\xff" ||
         (start.size() == 2 && (start[0] == '\0') != (start[1] == '\0'));
}

std::string in_lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// Reads one manifest, line by line; every refusal names the line.
class Parser {
 public:
  explicit Parser(const std::string& name) : name_(name) {}

  void line(std::string_view text) {
    ++line_;
    if (trim(text).empty()) return;
    const std::string_view content = trim(text, space());
    if (content.front() == '#') return comment_or_entry(content);
    if (columns_.empty()) separator_ = separator_of(content);
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
  /// Spreadsheets of half the world write semicolons; some programs write tabs.
  static char separator_of(std::string_view header) {
    if (header.find(',') != std::string_view::npos) return ',';
    if (header.find(';') != std::string_view::npos) return ';';
    return header.find('\t') != std::string_view::npos ? '\t' : ',';
  }

  /// A row that was commented out, or a picture whose name begins so: the folder knows.
  void comment_or_entry(std::string_view text) {
    comment(text.substr(1));
    if (columns_.empty()) return;
    try {
      manifest_.perhaps.push_back(entry_of(split(text)));
    } catch (const Error&) {  // a comment
    }
  }

  /// A tab that separates is not to be trimmed away.
  std::string_view space() const { return separator_ == '\t' ? " \r\v\f" : kSpace; }

  [[noreturn]] void refuse(const std::string& what) const {
    throw Error(ErrorCode::bad_data, fmt::format("{} line {}: {}", name_, line_, what));
  }

  /// The fields of one line, trimmed where they stand without quotes.
  std::vector<std::string> split(std::string_view text) const {
    std::vector<std::string> fields;
    for (;;) {
      text = trim(text, space());
      std::string field;
      if (text.starts_with('"')) {
        text = quoted(text, field);
      } else {
        const std::size_t comma = std::min(text.find(separator_), text.size());
        field = trim(text.substr(0, comma), space());
        text.remove_prefix(comma);
      }
      fields.push_back(std::move(field));
      if (text.empty()) return fields;
      text.remove_prefix(1);  // the separator
    }
  }

  /// Reads a quoted field; returns what follows it, which starts with a separator or is empty.
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
    const std::string_view rest = trim(text.substr(at + 1), space());
    if (!rest.empty() && rest.front() != separator_) refuse("text after a closing quote");
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

  /// Columns of other names are others' affair, and how a name is written is the spreadsheet's.
  void header(const std::vector<std::string>& written) {
    std::vector<std::string> fields;
    for (const std::string& name : written) fields.push_back(in_lower_case(name));
    for (const char* known : {"file", "position", "page"}) {
      if (std::count(fields.begin(), fields.end(), known) > 1)
        refuse(fmt::format("column {} is there twice", known));
    }
    for (const char* needed : {"file", "position"}) {
      if (std::find(fields.begin(), fields.end(), needed) == fields.end()) {
        refuse(
            fmt::format("column {} is missing; the first line names file and position, with "
                        "commas between, and perhaps page and others, but it is \"{}\"",
                        needed, shown(fmt::format("{}", fmt::join(written, ",")))));
      }
    }
    columns_ = fields;
  }

  void entry(const std::vector<std::string>& fields) {
    ManifestEntry entry = entry_of(fields);
    const std::string file = std::filesystem::path(entry.file).lexically_normal().string();
    const auto [earlier, is_new] =
        entry_of_picture_.emplace(std::pair(file, entry.page), std::pair(line_, entry.position));
    if (!is_new) refuse_again(entry, earlier->second);
    manifest_.entries.push_back(std::move(entry));
  }

  /// A picture was taken at one position.
  [[noreturn]] void refuse_again(const ManifestEntry& entry,
                                 const std::pair<int, double>& earlier) const {
    const auto [line, position] = earlier;
    refuse(
        position == entry.position
            ? fmt::format("the same picture at the same position is also on line {}", line)
            : fmt::format("the same picture is also on line {}, at position {:g} where this says "
                          "{:g}; which one is right?",
                          line, position, entry.position));
  }

  ManifestEntry entry_of(const std::vector<std::string>& fields) const {
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
    return entry;
  }

  /// Where commas do not separate fields they are decimal points.
  double number(std::string_view written, const char* what) const {
    std::string text(written);
    if (separator_ != ',' && text.find('.') == std::string::npos)
      std::replace(text.begin(), text.end(), ',', '.');
    double value = 0;
    const char* const end = text.data() + text.size();
    const auto [next, problem] = std::from_chars(text.data(), end, value);
    if (problem != std::errc() || next != end || !std::isfinite(value)) {
      refuse(fmt::format("{} \"{}\" is not a number", what, shown(written)));
    }
    return value;
  }

  std::size_t page(std::string_view text) const {
    std::size_t value = 0;
    const char* const end = text.data() + text.size();
    const auto [next, problem] = std::from_chars(text.data(), end, value);
    if (problem != std::errc() || next != end) {
      refuse(fmt::format("page \"{}\" is not a page number, 0 or above", shown(text)));
    }
    return value;
  }

  const std::string& name_;
  int line_ = 0;
  char separator_ = ',';
  std::vector<std::string> columns_;
  std::optional<std::string> unit_;
  std::map<std::pair<std::string, std::size_t>, std::pair<int, double>> entry_of_picture_;
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
  if (is_utf_16(text)) {
    throw Error(
        ErrorCode::bad_data,
        fmt::format("{} is UTF-16 text; save it as UTF-8 (in a spreadsheet: CSV UTF-8)", name));
  }
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
  if (entries.empty()) return text;
  try {
    parse_manifest(text, "the manifest");  // what cannot be read back must not be written
  } catch (const Error& error) {
    throw Error(ErrorCode::bad_argument, error.what());
  }
  return text;
}

}  // namespace fathom
