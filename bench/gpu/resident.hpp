// SPDX-License-Identifier: Apache-2.0
// The device's own work, without the way of the pixels to it.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <stdexcept>
#include <vector>

#include "backends/gpu/constants.hpp"
#include "backends/gpu/results.hpp"
#include "backends/gpu/tables.hpp"
#include "bench/gpu/work.hpp"

namespace fathom::bench {

/// Two frames that are on the device before the clock starts, scored again and again; scores come
/// to the host's memory as the kernel gives them. What a plan does with a batch
/// (backends/gpu/plan.hpp), but that it is loaded once.
template <class Context, class Program, class Flight>
class Resident final : public Work {
 public:
  Resident(std::shared_ptr<Context> context, const Pixels& pixels, const Cell& cell)
      : context_(std::move(context)),
        spec_(cell.spec),
        results_(spec_),
        args_(gpu::args_for(spec_)) {
    if (gpu::needs_exact(spec_))
      throw std::logic_error("only metrics with a fast kernel are timed");
    const auto windows = cell.tiles.list();
    const gpu::Limits& limits = context_->limits();
    fast_.emplace(*context_, spec_, gpu::fast_shape(spec_, cell.depth, limits).value(), cell.depth,
                  windows.size());
    if (gpu::may_need_exact(spec_)) {
      exact_.emplace(*context_, spec_, gpu::exact_shape(spec_, limits).value(), cell.depth,
                     windows.size());
    }
    gpu::Rectangle all;
    for (const Window& window : windows) all.include(window);
    for (int i = 0; i < 2; ++i) {
      frames_[i] = pixels.frame(i, cell.tiles, cell.depth);
      flights_[i].emplace(*context_, windows.size(), results_.words());
      flights_[i]->load(frames_[i], all, windows, {});
    }
    windows_ = windows.size();
  }
  ~Resident() override { context_->drain(); }

  const Frame& frame(int seat) const override { return frames_[seat]; }
  std::vector<double> scores(int seat) const override {
    const std::size_t outputs = spec_.outputs();
    std::vector<double> values(windows_ * outputs);
    const std::uint32_t* words = flights_[seat]->results();
    for (std::size_t i = 0; i < windows_; ++i, words += results_.words()) {
      results_.read(words, std::span(values).subspan(i * outputs, outputs));
    }
    return values;
  }

 private:
  void do_start(int i) override {
    flights_[i]->start(*fast_, exact_ ? &*exact_ : nullptr, args_, gpu::Wanted::score);
  }
  void do_finish(int i) override { flights_[i]->finish(); }

  std::shared_ptr<Context> context_;
  MetricSpec spec_;
  gpu::Results results_;
  std::size_t windows_ = 0;
  kernels::ScoreArgs args_;
  std::optional<Program> fast_, exact_;
  std::array<Frame, 2> frames_;
  std::array<std::optional<Flight>, 2> flights_;
};

}  // namespace fathom::bench
