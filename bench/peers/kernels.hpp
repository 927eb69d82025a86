// SPDX-License-Identifier: Apache-2.0
// Loops that several peers share, written so that the compiler vectorises them; only the peers' own
// files include this, because only they are compiled for this very machine.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>
#include <vector>

#include "engine/frame.hpp"
#include "engine/window.hpp"

namespace fathom::bench {

inline constexpr std::size_t kAlignment = 64;  // one cache line and the widest vector

struct Free {
  void operator()(void* memory) const { std::free(memory); }
};

template <class T>
using Buffer = std::unique_ptr<T[], Free>;

template <class T>
Buffer<T> make_buffer(std::size_t count) {
  const std::size_t bytes = (count * sizeof(T) + kAlignment - 1) / kAlignment * kAlignment;
  void* const memory = std::aligned_alloc(kAlignment, bytes);
  if (memory == nullptr) throw std::bad_alloc();
  return Buffer<T>(static_cast<T*>(memory));
}

inline Buffer<float> aligned_copy(const std::vector<float>& values) {
  auto copy = make_buffer<float>(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) copy[i] = values[i];
  return copy;
}

template <class T>
T* aligned(T* pointer) {
  return static_cast<T*>(__builtin_assume_aligned(pointer, kAlignment));
}

/// The pixels of row y of a window.
inline const std::uint8_t* window_row(const Frame& frame, const Window& window, int y) {
  return reinterpret_cast<const std::uint8_t*>(frame.row(window.y + y)) + window.x;
}

/// The window's pixels as T, row after row, without gaps.
template <int N, class T>
void widen(const Frame& frame, const Window& window, T* to) {
  to = aligned(to);
  for (int y = 0; y < N; ++y) {
    const std::uint8_t* const from = window_row(frame, window, y);
    for (int x = 0; x < N; ++x) to[y * N + x] = from[x];
  }
}

/// Single precision is good for a few thousand terms; more are added up in double.
template <int kCount, class Term>
double blocked_sum(Term term) {
  constexpr int kBlock = 4096;
  double total = 0;
  for (int start = 0; start < kCount; start += kBlock) {
    const int end = start + kBlock < kCount ? start + kBlock : kCount;
    float sum = 0;
    for (int i = start; i < end; ++i) sum += term(i);
    total += sum;
  }
  return total;
}

}  // namespace fathom::bench
