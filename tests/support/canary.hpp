// SPDX-License-Identifier: Apache-2.0
// Outputs between guards: what a backend writes beyond its span shows.
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <vector>

namespace fathom::test {

/// A span of doubles (or of complex ones) with guard bytes on both sides. It starts out as NaN, so
/// an element that is never written cannot pass for a result.
template <class T>
class Guarded {
 public:
  explicit Guarded(std::size_t size)
      : size_(size), memory_(size + 2 * kGuard, T(std::numeric_limits<double>::quiet_NaN())) {
    std::memset(static_cast<void*>(memory_.data()), kPattern, kGuard * sizeof(T));
    std::memset(static_cast<void*>(memory_.data() + kGuard + size), kPattern, kGuard * sizeof(T));
  }

  std::span<T> span() { return {memory_.data() + kGuard, size_}; }
  T& operator[](std::size_t i) { return memory_[kGuard + i]; }
  std::size_t size() const { return size_; }

  /// Whether the guards still hold their pattern.
  bool intact() const { return filled(memory_.data()) && filled(memory_.data() + kGuard + size_); }

 private:
  static constexpr std::size_t kGuard = 64;  // elements; wider than any vector or cache line
  static constexpr unsigned char kPattern = 0xA5;

  static bool filled(const T* guard) {
    const auto* const bytes = reinterpret_cast<const unsigned char*>(guard);
    for (std::size_t i = 0; i < kGuard * sizeof(T); ++i) {
      if (bytes[i] != kPattern) return false;
    }
    return true;
  }

  std::size_t size_;
  std::vector<T> memory_;
};

}  // namespace fathom::test
