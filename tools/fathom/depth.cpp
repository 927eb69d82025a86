// SPDX-License-Identifier: Apache-2.0
// fathom depth: a map of depth with its uncertainty, and the all-in-focus picture.
#include <algorithm>
#include <charconv>
#include <chrono>
#include <filesystem>

#include "backends/backends.hpp"
#include "engine/error.hpp"
#include "engine/file.hpp"
#include "engine/json.hpp"
#include "engine/printable.hpp"
#include "mapping/report.hpp"
#include "mapping/writing.hpp"
#include "tools/fathom/arguments.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/depth/blocks.hpp"
#include "tools/fathom/depth/growing_map.hpp"
#include "tools/fathom/depth/regions.hpp"
#include "tools/fathom/depth/stacks.hpp"
#include "tools/fathom/depth/taking.hpp"
#include "tools/fathom/patience.hpp"
#include "tools/fathom/run_keeping.hpp"
#include "tools/fathom/verbs.hpp"

namespace fathom::cli {

using namespace mapping;

namespace {

using Clock = std::chrono::steady_clock;

struct Arguments {
  std::string rig;
  std::vector<std::string> stacks;  // instead of a rig
  std::string shard;                // or empty
  std::string calibration;
  std::string window = "auto";
  std::optional<int> stride;
  std::optional<double> from, to, step;
  int average = 1;
  std::string align = "similarity";
  bool is_filled = false;
  ExtraFiles extra;
  std::string regions, csv;
  std::string backend;
  DeviceOptions device;
  std::string output = "depth";
  bool json = false;
};

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

DepthOptions depth_options(const Arguments& arguments) {
  DepthOptions options;
  options.stride = arguments.stride.value_or(0);
  if (arguments.window == "auto") return options;
  int side = 0;
  const char* const end = arguments.window.data() + arguments.window.size();
  const auto [next, problem] = std::from_chars(arguments.window.data(), end, side);
  if (problem != std::errc() || next != end) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("--window {}: write the side of a window in pixels, or auto",
                            arguments.window));
  }
  options.sides = {side};
  return options;
}

/// A grid of windows needs a picture that holds one.
void require_room(const DepthOptions& options, int width_px, int height_px) {
  const int room = std::min(width_px, height_px);
  const auto require = [&](const char* option, int size) {
    if (size <= room) return;
    throw Error(ErrorCode::bad_argument,
                fmt::format("{} {} is more than pictures of {} x {} px have room for", option, size,
                            width_px, height_px));
  };
  for (const int side : options.sides) require("--window", side);
  require("--stride", options.stride);
}

/// A run of the verb: what it knows by now.
class DepthRun {
 public:
  explicit DepthRun(const Arguments& arguments) : arguments_(arguments) {
    if (!arguments.regions.empty()) {
      constexpr std::uintmax_t kLargest = 64 << 20;
      regions_ = parse_regions(read_file(arguments.regions, kLargest), arguments.regions);
    }
    facts_.calibration = arguments.calibration;
    facts_.window = arguments.window;
    facts_.stride = arguments.stride;
    facts_.is_filled = arguments.is_filled;
    facts_.align = arguments.align;
  }

  void make() {
    require_sweep_options(taking_request());
    folder_.emplace(arguments_.output);  // what cannot be written costs no measurement
    Taking taking(taking_request());
    require(taking.facts());
    if (calibration_) taking.use(*calibration_);
    const auto start = Clock::now();
    DepthMaker maker = take(taking);
    if (const auto growth = taking.growth()) facts_.growth = {growth->told, growth->fitted};
    was_stopped_ = taking.was_stopped();
    facts_.read_seconds = seconds_since(start);
    finish(maker);
    result_.spacing_um = taking.facts().spacing_um;
  }

  void write() {
    summary_ = summary_of(result_.maps);
    facts_.made = utc_now();
    write_map(result_, summary_, arguments_.extra, facts_, *folder_);
    if (!arguments_.csv.empty()) write_file(arguments_.csv, regions_csv(result_, regions_));
    folder_->move_in();
  }

  /// Prints what there is. Returns the exit status: whether it is of all pictures, and whether anything
  /// has a depth.
  ExitStatus tell() const {
    print();
    if (was_stopped_) return kError;     // and taking has said so
    constexpr double kNothing = 0.0005;  // 0.0 % in print
    if (summary_.part(DepthClass::known, result_.pixels()) >= kNothing) return kDone;
    note(nothing_words());
    return kNoFocus;
  }

  /// Of one stack of several, as a row of a table.
  void tell_row(const std::string& stack) const {
    JsonLine row;
    row.add("stack", stack)
        .add("folder", arguments_.output)
        .add("frames", result_.positions.size())
        .add("unit", result_.unit)
        .add("known", summary_.part(DepthClass::known, result_.pixels()));
    if (summary_.numbers > 0) {
      row.add("low", summary_.low)
          .add("high", summary_.high)
          .add("median_sigma", summary_.median_sigma);
    }
    print_line(row.text());
  }

