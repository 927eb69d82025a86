// SPDX-License-Identifier: Apache-2.0
// fathom score: the focus quality of windows of picture files.
#include <algorithm>
#include <charconv>
#include <chrono>
#include <limits>

#include "backends/backends.hpp"
#include "engine/cache.hpp"
#include "engine/error.hpp"
#include "engine/scorer.hpp"
#include "engine/windowed_metric.hpp"
#include "hal/drivers/replay/planes.hpp"
#include "pictures/picture.hpp"
#include "tools/fathom/arguments.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/score_rows.hpp"
#include "tools/fathom/shard.hpp"
#include "tools/fathom/verbs.hpp"
#include "words/finding_words.hpp"

namespace fathom::cli {
namespace {

struct Arguments {
  std::vector<std::string> images;
  MetricArguments metric;
  std::optional<int> grid;
  std::string page = "0";
  std::string colour;
  double scale = 0;
  bool json = false;
  std::string shard;  // or empty
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

  void score(const std::string& image, std::size_t page, const PagePlace& place,
             const Frame& frame) {
    const WindowedMetric aim =
        resolve_window(arguments_.metric.metric, arguments_.metric.chosen_window(),
                       frame.width_px(), frame.height_px());
    const WindowGrid grid = grid_of(frame, aim);
    prepare(aim.spec, grid);
    ScoreRows rows(arguments_.json ? RowFormat::json : RowFormat::text,
                   {.image = image,
                    .page = page,
                    .place = place,
                    .spec = aim.spec,
                    .backend = scorer_->selection().backend});
    Pace pace(scorer_->batch());
    Progress progress;
    for (std::size_t done = 0; done < grid.size();) {
      const std::size_t count = std::min(pace.windows(), grid.size() - done);
      const auto start = std::chrono::steady_clock::now();
      values_.resize(count * scorer_->outputs());
      scorer_->score(frame, done, values_);
      pace.took(std::chrono::steady_clock::now() - start);
      print(rows, done, progress);
      rows_ += count;
      done += count;
      if (grid.size() > 1) progress.bar("score", done, grid.size());
      if (stop_requested()) throw Error(ErrorCode::cancelled, "stopped on request");
    }
  }

  /// How many were printed.
  std::size_t rows() const { return rows_; }

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
  std::size_t rows_ = 0;
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

PictureOptions picture_options(const Arguments& arguments) {
  PictureOptions options{.colour = Colour::luma, .scale = arguments.scale};
  if (!(arguments.scale >= 0)) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("--scale {} is no number from 0", arguments.scale));
  }
  if (arguments.colour.empty()) return options;
  const auto colour = replay::colour_named(arguments.colour);
  if (!colour) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("--channel {}: write r, g or b; pages are chosen with --page",
                            arguments.colour));
  }
  options.colour = *colour;
  return options;
}

/// What a user should know of a file before believing its scores.
void say_contents(const std::string& image, const PictureContents& contents) {
  if (contents.previews > 0) note(words_for(SkippedPreviews{image, contents.previews}));
  if (contents.samples_as_pages > 0)
    note(words_for(SamplesAsPictures{image, contents.samples_as_pages}));
  if (contents.is_description_damaged) note(words_for(DamagedDescription{image}));
  for (const std::string& word : contents.words) note(words_for(LibraryWord{image, word}));
}

/// Of all that decides which rows the shards of a run print.
std::uint64_t hash_of_command(const Arguments& arguments) {
  std::string text = fmt::format("{} {} {} {} {} {}", arguments.page, arguments.metric.metric,
                                 arguments.metric.window, arguments.grid.value_or(0),
                                 arguments.colour, arguments.scale);
  for (const std::string& image : arguments.images) text += '\0' + image;
  return hash_of(text);
}

/// A bad page costs only itself: the others are scored, and the exit status tells.
class PageByPage {
 public:
  explicit PageByPage(const Arguments& arguments)
      : arguments_(arguments), options_(picture_options(arguments)), pictures_(arguments) {
    if (!arguments.shard.empty()) shard_ = Shard::parse(arguments.shard);
  }

  int score_all() {
    const auto [first, last] = is_shard_of_pages() ? std::pair(std::size_t{0}, std::size_t{1})
                                                   : shard_.part_of(arguments_.images.size());
    for (std::size_t i = first; i < last; ++i) {
      const std::string& image = arguments_.images[i];
      guarded(image, is_alone(arguments_.images.size()), [&] { score(image); });
    }
    if (is_sharded()) print_line(end().text());
    return status_;
  }

