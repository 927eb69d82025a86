// SPDX-License-Identifier: Apache-2.0
// Scores a part of a cv::Mat without copying it.
#include <fathom/backends/backends.hpp>
#include <fathom/engine/scorer.hpp>

#include <cstdio>
#include <opencv2/imgproc.hpp>

namespace {

// Of one channel, CV_8U or CV_16U; it must outlive the frame. A part of a larger cv::Mat will do.
fathom::Frame view_of(const cv::Mat& grey) {
  const auto depth = grey.depth() == CV_16U ? fathom::Depth::bits16 : fathom::Depth::bits8;
  return fathom::Frame::view(grey.data, grey.cols, grey.rows, depth, grey.step[0]);
}

}  // namespace

int main() {
  cv::Mat colour(240, 320, CV_8UC3), grey, blurred;
  cv::randu(colour, 0, 256);
  cv::cvtColor(colour, grey, cv::COLOR_BGR2GRAY);
  cv::GaussianBlur(grey, blurred, {7, 7}, 2);

  const auto spec = fathom::MetricSpec::parse("fft:64");
  fathom::Scorer scorer(fathom::select_device(fathom::all_backends(), "auto", spec, 1), spec,
                        fathom::Window{.x = 32, .y = 32, .n = 64});

  const cv::Rect part(100, 50, 128, 128);
  const double sharp = scorer.score(view_of(grey(part)));
  const double soft = scorer.score(view_of(blurred(part)));
  std::printf("sharp %.4g, blurred %.4g: %s\n", sharp, soft,
              sharp > soft ? "the first is sharper" : "the second is sharper");
}
