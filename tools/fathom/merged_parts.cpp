// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/merged_parts.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <unordered_map>

#include "engine/error.hpp"
#include "engine/file.hpp"
#include "engine/json.hpp"
#include "engine/printable.hpp"
#include "tools/fathom/shard.hpp"

namespace fathom::cli {
namespace {

using Json = nlohmann::ordered_json;

/// One file.
struct Part {
  std::string path;
  std::vector<std::string> rows = {};
  Shard shard = {};
  std::string command = {};
  std::size_t failed = 0;
  bool is_shard = false;
};

[[noreturn]] void refuse(const std::string& path, std::string_view what) {
  throw Error(ErrorCode::bad_data, fmt::format("{}: {}", printable(path), what));
}

Json parsed_line(const std::string& path, const std::string& line, std::size_t number) {
  try {
    Json row = parse_json(line);
    if (row.is_object()) return row;
  } catch (const nlohmann::json::exception&) {
    // It is said below.
  }
  refuse(path,
         fmt::format("line {} is no JSON object; give what fathom score or depth --json printed",
                     number));
}

std::vector<std::string> lines_of(const std::string& path) {
  const std::string text = read_file(path);
  if (!text.empty() && text.back() != '\n') refuse(path, "its last line is cut off; run it again");
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    if (end > at) lines.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return lines;
}

void read_end(Part& part, const Json& end) {
  try {
    part.shard.number = whole_from<std::size_t>(end.at("shard"));
    part.shard.count = whole_from<std::size_t>(end.at("shards"));
    part.command = end.at("command").get<std::string>();
    part.failed = whole_from<std::size_t>(end.at("failed"));
    if (whole_from<std::size_t>(end.at("rows")) != part.rows.size())
      refuse(part.path, "rows are missing in it; run it again");
  } catch (const nlohmann::json::exception&) {
    refuse(part.path, "its last line is none of a shard's; run it again");
  }
  if (part.shard.number < 1 || part.shard.number > part.shard.count)
    refuse(part.path, "its last line is none of a shard's; run it again");
  part.is_shard = true;
}

Part read_part(const std::string& path) {
  Part part{.path = path, .rows = lines_of(path)};
  if (part.rows.empty()) refuse(path, "it is empty; run it again");
  const Json last = parsed_line(path, part.rows.back(), part.rows.size());
  if (!last.contains("shard")) return part;
  part.rows.pop_back();
  read_end(part, last);
  return part;
}

void require_one_run(const std::vector<Part>& parts) {
  const Part& first = parts.front();
  for (const Part& part : parts) {
    if (part.is_shard != first.is_shard) {
      const Part& cut = part.is_shard ? first : part;
      refuse(cut.path, "it has no last line of a shard, as others have; run it again");
    }
    if (part.command != first.command || part.shard.count != first.shard.count)
      refuse(part.path, fmt::format("it is of another run than {}", printable(first.path)));
  }
}

/// Names the first of those that are missing.
void require_all_shards(const std::vector<Part>& parts) {
  constexpr std::size_t kMostNamed = 10;
  const std::size_t count = parts.front().shard.count;
  std::vector<std::size_t> missing;
  for (std::size_t number = 1, at = 0; number <= count; ++number) {
    if (at < parts.size() && parts[at].shard.number == number) {
      ++at;
    } else {
      missing.push_back(number);
    }
  }
  if (missing.empty()) return;
  const auto named = static_cast<std::ptrdiff_t>(std::min(missing.size(), kMostNamed));
  throw Error(ErrorCode::bad_data,
              fmt::format("{} of {} shards {} missing: {}{}; nothing is written", missing.size(),
                          count, missing.size() == 1 ? "is" : "are",
                          fmt::join(missing.begin(), missing.begin() + named, ", "),
                          missing.size() > kMostNamed ? ", ..." : ""));
}

void require_whole_run(std::vector<Part>& parts) {
  std::ranges::stable_sort(parts, {}, [](const Part& part) { return part.shard.number; });
  const auto twice =
      std::ranges::adjacent_find(parts, {}, [](const Part& part) { return part.shard.number; });
  if (twice != parts.end()) {
    refuse(twice->path, fmt::format("it is shard {} of {}, and so is {}", twice->shard.number,
                                    twice->shard.count, printable((twice + 1)->path)));
  }
  require_all_shards(parts);
}

/// What a row is of, without what was measured.
std::string subject_of(const Json& row) {
  Json subject;
  for (const char* key : {"image", "page", "x", "y", "n", "metric", "stack"})
    subject.push_back(row.value(key, Json()));
  return subject.dump();
}

void require_each_once(const std::vector<Part>& parts) {
  std::unordered_map<std::string, const Part*> seen;
  for (const Part& part : parts) {
    for (std::size_t i = 0; i < part.rows.size(); ++i) {
      const Json row = parsed_line(part.path, part.rows[i], i + 1);
      const auto [before, is_new] = seen.emplace(subject_of(row), &part);
      if (is_new) continue;
      refuse(part.path, fmt::format("line {} is there twice, the first time in {}: {}", i + 1,
                                    printable(before->second->path), printable(part.rows[i])));
    }
  }
}

/// One cell of CSV: in quotes where it needs them.
std::string cell(const Json& value) {
  if (!value.is_string()) return value.is_null() ? "" : value.dump();
  const auto& text = value.get_ref<const std::string&>();
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
  return quoted + "\"";
}

/// A row with lists laid out as columns of their own.
Json flattened(const Json& row) {
  Json flat = Json::object();
  for (const auto& [key, value] : row.items()) {
    if (!value.is_array()) flat[key] = value;
    for (std::size_t k = 0; value.is_array() && k < value.size(); ++k)
      flat[fmt::format("{}_{}", key, k + 1)] = value[k];
  }
  return flat;
}

}  // namespace

MergedParts merge_parts(const std::vector<std::string>& paths) {
  std::vector<Part> parts;
  for (const std::string& path : paths) parts.push_back(read_part(path));
  require_one_run(parts);
  if (parts.front().is_shard) require_whole_run(parts);
  require_each_once(parts);
  MergedParts merged;
  for (Part& part : parts) {
    merged.failed += part.failed;
    std::ranges::move(part.rows, std::back_inserter(merged.rows));
  }
  return merged;
}

bool is_shard(const std::string& path) {
  if (!std::filesystem::is_regular_file(path)) return false;
  try {
    return read_part(path).is_shard;
  } catch (const Error&) {
    return false;
  }
}

std::string csv_of(const MergedParts& merged) {
  std::vector<Json> rows;
  std::vector<std::string> names;
  std::unordered_map<std::string, std::size_t> columns;
  for (const std::string& row : merged.rows) {
    rows.push_back(flattened(Json::parse(row)));
    for (const auto& [key, value] : rows.back().items()) {
      if (columns.emplace(key, names.size()).second) names.push_back(key);
    }
  }
  std::string text = fmt::format("{}\n", fmt::join(names, ","));
  for (const Json& row : rows) {
    std::vector<std::string> cells(names.size());
    for (const auto& [key, value] : row.items()) cells[columns.at(key)] = cell(value);
    text += fmt::format("{}\n", fmt::join(cells, ","));
  }
  return text;
}

}  // namespace fathom::cli
