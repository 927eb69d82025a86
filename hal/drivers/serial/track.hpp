// SPDX-License-Identifier: Apache-2.0
// Where a device said that it was, and so where the glass was between the answers.
#pragma once

#include <cstdint>
#include <vector>

#include "hal/glass.hpp"
#include "hal/motion.hpp"

namespace fathom::serial {

/// One move as a line through the places that the device told. An answer is true at some moment
/// between question and answer; between two answers the speed may change. Both are part of sigma, as
/// is the play of the gears (hal/glass.hpp): the glass lags behind on the way down.
class Track {
 public:
  /// A device that has stood at `position` since `since_ns`. play, resolution: in the lens's unit.
  Track(double position, bool is_approached, double play, double resolution, std::int64_t since_ns);

  /// It is sent on its way now; until then it stood.
  void depart(std::int64_t now_ns);
  void add(double position, std::int64_t asked_ns, std::int64_t heard_ns);
  /// It has come to rest at the end of its way, the play taken up.
  void arrive(double position, std::int64_t time_ns);
  /// It rests, wherever that is.
  void rest() { rests_ = true; }
  /// From here on nobody knows.
  void lose() { is_lost_ = true; }

  /// Whether the glass is surely where the motor stands.
  bool is_taken_up() const { return places_.back().glass.width() <= 0; }

  /// See Motion::during. now_ns: the end of what is known where it rests.
  Where during(const Exposure& exposure, std::int64_t now_ns) const;

 private:
  struct Place {
    std::int64_t time_ns;
    double half_ns;  ///< The place is true so long before or after, at most.
    Glass glass;
  };

  KnownTime known_time(std::int64_t now_ns) const;
  double at(std::int64_t time_ns) const;
  /// Units per ns between a place and the next; 0 beyond the ends.
  double speed(std::size_t i) const;
  double bend(std::size_t i) const;
  double variance(std::size_t i) const;

  std::vector<Place> places_;  // never empty
  std::size_t departed_ = 0;   // before this one it stood
  Play play_;
  double resolution_;
  bool rests_ = false, is_lost_ = false;
};

}  // namespace fathom::serial
