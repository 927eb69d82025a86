// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/benchmark.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <random>

#include "backends/backends.hpp"
#include "engine/error.hpp"
#include "engine/scorer.hpp"
#include "tools/fathom/console.hpp"

namespace fathom::cli {
namespace {

/// A case that would take longer for one window, or for a whole batch, is made smaller.
constexpr double kTooLong_us = 1e6;

// With their default seeds, so that every run and every row of a size scores the same pixels.

Frame random_frame(int depth) {
  std::mt19937_64 random;
  constexpr int kWidth_px = 2048, kHeight_px = 1536;
  const auto fill = [&](auto pixels) {
    for (auto& pixel : pixels) {
      pixel = static_cast<typename decltype(pixels)::value_type>(random());
    }
    return Frame(kWidth_px, kHeight_px, std::move(pixels));
  };
  constexpr std::size_t kPixels = std::size_t{kWidth_px} * kHeight_px;
  return depth == 8 ? fill(std::vector<std::uint8_t>(kPixels))
                    : fill(std::vector<std::uint16_t>(kPixels));
}

std::vector<Window> random_windows(const Frame& frame, int n, std::size_t count) {
  std::mt19937_64 random;
  const auto below = [&](int limit) {
    return static_cast<int>(random() % static_cast<unsigned>(limit));
  };
  std::vector<Window> windows;
  windows.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    windows.push_back({below(frame.width_px() - n + 1), below(frame.height_px() - n + 1), n});
  }
  return windows;
}

/// Whether the case concerns a device that is not there or does not take it.
bool declined(const Error& error) {
  return error.code() == ErrorCode::unsupported || error.code() == ErrorCode::unavailable;
}

}  // namespace

Benchmark::Benchmark(int depth) : frame_(random_frame(depth)) {}

void Benchmark::require_valid(std::span<const BenchCase> cases) {
  std::set<std::pair<std::string, int>> opened;
  const OnWork patience = patient_words();
  for (const BenchCase& one : cases) {
    if (!opened.emplace(one.choice, one.threads).second) continue;
    try {
      select_device(all_backends(), one.choice, one.spec, 1,
                    {.threads = one.threads, .on_work = patience});
    } catch (const Error& error) {
      if (!declined(error)) throw;  // else measure() says so, and the other cases have their rows
    }
  }
}

std::optional<BenchRow> Benchmark::measure(const BenchCase& wanted) {
  if (too_slow(wanted)) return std::nullopt;
  const int batch = wanted.batch != kDecideLater ? wanted.batch : affordable_batch(wanted);
  try {
    return measure(
        wanted,
        select_device(all_backends(), wanted.choice, wanted.spec, static_cast<std::size_t>(batch),
                      {.threads = wanted.threads, .on_work = patience_}),
        batch);
  } catch (const Error& error) {
    if (!declined(error)) throw;
    note_once(error.what());
    return std::nullopt;
  }
}

std::optional<BenchRow> Benchmark::measure(const BenchCase& wanted, const Selection& selection,
                                           int batch) {
  BenchRow row{.backend = selection.backend,
               .device = selection.device->info(),
               .spec = wanted.spec,
               .threads = selection.device->threads(),
               .batch = batch,
               .time = {}};
  const auto key = fmt::format("{} {} {} {} {}", row.backend, row.device.name, row.spec.text(),
                               batch, row.threads);
  if (!measured_.insert(key).second) return std::nullopt;
  constexpr std::size_t kPlaces = 1024;  // at least so many, to be spread over the frame
  const auto size = static_cast<std::size_t>(batch);
  const std::size_t count = (kPlaces + size - 1) / size * size;
  const auto windows = random_windows(frame_, wanted.spec.n, count);
  row.time = time_windows(*selection.device->plan(wanted.spec, size), frame_, windows, size);
  learn(wanted, row.time.median_us);
  return row;
}

/// The first row of a size counts, so that all rows of a size are decided by one number.
void Benchmark::learn(const BenchCase& of, double window_us) {
  Experience& known = experience_[of.choice + " " + of.series];
  if (known.n != of.spec.n) known = {of.spec.n, window_us};
}

/// What a window will take, by the size before it and the N^3 of a row-column transform by plain
/// sums, which no backend is likely to exceed; 0 where nothing is known.
double Benchmark::expected_us(const BenchCase& wanted) const {
  const auto known = experience_.find(wanted.choice + " " + wanted.series);
  if (known == experience_.end()) return 0;
  const double ratio = static_cast<double>(wanted.spec.n) / known->second.n;
  return known->second.window_us * ratio * ratio * ratio;
}

bool Benchmark::too_slow(const BenchCase& wanted) {
  const double expected = expected_us(wanted);
  if (!wanted.may_skip || expected < kTooLong_us) return false;
  note_once(
      fmt::format("{0} is left out, as one window would take some {1:.1f} s; --metric {0} times it "
                  "all the same",
                  wanted.spec.text(), expected / 1e6));
  return true;
}

int Benchmark::affordable_batch(const BenchCase& wanted) const {
  constexpr double kShortened_us = 5e4;
  const auto full = static_cast<int>(full_batch(wanted.spec.n));
  const double window_us = expected_us(wanted);
  if (window_us * full < kTooLong_us) return full;
  return std::max(1, static_cast<int>(kShortened_us / window_us));
}

void Benchmark::note_once(const std::string& text) {
  if (noted_.insert(text).second) note(text);
}

}  // namespace fathom::cli
