// SPDX-License-Identifier: Apache-2.0
// fathom score: the focus quality of windows of picture files.
#include <algorithm>
#include <charconv>
#include <chrono>
#include <limits>

#include "backends/backends.hpp"
#include "engine/error.hpp"
#include "engine/scorer.hpp"
#include "engine/windowed_metric.hpp"
#include "pictures/picture.hpp"
#include "tools/fathom/arguments.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/score_rows.hpp"
#include "tools/fathom/verbs.hpp"

namespace fathom::cli {
namespace {

struct Arguments {
  std::vector<std::string> images;
  MetricArguments metric;
  std::optional<int> grid;
  std::string page = "0";
  bool json = false;
};

/// How many windows the next call takes: what takes about a tenth of a second, so that rows and
/// Ctrl-C do not wait long, however slow the backend is.
class Pace {
 public:
  explicit Pace(std::size_t most) : most_(most) {}

  std::size_t windows() const { return windows_; }
  void took(std::chrono::steady_clock::duration time) {
    constexpr std::chrono::milliseconds kShort(50), kLong(200);
    if (time < kShort) windows_ = std::min(2 * windows_, most_);
    if (time > kLong) windows_ = std::max<std::size_t>(windows_ / 2, 1);
  }

 private:
  std::size_t most_;
  std::size_t windows_ = 1;
};

/// Keeps the plan between pictures of one shape; another shape may mean another N.
class Pictures {
 public:
  explicit Pictures(const Arguments& arguments) : arguments_(arguments) {}

  void score(const std::string& image, std::size_t page, const Frame& frame) {
    const WindowedMetric aim =
        resolve_window(arguments_.metric.metric, arguments_.metric.chosen_window(),
                       frame.width_px(), frame.height_px());
    const WindowGrid grid = grid_of(frame, aim);
    prepare(aim.spec, grid);
    ScoreRows rows(arguments_.json ? RowFormat::json : RowFormat::text,
                   {image, page, aim.spec, scorer_->selection().backend});
    Pace pace(scorer_->batch());
    Progress progress;
    for (std::size_t done = 0; done < grid.size();) {
      const std::size_t count = std::min(pace.windows(), grid.size() - done);
      const auto start = std::chrono::steady_clock::now();
      values_.resize(count * scorer_->outputs());
      scorer_->score(frame, done, values_);
      pace.took(std::chrono::steady_clock::now() - start);
      print(rows, done, progress);
      done += count;
      if (grid.size() > 1) progress.bar("score", done, grid.size());
      if (stop_requested()) throw Error(ErrorCode::cancelled, "stopped on request");
    }
  }

 private:
  WindowGrid grid_of(const Frame& frame, const WindowedMetric& aim) const {
    // Without a grid, the one window of a stride that leaves every picture.
    constexpr int kOneWindow = std::numeric_limits<int>::max();
    // A window that was asked for is the grid's first; the default one only gives its side.
    const bool from_corner = arguments_.grid && arguments_.metric.window.empty();
    return WindowGrid(frame.width_px(), frame.height_px(),
                      from_corner ? Window{0, 0, aim.spec.n} : aim.window,
                      arguments_.grid.value_or(kOneWindow));
  }

  void prepare(const MetricSpec& spec, const WindowGrid& grid) {
    const std::size_t batch = std::min(grid.size(), full_batch(spec.n));
    if (scorer_ && scorer_->spec() == spec && scorer_->batch() >= batch) return scorer_->aim(grid);
    scorer_.reset();
    scorer_.emplace(select_device(all_backends(), arguments_.metric.backend, spec, batch,
                                  arguments_.metric.device),
                    spec, grid);
  }

  void print(ScoreRows& rows, std::size_t first, Progress& progress) const {
    rows.clear();
    const std::size_t outputs = scorer_->outputs();
    const std::span<const double> values = values_;
    for (std::size_t i = 0; i * outputs < values.size(); ++i)
      rows.add(scorer_->windows()[first + i], values.subspan(i * outputs, outputs));
    progress.clear();
    print_lines(rows.text());
  }

  const Arguments& arguments_;
  std::optional<Scorer> scorer_;
  std::vector<double> values_;  // of the batch at hand
};

std::vector<std::size_t> pages_of(const std::string& text, std::size_t page_count) {
  std::vector<std::size_t> pages;
  if (text == "all") {
    for (std::size_t page = 0; page < page_count; ++page) pages.push_back(page);
    return pages;
  }
  std::size_t page = 0;
  const char* const end = text.data() + text.size();
  const auto [next, problem] = std::from_chars(text.data(), end, page);
  if (problem != std::errc() || next != end) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("--page {}: write a number from 0, or all", text));
  }
  return {page};
}

/// A bad picture costs only itself: the others are scored, and the exit status tells.
int run(const Arguments& arguments) {
  arguments.metric.chosen_window();  // wrong usage is said before any file is read
  MetricSpec::parse(arguments.metric.metric);
  pages_of(arguments.page, 1);
  Pictures pictures(arguments);
  int status = kDone;
  for (const std::string& image : arguments.images) {
    try {
      PictureFile file(image);
      for (const std::size_t page : pages_of(arguments.page, file.page_count())) {
        pictures.score(image, page, file.read(page));
      }
    } catch (const Error& error) {
      if (arguments.images.size() == 1 || error.code() == ErrorCode::cancelled) throw;
      const std::string what = error.what();
      note(what.find(image) == std::string::npos ? image + ": " + what : what);
      status = kError;
    }
  }
  return status;
}

}  // namespace

void add_score(Verb& program) {
  Verb verb = program.add_verb("score", "Score the focus of windows of pictures");
  verb.set_footer(
      "Examples:\n  fathom score photo.png --window 96,88,64 --metric walsh-sequency\n"
      "  fathom score stack.tif --page all --grid 32 --json");
  auto arguments = std::make_shared<Arguments>();
  verb.add_option("images", arguments->images, "PNG, JPEG, TIFF or PGM files").required();
  arguments->metric.add_to(verb, true);
  verb.add_option("--grid", arguments->grid,
                  "Score windows every STRIDE px over the picture, from --window on if given")
      .at_least_one();
  verb.add_option("--page", arguments->page, "Page of a multi-page TIFF, from 0, or all")
      .shows_default();
  verb.add_flag("--json", arguments->json, "One JSON object a line on standard output");
  verb.on_run([arguments] { return run(*arguments); });
}

}  // namespace fathom::cli
