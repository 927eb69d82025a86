// SPDX-License-Identifier: Apache-2.0
// The focus curve as a lens shows it that may have play, or may not be where it says: seen going
// upward alone, in small steps. A search that turns round on its way sees two peaks there, or none.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "../focus/focus.hpp"
#include "rig.hpp"

namespace fathom {

/// A peak, in the lens's unit: what settling and backlash are measured on.
struct Hill {
  double position = 0;
  double half_width = 0;  ///< Above 0.
  double floor = 0;       ///< Score far from it,
  double height = 0;      ///< and how far it stands above that.
};

/// That of a focus which has_curve().
Hill hill_of(const Focus& focus);

/// What a picture is scored with.
struct Aim {
  MetricSpec metric;
  Window window;
};

/// Aims to try where the rig's own shows no focus: its own first, then metrics that see fainter
/// texture, in a larger window and in other parts of the picture.
std::vector<Aim> aims_to_try(Rig& rig);

/// A hill, and what showed it.
struct SeenHill {
  Hill hill;
  Aim aim;
};

/// Play that is looked for, as a part of the travel.
inline constexpr double kPlayOfTravel = 0.1;

/// Where a run-up has brought the lens, and how far that was.
struct RunUp {
  Arrival arrival;
  double distance = 0;
};

/// Goes so far before the start of a sweep that such play is taken up by then. up: which way the
/// sweep runs. Whoever calls waits until the lens may be believed to be there.
RunUp run_up(Rig& rig, double start, bool up);

/// Whether a move took no time, which no motor does: its driver does not wait for it. Recorded
/// pictures have no motor.
bool took_no_time(Rig& rig, const Arrival& arrival);

/// Looks whether a hill that a search has found is there when seen going upward alone. Nothing
/// where it is not. Throws as Rig::measure.
std::optional<Hill> see_again(Rig& rig, const Hill& hill);

/// Looks over the whole travel, upward alone, with all aims at once, and closer where something
/// stands out. The first aim wins unless another one sees a hill far more clearly. Where nothing is
/// seen, and the driver says that every move takes no time, it looks once more with much more time
/// for each. Nothing where no aim sees a hill, or where the best score is at an end of the travel.
/// aims: at least one. Throws as Rig::measure.
std::optional<SeenHill> find_hill(Rig& rig, std::span<const Aim> aims);

}  // namespace fathom
