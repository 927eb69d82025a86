// SPDX-License-Identifier: Apache-2.0
// The device's own work, without the way of the pixels to it.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <stdexcept>
#include <vector>

#include "backends/gpu/constants.hpp"
#include "backends/gpu/spectrum.hpp"
#include "backends/gpu/tables.hpp"
#include "bench/gpu/work.hpp"
#include "engine/tables.hpp"

namespace fathom::bench {

/// Two frames that are on the device before the clock starts, scored again and again; scores come
/// to the host's memory as the kernel gives them. What a plan does with a batch
/// (backends/gpu/plan.hpp), but that it is loaded once.
template <class Context, class Program, class Flight>
class Resident final : public Work {
 public:
  Resident(std::shared_ptr<Context> context, const Pixels& pixels, const Cell& cell)
      : context_(std::move(context)), spec_(cell.spec), args_(gpu::args_for(spec_)) {
    if (gpu::needs_exact(spec_))
      throw std::logic_error("only metrics with a fast kernel are timed");
    const auto windows = cell.tiles.list();
    const gpu::Limits& limits = context_->limits();
    fast_.emplace(*context_, spec_, gpu::fast_shape(spec_, cell.depth, limits).value(), cell.depth,
                  windows.size());
    if (!is_walsh(spec_.transform)) {
      exact_.emplace(*context_, spec_, gpu::exact_shape(spec_, limits).value(), cell.depth,
                     windows.size());
    }
    gpu::Rectangle all;
    for (const Window& window : windows) all.include(window);
    for (int i = 0; i < 2; ++i) {
      frames_[i] = pixels.frame(i, cell.tiles, cell.depth);
      flights_[i].emplace(*context_, windows.size());
      flights_[i]->load(frames_[i], all, windows, {});
    }
    windows_ = windows.size();
  }
  ~Resident() override { context_->drain(); }

  const Frame& frame(int seat) const override { return frames_[seat]; }
  std::vector<double> scores(int seat) const override {
    std::vector<double> scores(windows_);
    const std::uint32_t* words = flights_[seat]->results();
    for (double& score : scores) {
      score = tables::moment_scale(spec_) * gpu::moment_of(spec_, words);
      words += 2;
    }
    return scores;
  }

 private:
  void do_start(int i) override {
    flights_[i]->start(*fast_, exact_ ? &*exact_ : nullptr, args_, gpu::Wanted::score);
  }
  void do_finish(int i) override { flights_[i]->finish(); }

  std::shared_ptr<Context> context_;
  MetricSpec spec_;
  std::size_t windows_ = 0;
  kernels::ScoreArgs args_;
  std::optional<Program> fast_, exact_;
  std::array<Frame, 2> frames_;
  std::array<std::optional<Flight>, 2> flights_;
};

}  // namespace fathom::bench
