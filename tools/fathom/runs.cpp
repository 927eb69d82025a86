// SPDX-License-Identifier: Apache-2.0
// fathom runs: the runs that were kept: list them, show one, delete old ones.
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <system_error>

#include "engine/error.hpp"
#include "engine/file.hpp"
#include "engine/printable.hpp"
#include "session/run_file.hpp"
#include "session/run_store.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/search_view.hpp"
#include "tools/fathom/verbs.hpp"

namespace fathom::cli {
namespace {

namespace fs = std::filesystem;

fs::path folder_of(const std::string& named) {
  if (!named.empty()) return named;
  const fs::path state = state_folder();
  if (state.empty()) {
    throw Error(ErrorCode::bad_argument,
                "neither HOME nor XDG_STATE_HOME names a folder; name one with --folder");
  }
  return state / "runs";
}

/// Whether a name is one that keep_run() gives: TIME-VERB-XXXX.json. Nothing else is ever deleted.
bool is_kept_run(const std::string& name) {
  static constexpr std::string_view kTime = "dddd-dd-ddTdd-dd-dd-";
  if (name.size() <= kTime.size() || !name.ends_with(".json")) return false;
  for (std::size_t i = 0; i < kTime.size(); ++i) {
    const bool is_digit = std::isdigit(static_cast<unsigned char>(name[i])) != 0;
    if (kTime[i] == 'd' ? !is_digit : name[i] != kTime[i]) return false;
  }
  return true;
}

/// The newest first.
std::vector<fs::path> runs_in(const fs::path& folder) {
  std::vector<fs::path> runs;
  std::error_code none;  // a folder that is not there holds no runs
  for (const auto& entry : fs::directory_iterator(folder, none)) {
    if (entry.is_regular_file() && is_kept_run(entry.path().filename().string()))
      runs.push_back(entry.path());
  }
  std::ranges::sort(runs, is_newer_run);
  return runs;
}

RunFile load(const fs::path& path) {
  constexpr std::uintmax_t kLargest = 1u << 30;
  return RunFile::parse(read_file(path, kLargest), path.string());
}

/// What a run came to, in a few words.
std::string answer_of(const RunFile& file) {
  if (!file.error.empty()) return "ended early: " + printable(file.error);
  if (file.distance)
    return fmt::format("{:.1f} mm +- {:.1f} mm", file.distance->mm, file.distance->sigma_mm);
  if (file.surfaces) return fmt::format("{} surfaces", file.surfaces->size());
  if (file.calibration) return fmt::format("{} points", file.calibration->points().size());
  if (file.runs.empty()) return "-";
  const Run& run = file.runs.back();
  if (!run.focus) return fmt::format("{} positions", run.measurements.size());
  if (run.focus->result() != FocusResult::focused) return to_string(run.focus->result());
  return fmt::format("{:.6g} +- {:.2g} {}", run.focus->position(), run.focus->peak.sigma,
                     printable(file.setup.lens.unit));
}

std::string row_of(const fs::path& path) {
  const std::string name = path.filename().string();
  try {
    const RunFile file = load(path);
    return fmt::format("{:<42} {:<28} {}", printable(name), printable(file.setup.rig),
                       answer_of(file));
  } catch (const Error&) {
    return fmt::format("{:<42} cannot be read", printable(name));
  }
}

std::string json_of(const fs::path& path) {
  JsonLine line;
  line.add("file", path.string());
  try {
    const RunFile file = load(path);
    line.add("created", file.setup.created)
        .add("verb", file.setup.verb)
        .add("rig", file.setup.rig)
        .add("metric", file.setup.metric.text())
        .add("answer", answer_of(file));
  } catch (const Error& error) {
    line.add("problem", error.what());
  }
  return line.text();
}

struct ListArguments {
  std::string folder;
  int most = 20;
  bool json = false;
};

int list(const ListArguments& arguments) {
  const fs::path folder = folder_of(arguments.folder);
  const std::vector<fs::path> runs = runs_in(folder);
  const std::size_t shown = std::min(runs.size(), static_cast<std::size_t>(arguments.most));
  for (std::size_t i = 0; i < shown; ++i)
    print_line(arguments.json ? json_of(runs[i]) : row_of(runs[i]));
  if (!arguments.json) {
    print_line(fmt::format("{} of {} runs in {}", shown, runs.size(), printable(folder.string())));
  }
  return kDone;
}

struct ShowArguments {
  std::string run;
  std::string folder;
};

/// A file, or a run of the folder by its name or the beginning of it; "last" is the newest.
fs::path find_run(const ShowArguments& arguments) {
  if (fs::exists(arguments.run)) return arguments.run;
  const fs::path folder = folder_of(arguments.folder);
  for (const fs::path& path : runs_in(folder)) {
    if (arguments.run == "last" || path.filename().string().starts_with(arguments.run)) return path;
  }
  throw Error(ErrorCode::io, fmt::format("no run \"{}\", neither as a file nor in {}",
                                         arguments.run, folder.string()));
}

int show(const ShowArguments& arguments) {
  const fs::path path = find_run(arguments);
  const RunFile file = load(path);
  const RunSetup& setup = file.setup;
  print_line("file:     " + printable(path.string()));
  print_line("created:  " + printable(setup.created));
  print_line("command:  " + printable(setup.command));
  print_line("rig:      " + printable(setup.rig) + "; " + printable(setup.camera));
  print_line(fmt::format("metric:   {}, window {}, {}", setup.metric.text(),
                         to_string(setup.window), printable(setup.backend)));
  for (const Run& run : file.runs) {
    const std::string target =
        run.target_mm ? fmt::format("target at {:g} mm: ", *run.target_mm) : "";
    print_line("measured: " + target +
               (run.focus ? describe(*run.focus, printable(setup.lens.unit))
                          : fmt::format("{} positions", run.measurements.size())));
  }
  print_line("answer:   " + answer_of(file));
  return kDone;
}

struct PruneArguments {
  std::string folder;
  std::size_t keep = 0;
  bool is_rehearsal = false;
};

int prune(const PruneArguments& arguments) {
  const fs::path folder = folder_of(arguments.folder);
  const std::vector<fs::path> runs = runs_in(folder);
  const std::size_t kept = std::min(runs.size(), arguments.keep);
  std::uintmax_t bytes = 0;
  for (std::size_t i = kept; i < runs.size(); ++i) {
    std::error_code none;
    const std::uintmax_t size = fs::file_size(runs[i], none);
    if (!none) bytes += size;
    if (!arguments.is_rehearsal) fs::remove(runs[i]);
  }
  print_line(fmt::format("{} runs of {} {} ({:.1f} MB), the newest {} {}", runs.size() - kept,
                         runs.size(), arguments.is_rehearsal ? "would be deleted" : "deleted",
                         1e-6 * static_cast<double>(bytes), kept,
                         arguments.is_rehearsal ? "would stay" : "stay"));
  return kDone;
}

constexpr const char* kFolderHelp = "Folder with runs (default: ~/.local/state/fathom/runs)";

void add_list(Verb& runs) {
  Verb verb = runs.add_verb("list", "List runs, the newest first, with what they came to");
  verb.set_footer("Examples:\n  fathom runs list\n  fathom runs list --most 100 --json");
  auto arguments = std::make_shared<ListArguments>();
  verb.add_option("--most", arguments->most, "How many").shows_default().at_least_one();
  verb.add_option("--folder", arguments->folder, kFolderHelp);
  verb.add_flag("--json", arguments->json, "One JSON object a line on standard output");
  verb.on_run([arguments] { return list(*arguments); });
}

void add_show(Verb& runs) {
  Verb verb = runs.add_verb("show", "Show what was asked for, measured and found in a run");
  verb.set_footer(
      "Examples:\n  fathom runs show last\n  fathom runs show run.json\n\n"
      "fathom rerun RUN --plot - draws its curve and checks its answer.");
  auto arguments = std::make_shared<ShowArguments>();
  verb.add_option("RUN", arguments->run, "A file, the beginning of a name that list shows, or last")
      .required();
  verb.add_option("--folder", arguments->folder, kFolderHelp);
  verb.on_run([arguments] { return show(*arguments); });
}

void add_prune(Verb& runs) {
  Verb verb = runs.add_verb("prune", "Delete all runs but the newest");
  verb.set_footer(
      "Examples:\n  fathom runs prune --keep 50 --dry-run\n  fathom runs prune --keep 50\n\n"
      "Only files that fathom named itself are deleted; those of -o are yours.");
  auto arguments = std::make_shared<PruneArguments>();
  verb.add_option("--keep", arguments->keep, "How many of the newest stay").required();
  verb.add_flag("--dry-run", arguments->is_rehearsal,
                "Say what would be deleted, and delete nothing");
  verb.add_option("--folder", arguments->folder, kFolderHelp);
  verb.on_run([arguments] { return prune(*arguments); });
}

}  // namespace

void add_runs(Verb& program) {
  Verb verb = program.add_verb("runs", "List, show and delete the runs that were kept");
  verb.require_verb();
  verb.set_footer(
      "Examples:\n  fathom runs list\n  fathom runs show last\n  fathom runs prune --keep 50");
  add_list(verb);
  add_show(verb);
  add_prune(verb);
}

}  // namespace fathom::cli
