// SPDX-License-Identifier: Apache-2.0
// The fastest of what OpenCV 4.6 offers, some of it three times as fast as what is written first
// (cv::Laplacian to CV_64F and cv::meanStdDev; cv::Sobel twice and cv::norm).
#include "bench/opencv/opencv.hpp"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace fathom::bench {
namespace {

/// Not a part of a larger cv::Mat, whose pixels OpenCV would take for what is beyond the border.
cv::Mat pixels_of(const Frame& frame, const Window& window) {
  const std::byte* const first = frame.row(window.y) + window.x;
  // cv::Mat has no constant pixels; nobody writes these.
  auto* const pixels = const_cast<std::byte*>(first);
  return {window.n, window.n, CV_8U, pixels, frame.stride_bytes()};
}

class Laplacian final : public PreparedPeer {
 public:
  explicit Laplacian(int n) : depth_(n < 32 ? CV_32F : CV_16S), laplacian_(n, n, depth_) {
    cv::setNumThreads(1);
  }

  void score(const Frame& frame, std::span<const Window> windows,
             std::span<double> scores) override {
    const double pixels = static_cast<double>(laplacian_.total());
    for (std::size_t i = 0; i < windows.size(); ++i) {
      cv::Laplacian(pixels_of(frame, windows[i]), laplacian_, depth_);
      const double mean = cv::sum(laplacian_)[0] / pixels;
      scores[i] = laplacian_.dot(laplacian_) / pixels - mean * mean;
    }
  }

 private:
  int depth_;  // whichever is faster
  cv::Mat laplacian_;
};

class Tenengrad final : public PreparedPeer {
 public:
  explicit Tenengrad(int n) : gx_(n, n, CV_16S), gy_(n, n, CV_16S) { cv::setNumThreads(1); }

  void score(const Frame& frame, std::span<const Window> windows,
             std::span<double> scores) override {
    const double pixels = static_cast<double>(gx_.total());
    for (std::size_t i = 0; i < windows.size(); ++i) {
      cv::spatialGradient(pixels_of(frame, windows[i]), gx_, gy_);
      scores[i] = (gx_.dot(gx_) + gy_.dot(gy_)) / pixels;
    }
  }

 private:
  cv::Mat gx_, gy_;
};

}  // namespace

std::unique_ptr<PreparedPeer> prepare_opencv_laplacian(int n) {
  return std::make_unique<Laplacian>(n);
}

std::unique_ptr<PreparedPeer> prepare_opencv_tenengrad(int n) {
  return std::make_unique<Tenengrad>(n);
}

}  // namespace fathom::bench
