// SPDX-License-Identifier: Apache-2.0
// fathom score: the focus quality of windows of picture files.
#include <algorithm>
#include <charconv>

#include "backends/backends.hpp"
#include "engine/error.hpp"
#include "engine/selection.hpp"
#include "engine/windowed_metric.hpp"
#include "pictures/picture.hpp"
#include "tools/fathom/arguments.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/verbs.hpp"

namespace fathom::cli {
namespace {

/// Windows of one call: enough to fill a device, few enough that results keep flowing.
constexpr std::size_t kBatch = 256;

struct Arguments {
  std::vector<std::string> images;
  MetricArguments metric;
  std::optional<int> grid;
  std::string page = "0";
  bool json = false;
};

/// Keeps the plan between pictures of one shape; another shape may mean another N.
class Scorer {
 public:
  explicit Scorer(const Arguments& arguments) : arguments_(arguments) {}

  void score(const std::string& image, std::size_t page, const Frame& frame) {
    const WindowedMetric aim =
        resolve_window(arguments_.metric.metric, arguments_.metric.chosen_window(),
                       frame.width_px(), frame.height_px());
    // A window that was asked for is the grid's first; the default one only gives its side.
    const Window first = arguments_.metric.window.empty() ? Window{0, 0, aim.spec.n} : aim.window;
    const auto windows =
        arguments_.grid ? window_grid(frame.width_px(), frame.height_px(), first, *arguments_.grid)
                        : std::vector<Window>{aim.window};
    prepare(aim.spec, windows.size());
    Progress progress;
    for (std::size_t done = 0; done < windows.size();) {
      const auto batch =
          std::span(windows).subspan(done, std::min(plan_->capacity(), windows.size() - done));
      scores_.resize(batch.size());
      plan_->score(frame, batch, scores_);
      for (std::size_t i = 0; i < batch.size(); ++i) print(image, page, batch[i], scores_[i]);
      flush_lines();
      done += batch.size();
      if (windows.size() > 1) progress.bar("score", done, windows.size());
      if (stop_requested()) throw Error(ErrorCode::cancelled, "stopped on request");
    }
  }

 private:
  void prepare(const MetricSpec& spec, std::size_t windows) {
    const std::size_t capacity = std::min(windows, kBatch);
    if (plan_ && plan_->spec() == spec && plan_->capacity() >= capacity) return;
    plan_.reset();
    selection_ = select_device(all_backends(), arguments_.metric.backend, spec,
                               windows > 1 ? Workload::batches : Workload::single_windows,
                               arguments_.metric.device);
    plan_ = selection_.device->plan(spec, capacity);
  }

  void print(const std::string& image, std::size_t page, const Window& window, double score) const {
    if (arguments_.json) {
      fmt::print("{}\n", JsonLine()
                             .add("image", image)
                             .add("page", page)
                             .add("x", window.x)
                             .add("y", window.y)
                             .add("n", window.n)
                             .add("metric", plan_->spec().text())
                             .add("backend", selection_.backend)
                             .add("score", score)
                             .text());
    } else {
      fmt::print("{:<14.9g} {} page {} window {} {}\n", score, image, page, to_string(window),
                 plan_->spec().text());
    }
  }

  const Arguments& arguments_;
  Selection selection_;
  std::unique_ptr<Plan> plan_;
  std::vector<double> scores_;
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
  Scorer scorer(arguments);
  int status = kDone;
  for (const std::string& image : arguments.images) {
    try {
      PictureFile file(image);
      for (const std::size_t page : pages_of(arguments.page, file.page_count())) {
        scorer.score(image, page, file.read(page));
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

void add_score(CLI::App& app, int& status) {
  auto* const verb = app.add_subcommand("score", "Score the focus of windows of pictures");
  verb->footer(
      "Examples:\n  fathom score photo.png --window 96,88,64 --metric walsh-sequency\n"
      "  fathom score stack.tif --page all --grid 32 --json");
  auto arguments = std::make_shared<Arguments>();
  verb->add_option("images", arguments->images, "PNG, JPEG, TIFF or PGM files")->required();
  arguments->metric.add_to(*verb);
  verb->add_option("--grid", arguments->grid,
                   "Score windows every STRIDE px over the picture, from --window on if given");
  verb->add_option("--page", arguments->page, "Page of a multi-page TIFF, from 0, or all")
      ->capture_default_str();
  verb->add_flag("--json", arguments->json, "One JSON object a line on standard output");
  verb->callback([arguments, &status] { status = run(*arguments); });
}

}  // namespace fathom::cli
