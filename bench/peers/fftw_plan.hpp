// SPDX-License-Identifier: Apache-2.0
// A plan of FFTW with its buffers: in place or out of place, whichever a race finds faster, because
// FFTW's planner does not choose between the two.
#pragma once

#include <fftw3.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <stdexcept>
#include <type_traits>

#include "bench/peers/kernels.hpp"
#include "bench/peers/peer.hpp"

namespace fathom::bench {

class FftwPlan {
 public:
  /// make(in, out, flags) plans with FFTW; `floats` is the size of the larger of its two sides.
  template <class Make>
  FftwPlan(std::size_t floats, Planning planning, const Make& make)
      : in_(make_buffer<float>(floats)), out_(make_buffer<float>(floats)) {
    std::fill_n(in_.get(), floats, 0.0F);
    const unsigned flags = FFTW_DESTROY_INPUT;
    // Some of the plans of rank 17 would be searched for minutes; then FFTW takes its best so far.
    fftwf_set_timelimit(10);
    if (planning == Planning::quick) {
      plan_ = owned(make(in_.get(), out_.get(), flags | FFTW_ESTIMATE));
      return;
    }
    plan_ = owned(make(in_.get(), out_.get(), flags | FFTW_PATIENT));
    Handle in_place = owned(make(in_.get(), in_.get(), flags | FFTW_PATIENT));
    std::fill_n(in_.get(), floats, 0.0F);
    if (fastest_run(in_place) < fastest_run(plan_)) {
      plan_ = std::move(in_place);
      out_.reset();
    }
  }

  bool is_in_place() const { return out_ == nullptr; }
  float* input() { return in_.get(); }
  const float* output() const { return is_in_place() ? in_.get() : out_.get(); }
  void execute() { fftwf_execute(plan_.get()); }
  /// The shortest of several runs, as a race between plans takes it.
  double run_time() const { return fastest_run(plan_); }

 private:
  struct Destroy {
    void operator()(fftwf_plan plan) const { fftwf_destroy_plan(plan); }
  };
  using Handle = std::unique_ptr<std::remove_pointer_t<fftwf_plan>, Destroy>;

  static Handle owned(fftwf_plan plan) {
    if (plan == nullptr) throw std::runtime_error("FFTW made no plan");
    return Handle(plan);
  }

  /// The shortest of several runs, so that a disturbed one does not decide.
  static double fastest_run(const Handle& plan) {
    using Clock = std::chrono::steady_clock;
    double fastest = 1e9;
    const auto start = Clock::now();
    do {
      const auto before = Clock::now();
      for (int i = 0; i < 16; ++i) fftwf_execute(plan.get());
      fastest = std::min(fastest, std::chrono::duration<double>(Clock::now() - before).count());
    } while (Clock::now() - start < std::chrono::milliseconds(30));
    return fastest;
  }

  Buffer<float> in_;
  Buffer<float> out_;  ///< Empty where the plan works in place.
  Handle plan_;
};

}  // namespace fathom::bench
