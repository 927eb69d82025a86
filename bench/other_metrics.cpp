// SPDX-License-Identifier: Apache-2.0
#include "bench/other_metrics.hpp"
#ifdef FATHOM_HAS_OPENCV
#include "bench/opencv/opencv.hpp"
#include "tools/fathom/gradient_metrics.hpp"
#endif

namespace fathom::bench {

std::span<const OtherMetric> other_metrics() {
#ifdef FATHOM_HAS_OPENCV
  static constexpr OtherMetric kMetrics[] = {
      {"peer-opencv-laplacian", "laplacian-variance", prepare_opencv_laplacian, laplacian_variance},
      {"peer-opencv-tenengrad", "tenengrad", prepare_opencv_tenengrad, tenengrad},
  };
  return kMetrics;
#else
  return {};
#endif
}

}  // namespace fathom::bench
