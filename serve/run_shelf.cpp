// SPDX-License-Identifier: Apache-2.0
#include "serve/run_shelf.hpp"

#include <algorithm>
#include <set>
#include <system_error>
#include <vector>

#include "engine/error.hpp"
#include "engine/file.hpp"
#include "serve/procedures.hpp"
#include "session/json_line.hpp"
#include "session/run_file.hpp"
#include "session/run_store.hpp"

namespace fathom::serve {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kLargestRun = 64 << 20;
constexpr std::size_t kMostListed = 100;

bool is_run(const fs::path& path) {
  std::error_code ignored;
  return path.extension() == ".json" && fs::is_regular_file(fs::symlink_status(path, ignored));
}

/// The newest first.
std::vector<fs::path> newest_in(const fs::path& folder) {
  std::vector<fs::path> paths;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    if (is_run(entry.path())) paths.push_back(entry.path());
  }
  std::ranges::sort(paths, is_newer_run);
  paths.resize(std::min(paths.size(), kMostListed));
  return paths;
}

void add_focus(JsonLine& line, const RunFile& file) {
  const Focus* focus = nullptr;
  for (const Run& run : file.runs) {
    if (run.focus) focus = &*run.focus;
  }
  if (focus == nullptr) {
    line.add_null("position").add_null("sigma").add_null("verdict");
    return;
  }
  line.add("position", focus->position()).add("sigma", focus->peak.sigma);
  line.add("verdict", to_string(focus->result()));
}

std::string summary_of(const std::string& id, const RunFile& file) {
  JsonLine line;
  line.add("id", id).add("kind", file.setup.verb).add("when", file.setup.created);
  line.add("rig", file.setup.rig).add("metric", file.setup.metric.text());
  add_focus(line, file);
  file.distance ? line.add("distance_mm", file.distance->mm) : line.add_null("distance_mm");
  file.error.empty() ? line.add_null("error") : line.add("error", file.error);
  return line.text();
}

std::string summary_of(const fs::path& path) {
  const std::string id = path.stem();
  try {
    return summary_of(id, RunFile::parse(read_file(path, kLargestRun), id));
  } catch (const Error& error) {
    return JsonLine().add("id", id).add("error", error.what()).text();
  }
}

}  // namespace

std::string RunShelf::line_of(const fs::path& path) {
  std::error_code ignored;
  const auto changed = fs::last_write_time(path, ignored);
  const std::uintmax_t bytes = fs::file_size(path, ignored);
  Known& known = known_[path.stem()];
  if (known.line.empty() || known.changed != changed || known.bytes != bytes)
    known = {changed, bytes, summary_of(path)};
  return known.line;
}

std::string RunShelf::list() {
  const std::lock_guard lock(mutex_);
  std::string text = "[";
  std::set<std::string> listed;
  for (const fs::path& path : newest_in(folder_)) {
    text += (text.size() > 1 ? "," : "") + line_of(path);
    listed.insert(path.stem());
  }
  std::erase_if(known_, [&](const auto& one) { return !listed.contains(one.first); });
  return text + "]";
}

std::optional<std::string> RunShelf::file(const std::string& id) const {
  try {
    require_plain_name(id);
  } catch (const Error&) {
    return std::nullopt;
  }
  const fs::path path = folder_ / (id + ".json");
  if (!is_run(path)) return std::nullopt;
  return read_file(path, kLargestRun);
}

std::optional<std::string> RunShelf::rerun(const std::string& id) const {
  const std::optional<std::string> text = file(id);
  if (!text) return std::nullopt;
  const RunFile kept = RunFile::parse(*text, id);
  const bool is_same = same_answer(kept, fathom::rerun(kept, id));
  const bool is_whole = kept.is_as_written != false;
  const char* words = !is_same    ? "the run does not come to the answer that it holds"
                      : !is_whole ? "the answer is the same, but the file was changed afterwards"
                                  : "the run comes to the same answer";
  return JsonLine()
      .add_json("same", is_same && is_whole ? "true" : "false")
      .add("text", words)
      .text();
}

}  // namespace fathom::serve
