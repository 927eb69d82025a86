// SPDX-License-Identifier: Apache-2.0
// One batch on its way through the device: its pixels, its windows, its scores, its commands.
#pragma once

#include <span>

#include "backends/gpu/batch.hpp"
#include "backends/opencl/program.hpp"

namespace fathom::opencl {

/// Memory of the host's that the device copies from and to without detour.
class Staging {
 public:
  Staging() = default;
  Staging(Context& context, std::size_t bytes, const char* what);
  Staging(Staging&& other) noexcept { *this = std::move(other); }
  Staging& operator=(Staging&& other) noexcept;
  ~Staging();

  std::byte* data() const { return data_; }
  std::uint32_t* words() const { return reinterpret_cast<std::uint32_t*>(data_); }

 private:
  Context* context_ = nullptr;
  Buffer buffer_;
  std::byte* data_ = nullptr;
};

class Flight {
 public:
  /// windows: most of one batch; words: that the kernel leaves of each. Throws
  /// Error(out_of_memory).
  Flight(Context& context, std::size_t windows, std::size_t words);

  /// Copies pixels to where the device takes them, growing the buffer where no part was as large,
  /// and notes where each window starts: those of `ids`, or all in their order where `ids` is
  /// empty.
  void load(const Frame& frame, const gpu::Rectangle& part, std::span<const Window> windows,
            std::span<const std::uint32_t> ids);

  /// Starts the program, and `rescue`, if any, for windows that it is in doubt about, on what was
  /// loaded. What the flight's last batch was must be over. What an earlier start has uploaded
  /// stays on the device until the next load(). Coefficients are window 0's alone.
  void start(const Program& program, const Program* rescue, const kernels::ScoreArgs& args,
             gpu::Wanted wanted);

  /// Waits until what was started is over. Throws Error(device_lost, timeout).
  void finish();

  /// What the kernel wrote, window by window.
  const std::uint32_t* results() const { return results_.words(); }
  /// What it wrote instead: gpu::spectrum_words() of them.
  const std::uint32_t* coefficients() const { return coefficients_.words(); }

 private:
  void upload();
  void enqueue(const Program& program, const Program* rescue, kernels::ScoreArgs args,
               gpu::Wanted wanted);
  void read(const Buffer& from, const Staging& to, std::size_t words);

  Context& context_;
  Buffer frame_;
  Staging staging_;  ///< Without memory where the host writes straight to the device.
  Buffer windows_;   ///< Where each one starts.
  Buffer scores_;
  Buffer doubtful_;
  Buffer spectrum_;                           ///< Once coefficients were wanted.
  std::size_t words_;                         ///< Of one window's results.
  Staging origins_, results_, coefficients_;  ///< The host's copies of three of these.
  std::size_t window_count_ = 0;
  Handle<cl_event> uploaded_, done_;
  std::size_t frame_bytes_ = 0;
  std::uint32_t stride_words_ = 0;
  Depth depth_ = Depth::bits8;
  bool is_uploaded_ = false;
};

}  // namespace fathom::opencl
