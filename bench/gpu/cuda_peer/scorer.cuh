// SPDX-License-Identifier: Apache-2.0
// A peer: something that scores all windows of a frame, and how much memory that takes.
#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <string>

#include "check.cuh"
#include "metric.cuh"

namespace fathom::peer {

/// One stream, with all that is needed to score so many windows of one metric.
class Scorer {
 public:
  Scorer() = default;
  Scorer(const Scorer&) = delete;
  Scorer& operator=(const Scorer&) = delete;
  virtual ~Scorer() = default;

  virtual cudaStream_t stream() const = 0;

  /// Starts everything; scores are on the device when the stream is done. Origins and stride are
  /// multiples of four pixels.
  virtual void run(const unsigned char* frame, std::size_t stride, const std::uint32_t* origins,
                   float* scores) const = 0;
};

/// A way to score.
struct Peer {
  std::string name;  ///< What its lines begin with.
  /// Bytes that a window takes between the kernels.
  std::function<std::size_t(const Metric&)> bytes_between;
  /// windows: of a frame; chunk: how many of them go through at once.
  std::function<std::unique_ptr<Scorer>(const Metric&, std::size_t windows, std::size_t chunk)>
      make;

  /// How many windows go through at once, in equal parts, so that they take at most so many bytes.
  std::size_t chunk_for(const Metric& metric, std::size_t windows, std::size_t bytes) const {
    const std::size_t most = std::max<std::size_t>(bytes / bytes_between(metric), 1);
    const std::size_t parts = (windows + most - 1) / most;
    return (windows + parts - 1) / parts;
  }
};

}  // namespace fathom::peer
