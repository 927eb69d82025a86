// SPDX-License-Identifier: Apache-2.0
// Batch after batch, two in flight, a stream each: resident frames, or fresh ones from pinned
// memory.
#pragma once

#include <array>
#include <cstdlib>

#include "bench/gpu/common.hpp"
#include "scorer.cuh"

namespace fathom::peer {

/// Random bytes in pinned memory: every frame is a part of them.
class Pixels {
 public:
  explicit Pixels(std::size_t most_bytes)
      : bytes_((most_bytes + bench::kSpareBytes) / 8 * 8),
        words_(pinned_array<std::uint64_t>(bytes_ / 8)) {
    for (std::size_t i = 0; i < bytes_ / 8; ++i) words_[i] = bench::random_word(i);
  }
  const unsigned char* frame(std::size_t number, std::size_t frame_bytes) const {
    return reinterpret_cast<const unsigned char*>(words_.get()) +
           bench::frame_offset(number, frame_bytes, bytes_);
  }

 private:
  std::size_t bytes_;
  PinnedArray<std::uint64_t> words_;
};

/// Windows that tile a frame, as fathom_gpu_throughput lays them.
struct Tiles {
  Tiles(const Metric& metric, std::size_t windows) : windows_(windows) {
    const std::size_t rows = bench::tile_rows(windows), columns = windows / rows;
    const std::size_t width = std::size_t{1} * metric.n * (metric.depth / 8);
    stride = columns * width;
    for (std::size_t row = 0; row < rows; ++row) {
      for (std::size_t column = 0; column < columns; ++column) {
        origins.push_back(static_cast<std::uint32_t>(row * metric.n * stride + column * width));
      }
    }
    bytes = windows * metric.window_bytes();
  }
  std::size_t windows() const { return windows_; }

  std::size_t stride = 0, bytes = 0;
  std::vector<std::uint32_t> origins;

 private:
  std::size_t windows_;
};

class Work {
 public:
  Work(const Peer& peer, const Pixels& pixels, const Metric& metric, const Tiles& tiles,
       std::size_t chunk, bool is_streamed)
      : pixels_(pixels),
        metric_(metric),
        tiles_(tiles),
        is_streamed_(is_streamed),
        origins_(on_device(tiles.origins)) {
    for (auto& seat : seats_) {
      seat = std::make_unique<Seat>(tiles, peer.make(metric, tiles.windows(), chunk));
      if (is_streamed) continue;
      seat->frame = pixels.frame(number_++, tiles.bytes);
      PEER_CHECK(cudaMemcpy(seat->pixels.get(), seat->frame, tiles.bytes, cudaMemcpyHostToDevice));
    }
  }

  void step() {
    Seat& seat = *seats_[next_];
    const cudaStream_t stream = seat.scorer->stream();
    PEER_CHECK(cudaStreamSynchronize(stream));
    if (is_streamed_) {
      seat.frame = pixels_.frame(number_++, tiles_.bytes);
      PEER_CHECK(cudaMemcpyAsync(seat.pixels.get(), seat.frame, tiles_.bytes,
                                 cudaMemcpyHostToDevice, stream));
    }
    seat.scorer->run(seat.pixels.get(), tiles_.stride, origins_.get(), seat.scores.get());
    PEER_CHECK(cudaMemcpyAsync(seat.host_scores.get(), seat.scores.get(),
                               tiles_.windows() * sizeof(float), cudaMemcpyDeviceToHost, stream));
    next_ = 1 - next_;
  }

  /// Waits for both batches, and throws unless some of their scores are what direct sums give.
  void land_and_check() const {
    for (const auto& seat : seats_) {
      PEER_CHECK(cudaStreamSynchronize(seat->scorer->stream()));
      std::vector<std::size_t> some = {tiles_.windows() - 1};
      if (metric_.n <= 128) some.insert(some.end(), {0, tiles_.windows() / 2});
      for (const std::size_t i : some) require_right(*seat, i);
    }
  }

 private:
  struct Seat {
    Seat(const Tiles& tiles, std::unique_ptr<Scorer> its_scorer)
        : pixels(device_array<unsigned char>(tiles.bytes)),
          scores(device_array<float>(tiles.windows())),
          host_scores(pinned_array<float>(tiles.windows())),
          scorer(std::move(its_scorer)) {}
    DeviceArray<unsigned char> pixels;
    DeviceArray<float> scores;
    PinnedArray<float> host_scores;
    const unsigned char* frame = nullptr;
    std::unique_ptr<Scorer> scorer;  // last, so that its stream is waited for before memory goes
  };

  /// A peer in single precision is allowed what the other peers are
  /// (bench/agreement.cpp).
  void require_right(const Seat& seat, std::size_t i) const {
    const double expected = direct_score(metric_, seat.frame + tiles_.origins[i], tiles_.stride);
    const double error = std::abs(double{seat.host_scores[i]} / expected - 1);
    if (error <= (metric_.is_walsh ? 1e-5 : 1e-4)) return;  // false for NaN
    throw std::runtime_error("window " + std::to_string(i) + " scores " +
                             std::to_string(seat.host_scores[i]) + ", not " +
                             std::to_string(expected));
  }

  const Pixels& pixels_;
  Metric metric_;
  const Tiles& tiles_;
  bool is_streamed_;
  DeviceArray<std::uint32_t> origins_;
  std::size_t number_ = 0;
  int next_ = 0;
  std::array<std::unique_ptr<Seat>, 2> seats_;
};

}  // namespace fathom::peer