 private:
  void print() const {
    if (arguments_.json) return print_lines(report_json(result_, summary_, facts_));
    if (summary_.numbers > 0) {
      constexpr int kWidest = 72;
      for (const std::string& line : depth_blocks(result_.maps, summary_.low, summary_.high,
                                                  std::min(kWidest, terminal_columns())))
        print_line(line);
      print_line(fmt::format(
          "0 is {:.5g} {unit}, 9 is {:.5g} {unit}; sigma {:.2g} {unit} in the "
          "middle",
          summary_.low, summary_.high, summary_.median_sigma, fmt::arg("unit", result_.unit)));
    }
    print_line(parts_words());
    print_line(fmt::format("{} frames of {:.3g} megapixels in {:.2f} s, {:.0f} MB at most: {}",
                           result_.positions.size(), megapixels(),
                           facts_.read_seconds + facts_.map_seconds + facts_.write_seconds,
                           peak_memory_mb(), printable(arguments_.output + "/view.html")));
  }

  /// Why nothing has a depth: what most of the picture is.
  std::string nothing_words() const {
    const auto part = [this](DepthClass value) { return summary_.part(value, result_.pixels()); };
    if (part(DepthClass::at_end) > part(DepthClass::no_texture))
      return "nothing has a depth: the pictures are sharpest at an end of the range, or beyond it; "
             "widen the range";
    if (part(DepthClass::outside) > part(DepthClass::no_texture))
      return "nothing has a depth: few frames show the same places, or the calibration does not "
             "cover them";
    return "nothing has a depth: nothing changes with the lens beyond noise; look for texture, "
           "light and a range that the focus lies in";
  }

  double megapixels() const { return 1e-6 * static_cast<double>(result_.pixels()); }

  std::string parts_words() const {
    std::string words;
    for (const DepthClass value : kAllDepthClasses) {
      const double part = summary_.part(value, result_.pixels());
      if (part > 0 || value == DepthClass::known)
        words +=
            fmt::format("{}{} {:.1f} %", words.empty() ? "" : ", ", to_string(value), 100 * part);
    }
    return words;
  }

  OpenDevice opener() {
    return [this](const MetricSpec& spec, std::size_t windows) {
      Selection selection =
          select_device(all_backends(), arguments_.backend, spec, windows, arguments_.device);
      facts_.backend = selection.backend;
      return selection;
    };
  }

  TakingRequest taking_request() const {
    return {.rig = arguments_.rig,
            .from = arguments_.from,
            .to = arguments_.to,
            .step = arguments_.step,
            .average = arguments_.average,
            .align = parse_alignment(arguments_.align),
            .needs_all = !arguments_.stacks.empty()};
  }

  void require(const StackFacts& stack) {
    require_room(depth_options(arguments_), stack.shape.width_px, stack.shape.height_px);
    require_inside(regions_, stack.shape.width_px, stack.shape.height_px);
    if (!arguments_.calibration.empty())
      calibration_ = load_calibration(arguments_.calibration, stack.unit);
    facts_.frames_expected = stack.positions.size();
    result_.lens_unit = stack.unit;
  }

  DepthMaker take(Taking& taking) {
    DepthOptions options = depth_options(arguments_);
    options.blur = taking.facts().lens_blur;
    if (!options.blur && calibration_) options.blur = calibration_->conditions().blur;
    GrowingMap map;
    TakingBar bar("depth");
    const bool grows = taking.facts().is_live && map.is_live();
    return taking.take(opener(), options, grows ? static_cast<TakingView&>(map) : bar);
  }

  void finish(DepthMaker& maker) {
    facts_.moved_px = maker.moved_px();
    const auto start = Clock::now();
    const std::string lens_unit = result_.lens_unit;
    result_ = maker.finish(arguments_.is_filled);
    result_.rig = arguments_.rig;
    result_.lens_unit = result_.unit = lens_unit;
    if (calibration_) {
      make_metric(result_.maps, *calibration_);
      result_.unit = "mm";
    }
    facts_.map_seconds = seconds_since(start);
  }

  const Arguments& arguments_;
  std::optional<OutputFolder> folder_;
  std::vector<Window> regions_;
  std::optional<Calibration> calibration_;
  ReportFacts facts_;
  DepthResult result_;
  DepthSummary summary_;
  bool was_stopped_ = false;
};

/// The files of a map among the pictures of a stack would be taken for some of them.
void require_other_folder(const Arguments& arguments) {
  std::error_code ignored;
  if (!std::filesystem::equivalent(played_by(arguments.rig), arguments.output, ignored)) return;
  throw Error(ErrorCode::bad_argument,
              fmt::format("{} holds the stack; a map takes a folder of its own", arguments.output));
}

/// Of all that decides which maps the shards of a run make, but the stacks.
std::string choices_of(const Arguments& a) {
  return fmt::format("depth {} {} {} {} {} {} {}", a.calibration, a.window, a.stride.value_or(0),
                     a.align, a.is_filled, a.extra.sharp_tiff, a.output);
}

int run_stacks(const Arguments& arguments) {
  const StacksRequest request = {.stacks = arguments.stacks,
                                 .output = arguments.output,
                                 .shard = arguments.shard,
                                 .choices = choices_of(arguments)};
  return map_stacks(request, [&](const std::string& stack, const std::string& folder) {
    Arguments one = arguments;
    one.rig = "replay:" + stack;
    one.output = folder;
    require_other_folder(one);
    DepthRun depth(one);
    depth.make();
    depth.write();
    depth.tell_row(stack);
  });
}

