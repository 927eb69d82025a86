// SPDX-License-Identifier: Apache-2.0
// fathom_stacks: real focal stacks, and whether the default search finds in random windows what an
// independent measure finds there.
//   fathom_stacks [--windows N] [--seed N] [--metric TEXT] [--list] FOLDER...
// Every folder below FOLDER that holds pictures is a stack, and so is every TIFF with three pages or
// more. Windows count that have one clear peak by the variance of the Laplacian.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "bench/honesty/thesis_rig.hpp"
#include "engine/error.hpp"
#include "session/session.hpp"

namespace fathom::honesty {
namespace {

namespace fs = std::filesystem;

struct Wishes {
  int windows = 20;  ///< Of each stack.
  unsigned seed = 1;
  std::string metric = kSearchMetric;
  bool list = false;
  std::vector<fs::path> folders;
};

struct Tally {
  int windows = 0, right = 0, declined = 0, sure_and_wrong = 0;
};

bool is_tiff(const fs::path& path) {
  return path.extension() == ".tif" || path.extension() == ".tiff";
}

/// Whatever opens as a recording of three pictures or more is a stack.
std::set<fs::path> candidates_in(const fs::path& folder) {
  std::set<fs::path> places;
  if (!fs::is_directory(folder)) return {folder};
  places.insert(folder);
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_directory() || is_tiff(entry.path())) places.insert(entry.path());
  }
  return places;
}

/// Mean of 3 x 3 pixels, times nine: noise of single pixels is no texture.
double smooth_at(const Frame& frame, int x, int y) {
  double sum = 0;
  for (int row = y - 1; row <= y + 1; ++row) {
    for (int col = x - 1; col <= x + 1; ++col) sum += frame.at(col, row);
  }
  return sum;
}

/// Variance of the Laplacian, over the squared mean grey value.
double detail_of(const Frame& frame, const Window& window) {
  constexpr int kMargin = 3;
  double sum = 0, squares = 0, greys = 0, count = 0;
  for (int y = window.y + kMargin; y < window.y + window.n - kMargin; ++y) {
    for (int x = window.x + kMargin; x < window.x + window.n - kMargin; ++x) {
      const double middle = smooth_at(frame, x, y);
      const double laplacian = smooth_at(frame, x - 2, y) + smooth_at(frame, x + 2, y) +
                               smooth_at(frame, x, y - 2) + smooth_at(frame, x, y + 2) - 4 * middle;
      sum += laplacian;
      squares += laplacian * laplacian;
      greys += middle;
      ++count;
    }
  }
  const double mean = greys / count;
  return mean > 0 ? (squares / count - std::pow(sum / count, 2)) / (mean * mean) : 0;
}

/// Index of the one clear peak: inside, twice as high as the lowest, with no other of 0.4 of its height.
std::optional<double> clear_peak(const std::vector<double>& detail) {
  constexpr double kContrast = 2, kOther = 0.4;
  const auto best =
      static_cast<std::size_t>(std::max_element(detail.begin(), detail.end()) - detail.begin());
  const double floor = *std::min_element(detail.begin(), detail.end());
  if (best == 0 || best + 1 == detail.size() || detail[best] < kContrast * floor)
    return std::nullopt;
  const double most = floor + kOther * (detail[best] - floor);
  std::size_t first = best, last = best;
  while (first > 0 && detail[first - 1] < detail[first]) --first;
  while (last + 1 < detail.size() && detail[last + 1] < detail[last]) ++last;
  for (std::size_t i = 0; i < detail.size(); ++i) {
    if ((i < first || i > last) && detail[i] > most) return std::nullopt;
  }
  const double left = detail[best - 1], right = detail[best + 1];
  const double bend = left - 2 * detail[best] + right;
  return static_cast<double>(best) + (bend < 0 ? (left - right) / (2 * bend) : 0);
}

/// A position as a number of a picture.
double index_of(const std::vector<double>& stops, double position) {
  const auto above = std::upper_bound(stops.begin(), stops.end(), position);
  if (above == stops.begin()) return 0;
  if (above == stops.end()) return static_cast<double>(stops.size() - 1);
  const auto below = std::prev(above);
  return static_cast<double>(below - stops.begin()) + (position - *below) / (*above - *below);
}

std::vector<Frame> pictures_of(Rig& rig) {
  std::vector<Frame> pictures;
  for (const double stop : rig.lens().info().stops)
    pictures.push_back(shoot(rig.camera(), rig.lens(), stop, {}).frame.clone());
  return pictures;
}

class Stack {
 public:
  Stack(const fs::path& place, const Wishes& wishes) : wishes_(wishes) {
    options_.rig = "replay:" + place.string();
    options_.metric = wishes.metric;
    Rig rig(options_);
    stops_ = rig.lens().info().stops;
    side_ = rig.window().n;
    pictures_ = pictures_of(rig);
  }

