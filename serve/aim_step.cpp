// SPDX-License-Identifier: Apache-2.0
#include "serve/aim_step.hpp"

#include <fmt/format.h>

#include "backends/backends.hpp"
#include "mapping/depth_maker.hpp"
#include "mapping/stack_taker.hpp"
#include "mapping/window_choice.hpp"
#include "session/session.hpp"

namespace fathom::serve {

using namespace mapping;
namespace {

Survey look_round(const Work& work, Rig& rig, Observer& all, const DepthOptions& options) {
  const LensInfo lens = rig.lens().info();
  const CameraSettings picture = rig.camera().settings();
  const FocusLimits limits =
      resolve_limits(FocusRequest::within(work.order.from, work.order.to), lens);
  const std::vector<double> positions =
      sweep_positions(lens, limits.from, limits.to, coarse_step(lens, limits));
  const OpenDevice open = [&](const MetricSpec& spec, std::size_t windows) {
    return select_device(all_backends(), work.rig.backend, spec, windows, work.rig.device);
  };
  DepthMaker maker(open, {picture.width_px, picture.height_px, picture.depth}, false, positions,
                   options);
  StackAligner aligner(Alignment::similarity);
  StackTaker taker(maker, aligner);
  LensReturn put_back(rig.lens(), all);
  Observers both({&taker, &all});
  Session(rig).visit(positions, both);
  return survey_of(maker.finish(false), lens.unit, positions.size());
}

}  // namespace

void find_window(const Work& work, Rig& rig, Observer& all, Outcome& outcome) {
  const LensInfo lens = rig.lens().info();
  std::optional<Calibration> calibration;
  if (!work.order.calibration.empty()) calibration = calibration_for(work, lens.unit);
  DepthOptions options{.blur = rig.blur()};
  if (!options.blur && calibration) options.blur = calibration->conditions().blur;
  const WindowSide side = window_side(work.rig.metric);
  const Survey seen = look_round(work, rig, all, options);
  const ChosenWindow chosen = choose_window(seen, *window_wish(work.order.window), side,
                                            calibration ? &*calibration : nullptr);
  outcome.window = chosen.window;
  outcome.words = chosen.words;
  if (chosen.window) return;
  const NoWindow none = no_window(seen, side,
                                  {.lens = lens,
                                   .is_live = rig.camera().is_live(),
                                   .below = "From below",
                                   .above = "To above"});
  outcome.words = fmt::format("no window: {}", none.reason);
}

}  // namespace fathom::serve