 private:
  bool is_sharded() const { return !arguments_.shard.empty(); }
  /// Several pictures are dealt out whole; one picture page by page.
  bool is_shard_of_pages() const { return arguments_.images.size() == 1; }
  /// What is all of a run fails it. A shard goes on to its end: others have the rest.
  bool is_alone(std::size_t things) const { return things == 1 && !is_sharded(); }
  bool is_last_shard() const { return !is_shard_of_pages() || shard_.number == shard_.count; }

  ShardEnd end() const {
    return {.shard = shard_,
            .command = hash_of_command(arguments_),
            .rows = pictures_.rows(),
            .failed = failed_};
  }

  void score(const std::string& image) {
    PictureFile file(image, options_);
    say_contents(image, file.contents());
    const auto pages = pages_of(arguments_.page, file.page_count());
    const bool alone = arguments_.images.size() == 1 && is_alone(pages.size());
    const auto [first, last] = is_shard_of_pages() ? shard_.part_of(pages.size())
                                                   : std::pair(std::size_t{0}, pages.size());
    for (std::size_t i = first; i < last; ++i) {
      const std::size_t page = pages[i];
      guarded(image, alone, [&] {
        pictures_.score(image, page, place_of(file.contents(), page), file.read(page));
      });
    }
    if (arguments_.page == "all" && is_last_shard()) tell_lost(image, file.contents().lost);
  }

  void tell_lost(const std::string& image, std::size_t pages) {
    if (pages == 0) return;
    note(fmt::format("{}: {} that it promises {} beyond its end", image,
                     pages == 1 ? "one more page" : fmt::format("{} more pages", pages),
                     pages == 1 ? "lies" : "lie"));
    failed_ += pages;
    status_ = kError;
  }

  /// Goes on after an error, unless it is of all that was asked for.
  template <class Body>
  void guarded(const std::string& image, bool is_alone, Body body) {
    try {
      body();
    } catch (const OutputError&) {
      throw;  // the next picture's rows would go nowhere either
    } catch (const Error& error) {
      if (is_alone || error.code() == ErrorCode::cancelled) throw;
      const std::string what = error.what();
      note(what.find(image) == std::string::npos ? image + ": " + what : what);
      ++failed_;
      status_ = kError;
    }
  }

  const Arguments& arguments_;
  PictureOptions options_;
  Pictures pictures_;
  Shard shard_;
  std::size_t failed_ = 0;
  int status_ = kDone;
};

int run(const Arguments& arguments) {
  arguments.metric.chosen_window();  // wrong usage is said before any file is read
  MetricSpec::parse(arguments.metric.metric);
  pages_of(arguments.page, 1);
  if (!arguments.shard.empty() && !arguments.json)
    throw Error(ErrorCode::bad_argument, "--shard prints what fathom merge reads: add --json");
  return PageByPage(arguments).score_all();
}

}  // namespace

void add_score(Verb& program) {
  Verb verb = program.add_verb("score", "Score the focus of windows of pictures");
  verb.set_footer(
      "Examples:\n  fathom score photo.png --window 96,88,64 --metric walsh-sequency\n"
      "  fathom score stack.tif --page all --grid 32 --json\n"
      "  fathom score plate/*.tif --json --shard 3/8 > part3.json    # then fathom merge");
  auto arguments = std::make_shared<Arguments>();
  verb.add_option("images", arguments->images, "PNG, JPEG, TIFF or PGM files").required();
  arguments->metric.add_to(verb, true);
  verb.add_option("--grid", arguments->grid,
                  "Score windows every STRIDE px over the picture, from --window on if given")
      .at_least_one();
  verb.add_option("--page", arguments->page, "Page of a multi-page TIFF, from 0, or all")
      .shows_default();
  verb.add_option("--channel", arguments->colour,
                  "r, g or b: that colour of colour pictures alone (default: their luma)");
  verb.add_option("--scale", arguments->scale,
                  "What samples of TIFFs with floating point or 32 bits are multiplied by");
  verb.add_option("--shard", arguments->shard,
                  "I/N: only the I-th of N equal parts of the images, or of one image's pages");
  verb.add_flag("--json", arguments->json, "One JSON object a line on standard output");
  verb.on_run([arguments] { return run(*arguments); });
}

}  // namespace fathom::cli
