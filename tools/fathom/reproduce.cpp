// SPDX-License-Identifier: Apache-2.0
// fathom reproduce: the thesis' experiments on the simulated rig, as one report.
#include <sys/utsname.h>

#include <chrono>
#include <ctime>
#include <filesystem>
#include <thread>

#include "backends/backends.hpp"
#include "engine/error.hpp"
#include "engine/file.hpp"
#include "engine/selection.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/patience.hpp"
#include "tools/fathom/reproduce/report.hpp"
#include "tools/fathom/verbs.hpp"

namespace fathom::cli {
namespace {

namespace fs = std::filesystem;
using namespace reproduce;

struct Arguments {
  std::string folder;
  bool quick = false;
};

/// Before anything is measured.
void require_folder(const fs::path& folder) {
  if (fs::exists(folder) && !fs::is_directory(folder)) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("{} is a file; name a folder for the report", folder.string()));
  }
  std::error_code failure;
  fs::create_directories(folder / "figures", failure);
  if (failure) {
    throw Error(ErrorCode::io, fmt::format("cannot make the folder {}: {}",
                                           (folder / "figures").string(), failure.message()));
  }
}

std::string machine() {
  utsname system{};
  ::uname(&system);
  return fmt::format("{} {}, {} processors", system.sysname, system.machine,
                     std::thread::hardware_concurrency());
}

std::string today() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  ::gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%d %H:%M UTC", &utc);
  return text;
}

ThisRun measure_this_run() {
  return {measure_thesis_times(""), "fathom " FATHOM_VERSION, machine(), today()};
}

void write_figures(const fs::path& folder, const Document& document) {
  for (const Section& section : document.sections) {
    for (const Block& block : section.blocks) {
      const auto* const figure = std::get_if<Figure>(&block);
      if (figure == nullptr) continue;
      for (const Picture& picture : figure->pictures) {
        if (!picture.svg.empty()) write_file(folder / (picture.file + ".svg"), picture.svg);
      }
    }
  }
}

void print_claims(const std::vector<Claim>& claims) {
  for (const Claim& claim : claims) {
    print_line(fmt::format("{:<14} {}: {}", to_string(claim.outcome), claim.claim, claim.ours));
  }
}

/// Once before the experiments open it on many threads, so that the wait for its driver is said.
void open_device() {
  const MetricSpec spec = MetricSpec::parse(kTransforms[0].metric);
  select_device(all_backends(), "", spec, 1, {.on_work = patient_words()});
}

int run(const Arguments& arguments) {
  const fs::path folder = arguments.folder;
  require_folder(folder);
  const Artist artist;
  if (!artist.problem().empty()) note(artist.problem() + "; the report will have no plots");
  Results results;
  results.effort = arguments.quick ? Effort::short_one() : Effort::full();
  open_device();
  {
    Progress progress;
    run_experiments(results, stop_requested, [&](std::size_t done, std::size_t all) {
      progress.bar("experiments", done, all);
    });
    progress.clear();
  }
  const ThisRun this_run = measure_this_run();
  const std::vector<Claim> claims = claims_of(results);
  const Document document = build_report(results, claims, this_run, artist);
  write_figures(folder / "figures", document);
  write_file(folder / "results.json", results_json(results, claims, this_run));
  write_file(folder / "report.md", markdown_of(document, "figures"));
  write_file(folder / "report.html", html_of(document));
  print_claims(claims);
  print_line(fmt::format("report written to {}", (folder / "report.html").string()));
  return kDone;
}

}  // namespace

void add_reproduce(Verb& program) {
  Verb verb = program.add_verb(
      "reproduce", "Repeat the thesis' experiments on the simulated rig and write a report");
  verb.set_footer(
      "Example:\n  fathom reproduce report\n\n"
      "Writes report.html (which needs nothing beside it), report.md with figures/, and "
      "results.json.\nTakes three minutes of processor time, --quick half of one, shared out to "
      "all processors;\nall numbers but the computing times come from fixed seeds.");
  auto arguments = std::make_shared<Arguments>();
  verb.add_option("OUT", arguments->folder, "Folder for the report; made if missing").required();
  verb.add_flag("--quick", arguments->quick, "A few runs of everything, to see that it works");
  verb.on_run([arguments] { return run(*arguments); });
}

}  // namespace fathom::cli
