// SPDX-License-Identifier: Apache-2.0
// When a buffer's frame was exposed, and how many were lost before it.
//
// V4L2 stamps a buffer on CLOCK_MONOTONIC, but at a moment of the driver's choice, and none of them
// knows the shutter:
//   last_byte    (V4L2_BUF_FLAG_TSTAMP_SRC_EOF, most drivers) the picture has arrived: exposed and
//                read out, which takes up to a frame's interval;
//   first_byte   (uvcvideo, though it claims SRC_SOE) the first packet has arrived: exposed, and
//                not read out yet;
//   exposure     (V4L2_BUF_FLAG_TSTAMP_SRC_SOE of others) the exposure begins;
//   none         no stamp on this clock. The frame is not older than the last time at which no
//                buffer was ready, which is then the stamp of a last byte.
// A camera that works its pictures up before it sends them (JPEG, an image processor) is late by
// whole frames more, `delay_frames`, which nobody can ask it. So
//   start = stamp - delay_frames intervals - readout - exposure,
// where an exposure that is not known lasts an interval, and a stream that is slower than its
// driver says (long exposures) has the interval that was measured last, and no shorter one than its
// exposure.
#pragma once

#include <cstdint>
#include <optional>

#include "engine/frame.hpp"

namespace fathom::v4l2 {

enum class StampKind { last_byte, first_byte, exposure, none };

/// A buffer as it was taken out of the driver's queue.
struct Delivery {
  std::uint32_t sequence = 0;  ///< The driver's number of the frame.
  StampKind kind = StampKind::none;
  std::int64_t stamp_ns = 0;
  /// Since when the driver has had a buffer to fill, without a pause;
  std::int64_t ready_since_ns = 0;
  std::int64_t taken_ns = 0;  ///< when this one was taken back.
};

class FrameClock {
 public:
  /// interval_ns: from frame to frame as the driver says, or 0; start_ns: when the stream began.
  FrameClock(std::int64_t interval_ns, double delay_frames, std::int64_t start_ns);

  /// No buffer was ready.
  void nothing_ready(std::int64_t now_ns) { empty_ns_ = now_ns; }

  /// Every delivery goes through here, damaged ones too. exposure_ns: 0 where nobody knows. Starts
  /// and ends increase from frame to frame.
  Exposure read(const Delivery& delivery, std::int64_t exposure_ns);

  /// Frames that the numbers say were lost so far, though a buffer waited for them. What passes
  /// while all buffers are full, because nobody grabs, is not a loss.
  std::uint64_t lost() const { return lost_; }

 private:
  struct Last {
    std::uint32_t sequence;
    std::int64_t stamp_ns;
    Exposure exposure;
  };
  /// Moment and kind that can be relied on.
  struct Stamp {
    StampKind kind;
    std::int64_t ns;
  };
  Stamp stamp_of(const Delivery& delivery) const;
  std::int64_t start_of(const Stamp& stamp, std::int64_t open_ns, std::int64_t interval_ns) const;
  std::int64_t slowest_interval_ns(std::int64_t exposure_ns) const;
  void count(const Delivery& delivery, std::int64_t stamp_ns, std::int64_t exposure_ns);

  std::int64_t interval_ns_;
  std::int64_t measured_ns_ = 0;  ///< Between the last two frames without a pause; 0: none yet.
  double delay_frames_;
  std::int64_t empty_ns_;
  std::optional<Last> last_;
  std::uint64_t lost_ = 0;
};

}  // namespace fathom::v4l2
