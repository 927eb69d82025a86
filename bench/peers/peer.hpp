// SPDX-License-Identifier: Apache-2.0
// What a careful user would have without Fathom: other libraries, or a plain loop nest, doing the
// SAME work, from 8-bit pixels in a frame to one number per window, on one thread, or on a device.
#pragma once

#include <memory>
#include <span>

#include "engine/frame.hpp"
#include "engine/metric.hpp"
#include "engine/window.hpp"

namespace fathom::bench {

/// One metric of a peer, ready to score: planned, its tables computed, its buffers allocated.
class PreparedPeer {
 public:
  virtual ~PreparedPeer() = default;
  PreparedPeer(const PreparedPeer&) = delete;
  PreparedPeer& operator=(const PreparedPeer&) = delete;

  /// Focus quality of windows of an 8-bit frame; scores[i] belongs to windows[i]. Unchecked.
  virtual void score(const Frame& frame, std::span<const Window> windows,
                     std::span<double> scores) = 0;

 protected:
  PreparedPeer() = default;
};

/// How long a peer may look for its fastest way.
enum class Planning {
  quick,    ///< No measurements: enough where only the scores matter.
  patient,  ///< As long as its library's most sensible thorough mode takes.
};

/// What a transform is timed with: its standard metric, of dct the entropy.
inline MetricSpec timed_metric(Transform transform, int n) {
  MetricSpec spec = MetricSpec::standard(transform, n);
  if (transform == Transform::dct) spec.measure = Measure::entropy;
  return spec;
}

/// Another way to compute a transform's timed_metric() at every N.
struct Peer {
  const char* name;
  Transform transform;
  std::unique_ptr<PreparedPeer> (*prepare)(int n, Planning planning);
  bool on_device = false;  ///< Not on the calling thread.

  MetricSpec metric(int n) const { return timed_metric(transform, n); }
};

/// Every peer that this build has and that there is a device for (bench/all_peers.cpp).
std::span<const Peer> all_peers();

std::unique_ptr<PreparedPeer> prepare_fftw(int n, Planning planning);
std::unique_ptr<PreparedPeer> prepare_fftw_walsh(int n, Planning planning);
std::unique_ptr<PreparedPeer> prepare_fftw_dct(int n, Planning planning);
std::unique_ptr<PreparedPeer> prepare_radix2_walsh(int n, Planning planning);
std::unique_ptr<PreparedPeer> prepare_radix2_int_walsh(int n, Planning planning);
/// Only in a build with FATHOM_FFHT_DIR.
std::unique_ptr<PreparedPeer> prepare_ffht(int n, Planning planning);

}  // namespace fathom::bench