  bool is_stack() const { return pictures_.size() >= 3; }

  Tally judge(std::mt19937& random) {
    Tally tally;
    const int right = pictures_[0].width_px() - side_, down = pictures_[0].height_px() - side_;
    for (int tries = 0; tries < 20 * wishes_.windows && tally.windows < wishes_.windows; ++tries) {
      const Window window{static_cast<int>(pick(random, 0, right + 1)),
                          static_cast<int>(pick(random, 0, down + 1)), side_};
      std::vector<double> detail;
      for (const Frame& picture : pictures_) detail.push_back(detail_of(picture, window));
      if (const auto peak = clear_peak(detail)) add(tally, window, *peak);
    }
    return tally;
  }

 private:
  void add(Tally& tally, const Window& window, double peak) {
    constexpr double kRight = 1.5, kSure = 0.5;
    options_.window = window;
    Rig rig(options_);
    Observer nobody;
    const Focus focus = *Session(rig).focus({}, nobody).focus;
    const double away = std::abs(index_of(stops_, focus.position()) - peak);
    const bool is_focused = focus.result() == FocusResult::focused;
    ++tally.windows;
    tally.declined += !is_focused;
    tally.right += is_focused && away <= kRight;
    tally.sure_and_wrong += is_focused && away > kRight && focus.verdict.confidence > kSure;
    if (wishes_.list)
      fmt::print("  {} {} at picture {:.2f}, by the Laplacian {:.2f}, confidence {:.2f}, {}\n",
                 to_string(window), to_string(focus.result()), index_of(stops_, focus.position()),
                 peak, focus.verdict.confidence, to_string(focus.verdict.reason.why));
  }

  const Wishes& wishes_;
  RigOptions options_;
  std::vector<double> stops_;
  std::vector<Frame> pictures_;
  int side_ = 64;
};

void print(const std::string& name, const Tally& t) {
  fmt::print(
      "{:40} {:4} windows with one clear peak, {:4} right, {:4} declined, {} wrong with a "
      "confidence above 0.5\n",
      name, t.windows, t.right, t.declined, t.sure_and_wrong);
  std::fflush(stdout);
}

Tally measure(const Wishes& wishes) {
  std::mt19937 random(wishes.seed);
  Tally all;
  std::set<fs::path> played;  // a folder comes before what is in it
  for (const fs::path& folder : wishes.folders) {
    for (const fs::path& place : candidates_in(folder)) {
      if (played.contains(place.parent_path())) continue;
      std::optional<Stack> stack;
      try {
        stack.emplace(place, wishes);
      } catch (const Error& error) {
        if (!fs::is_directory(place))
          fmt::print(stderr, "{} is left out: {}\n", place.string(), error.what());
        continue;
      }
      if (!stack->is_stack()) continue;
      played.insert(place);
      const Tally one = stack->judge(random);
      print(place.filename().string(), one);
      all.windows += one.windows;
      all.right += one.right;
      all.declined += one.declined;
      all.sure_and_wrong += one.sure_and_wrong;
    }
  }
  print("all", all);
  return all;
}

[[noreturn]] void refuse(const std::string& what) {
  fmt::print(stderr,
             "fathom_stacks: {}\nusage: fathom_stacks [--windows N] [--seed N] [--metric TEXT] "
             "[--list] FOLDER...\n",
             what);
  std::exit(2);
}

unsigned whole(const std::string& name, const std::string& text) {
  unsigned value = 0;
  const char* const end = text.data() + text.size();
  const auto [next, problem] = std::from_chars(text.data(), end, value);
  if (problem != std::errc() || next != end || value > 1000000)
    refuse(name + " takes a whole number");
  return value;
}

Wishes wishes_of(int count, char** arguments) {
  Wishes wishes;
  for (int i = 1; i < count; ++i) {
    const std::string name = arguments[i];
    const auto value = [&] { return i + 1 < count ? std::string(arguments[++i]) : std::string(); };
    if (name == "--windows") {
      wishes.windows = static_cast<int>(whole(name, value()));
    } else if (name == "--seed") {
      wishes.seed = whole(name, value());
    } else if (name == "--metric") {
      wishes.metric = value();
    } else if (name == "--list") {
      wishes.list = true;
    } else if (name.rfind("--", 0) == 0) {
      refuse("there is no option " + name);
    } else if (!fs::exists(name)) {
      refuse("there is no " + name);
    } else {
      wishes.folders.emplace_back(name);
    }
  }
  if (wishes.folders.empty()) refuse("name a folder with focal stacks");
  return wishes;
}

}  // namespace
}  // namespace fathom::honesty

int main(int count, char** arguments) {
  try {
    return fathom::honesty::measure(fathom::honesty::wishes_of(count, arguments)).windows > 0 ? 0
                                                                                              : 1;
  } catch (const std::exception& error) {
    fmt::print(stderr, "fathom_stacks: {}\n", error.what());
    return 1;
  }
}
