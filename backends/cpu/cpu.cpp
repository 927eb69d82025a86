// SPDX-License-Identifier: Apache-2.0
// The `cpu` backend: SIMD kernels and threads behind the contract. Its devices are the instruction
// sets that this processor has, so that each can be asked for and tested; the first is the best.
#include <fmt/format.h>

#include <algorithm>
#include <new>

#include "backends/backends.hpp"
#include "backends/cpu/kernel.hpp"
#include "backends/cpu/threads.hpp"
#include "engine/error.hpp"

namespace fathom {
namespace {

using cpu::InstructionSet;
using cpu::kBlock;
using cpu::Kernel;

/// Scratch memory of one thread, aligned for the widest registers.
struct ScratchDeleter {
  void operator()(std::byte* memory) const { ::operator delete(memory, kAlignment); }
  static constexpr std::align_val_t kAlignment{64};
};
using Scratch = std::unique_ptr<std::byte[], ScratchDeleter>;

Scratch allocate(std::size_t bytes, const MetricSpec& spec) {
  auto* const memory = ::operator new(bytes, ScratchDeleter::kAlignment, std::nothrow);
  if (memory == nullptr) {
    throw Error(ErrorCode::out_of_memory,
                fmt::format("no {} bytes of memory for a thread that scores {}; try fewer threads",
                            bytes, spec.text()));
  }
  return Scratch(static_cast<std::byte*>(memory));
}

/// Fewest windows that are worth a thread of their own: kBlock of 64 x 64 pixels, 1 of 256 x 256.
/// Smaller ones share registers, so that half a block costs as much as a whole one, and are done
/// before another thread has woken up.
constexpr std::size_t least_block(int n) {
  constexpr std::size_t kLeastPixels = 64 * 64 * kBlock;
  const std::size_t pixels = static_cast<std::size_t>(n) * n;
  return std::clamp<std::size_t>(kLeastPixels / pixels, 1, kBlock);
}

class CpuPlan final : public Plan {
 public:
  CpuPlan(const MetricSpec& spec, std::size_t capacity, const InstructionSet& set,
          std::shared_ptr<cpu::Threads> threads)
      : Plan(spec, capacity),
        tables_(spec),
        kernels_{set.kernel(spec, Depth::bits8), set.kernel(spec, Depth::bits16)},
        threads_(std::move(threads)) {
    const std::size_t bytes = std::max(kernels_[0].scratch_bytes, kernels_[1].scratch_bytes);
    const std::size_t most_blocks = blocks_of(capacity, least_block(spec.n));
    for (std::size_t i = 0; i < std::min(threads_->count(), most_blocks); ++i) {
      scratch_.push_back(allocate(bytes, spec));
    }
  }

 private:
  void do_submit(std::uint64_t, const Frame& frame, std::span<const Window> windows,
                 std::span<double> values) override {
    const Kernel& kernel = kernel_for(frame);
    const std::size_t outputs = spec().outputs();
    // Whole blocks to each thread. Which windows share one never shows in a score.
    const std::size_t size = block_for(windows.size());
    threads_->share(blocks_of(windows.size(), size), scratch_.size(),
                    [&](std::size_t begin, std::size_t end, std::size_t worker) {
                      for (std::size_t block = begin; block < end; ++block) {
                        const std::size_t first = block * size;
                        const std::size_t count = std::min(size, windows.size() - first);
                        kernel.score(tables_, frame, windows.subspan(first, count),
                                     values.subspan(first * outputs, count * outputs),
                                     scratch_[worker].get());
                      }
                    });
  }

  static std::size_t blocks_of(std::size_t windows, std::size_t size) {
    return (windows + size - 1) / size;
  }

  /// Windows to a block: kBlock where there are enough for every thread to get some blocks; else
  /// fewer, if they are large.
  std::size_t block_for(std::size_t windows) const {
    constexpr std::size_t kBlocksPerThread = 4;  // so that one held up leaves some to the others
    if (scratch_.size() == 1) return kBlock;
    return std::clamp<std::size_t>(windows / (kBlocksPerThread * scratch_.size()),
                                   least_block(spec().n), kBlock);
  }

  void do_wait(std::uint64_t) override {}  // submit has done it all

  void do_spectrum(const Frame& frame, const Window& window,
                   std::span<std::complex<double>> coefficients) override {
    kernel_for(frame).spectrum(tables_, frame, window, coefficients, scratch_[0].get());
  }

  const Kernel& kernel_for(const Frame& frame) const {
    return kernels_[frame.depth() == Depth::bits8 ? 0 : 1];
  }

  cpu::Tables tables_;
  Kernel kernels_[2];  ///< For 8 and for 16 bits.
  std::shared_ptr<cpu::Threads> threads_;
  std::vector<Scratch> scratch_;  ///< One per thread that may be at work.
};

class CpuDevice final : public Device {
 public:
  CpuDevice(DeviceInfo info, const InstructionSet& set, int threads)
      : Device(std::move(info)), set_(set), threads_(std::make_shared<cpu::Threads>(threads)) {}
  int threads() const override { return static_cast<int>(threads_->count()); }
  bool fuses(const MetricSpec& spec) const override {
    switch (spec.measure) {
      case Measure::moment:
      case Measure::rings:
      case Measure::entropy:
        return true;
    }
    return false;
  }

 private:
  std::string do_unsupported(const MetricSpec& spec) const override {
    if (set_.kernel(spec, Depth::bits8).score != nullptr) return {};
    return fmt::format("there is no SIMD kernel for {}", to_string(spec.transform));
  }

  std::unique_ptr<Plan> do_plan(const MetricSpec& spec, std::size_t capacity) override {
    return std::make_unique<CpuPlan>(spec, capacity, set_, threads_);
  }

  InstructionSet set_;
  std::shared_ptr<cpu::Threads> threads_;
};

class CpuBackend final : public Backend {
 public:
  const char* name() const noexcept override { return "cpu"; }

  std::vector<DeviceInfo> devices() const override {
    std::vector<DeviceInfo> infos;
    for (const InstructionSet& set : cpu::instruction_sets()) {
      infos.push_back({set.name, DeviceKind::cpu, set.details});
    }
    return infos;
  }

  std::unique_ptr<Device> open(std::size_t index, const DeviceOptions& options) const override {
    const auto sets = cpu::instruction_sets();
    if (index >= sets.size()) {
      throw Error(ErrorCode::unavailable,
                  fmt::format("this processor runs cpu:0 to cpu:{}", sets.size() - 1));
    }
    return std::make_unique<CpuDevice>(devices()[index], sets[index],
                                       cpu::thread_count(options.threads));
  }
};

}  // namespace

const Backend& cpu_backend() {
  static const CpuBackend backend;
  return backend;
}

}  // namespace fathom