/// Several stacks have neither a sweep nor one file of regions.
void require_stacks(const Arguments& arguments) {
  if (arguments.rig.empty() == arguments.stacks.empty()) {
    throw Error(ErrorCode::bad_argument,
                "give --rig, or stacks: folders and TIFFs, each mapped in a folder of its own");
  }
  if (arguments.stacks.empty()) {
    if (arguments.shard.empty()) return;
    throw Error(ErrorCode::bad_argument, "--shard deals out stacks; give them instead of --rig");
  }
  if (arguments.from || arguments.to || arguments.step || !arguments.regions.empty()) {
    throw Error(ErrorCode::bad_argument,
                "--from, --to, --step, --regions and --csv are of one stack; give it as --rig");
  }
  if (!arguments.json)
    throw Error(ErrorCode::bad_argument, "stacks print a row each, which takes --json");
}

int run(const Arguments& arguments) {
  require_stacks(arguments);
  parse_alignment(arguments.align);
  depth_options(arguments);  // wrong usage is said before anything is read
  if (arguments.csv.empty() != arguments.regions.empty()) {
    throw Error(ErrorCode::bad_argument,
                "--csv and --regions go together: the one is written, of what the other names");
  }
  if (!arguments.stacks.empty()) return run_stacks(arguments);
  require_separate({arguments.rig, arguments.calibration, arguments.regions}, {arguments.csv});
  require_other_folder(arguments);
  DepthRun depth(arguments);
  depth.make();
  depth.write();
  return depth.tell();
}

}  // namespace

void add_depth(Verb& program) {
  Verb verb = program.add_verb(
      "depth", "Map the depth of every pixel of a stack or a sweep, and make its sharp picture");
  verb.set_footer(
      "Examples:\n  fathom depth --rig replay:stack/ -o map/\n"
      "  fathom depth --rig sim:target=slant --calibration cal.json --from 800 --to 1100 --ply\n"
      "  fathom depth plate/*.ome.tif --json --shard 1/8 -o maps > part1.json\n\n"
      "The folder gets depth.tif, sigma.tif, confidence.tif and index.tif (numbers), sharp.png,\n"
      "depth.png, hill.png and class.png (pictures), report.json, and view.html to look at.");
  auto arguments = std::make_shared<Arguments>();
  arguments->device.on_work = patient_words();
  add_rig_option(verb, arguments->rig, false);
  verb.add_option(
      "stacks", arguments->stacks,
      "Instead of --rig: folders and TIFFs, each mapped in OUTPUT/NAME, a row of --json "
      "each");
  verb.add_option("--shard", arguments->shard,
                  "I/N: the I-th of N parts of the stacks; fathom merge makes one table of all");
  verb.add_option("--calibration", arguments->calibration,
                  "What fathom calibrate made: depth is then in mm");
  verb.add_option("--window", arguments->window,
                  "Side of the windows in pixels, or auto: several, weighed by what they tell")
      .shows_default();
  verb.add_option("--stride", arguments->stride,
                  "Pixels between windows (default: as dense as the number of frames allows)")
      .at_least_one();
  verb.add_option("--align", arguments->align,
                  "How the picture may move with the lens: similarity (it grows, turns, shifts), "
                  "scale (it grows), or none")
      .shows_default();
  verb.add_option("--from", arguments->from,
                  "First lens position of a live sweep (default: the lens's lowest)");
  verb.add_option("--to", arguments->to, "Last one (default: the lens's highest)");
  verb.add_option("--step", arguments->step, "Distance between them (default: some hundred)");
  verb.add_option("--average", arguments->average, "Frames averaged at each of them")
      .shows_default();
  verb.add_flag("--fill", arguments->is_filled,
                "Close what has no depth smoothly; class.png says where");
  verb.add_flag("--ply", arguments->extra.ply, "Write depth.ply, a surface with colours, too");
  verb.add_flag("--obj", arguments->extra.obj, "Write depth.obj, the same for other programs");
  verb.add_flag("--sharp-tiff", arguments->extra.sharp_tiff, "Write sharp.tif, not sharp.png");
  verb.add_option("--regions", arguments->regions,
                  "File of windows, x,y,n a line, whose depths --csv gets");
  verb.add_option("--csv", arguments->csv, "File for position, sigma and verdict of --regions");
  verb.add_option("--backend", arguments->backend,
                  "auto, NAME or NAME:DEVICE as fathom devices lists them (default: "
                  "$FATHOM_BACKEND, else auto)");
  verb.add_option("--threads", arguments->device.threads,
                  "Processors that may compute (default: $FATHOM_THREADS, else all)")
      .at_least_one();
  verb.add_option("-o,--output", arguments->output, "Folder for the files").shows_default();
  verb.add_flag("--json", arguments->json, "Print report.json on standard output");
  verb.on_run([arguments] { return run(*arguments); });
}

}  // namespace fathom::cli
