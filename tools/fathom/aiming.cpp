// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/aiming.hpp"

#include <fmt/format.h>

#include <exception>
#include <utility>

#include "backends/backends.hpp"
#include "engine/error.hpp"
#include "mapping/window_choice.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/depth/surveying.hpp"
#include "tools/fathom/run_keeping.hpp"
#include "tools/fathom/verbs.hpp"

namespace fathom::cli {

using namespace mapping;
namespace {

TakingRequest look_round(const AimRequest& request) {
  return {.rig = request.rig.rig,
          .from = request.from,
          .to = request.to,
          .step = {},
          .is_coarse = true,
          .average = request.rig.average,
          .is_quiet = true,
          .needs_all = true};
}

/// Looks round. What was measured is kept where that fails.
Survey look(const AimRequest& request, Taking& taking, RunKeeper& keeper) {
  const MetricArguments& metric = request.rig.metric;
  const OpenDevice open = [&](const MetricSpec& spec, std::size_t windows) {
    return select_device(all_backends(), metric.backend, spec, windows, metric.device);
  };
  std::optional<BlurModel> blur = request.blur;
  if (!blur && request.calibration) blur = request.calibration->conditions().blur;
  try {
    return survey(taking, "looking round", open, blur, keeper);
  } catch (const Error&) {
    const auto again = [problem = std::current_exception()] { std::rethrow_exception(problem); };
    with_run_file(keeper.file, request.rig.output, request.rig.json, again, [] {});
    throw;
  }
}

void tell(const NoWindow& none, const AimRequest& request) {
  if (!request.rig.json)
    return print_line(fmt::format("{}: {}", to_string(none.result), none.reason));
  JsonLine line;
  line.add("result", to_string(none.result));
  for (const char* const member : request.unmeasured) line.add_null(member);
  print_line(line.add("reason", none.reason).text());
  note(none.reason);
}

}  // namespace

bool chooses_window(const RigArguments& rig) { return window_wish(rig.metric.window).has_value(); }

std::optional<Rig> aimed_rig(const AimRequest& request) {
  if (!chooses_window(request.rig)) return std::optional<Rig>(std::in_place, request.rig.options());
  RigArguments without = request.rig;
  without.metric.window.clear();
  RigOptions options = without.options();
  const WindowSide side = window_side(options.metric);
  Taking taking(look_round(request));
  RunKeeper keeper = start_run(request.verb, taking.rig());
  const Survey seen = look(request, taking, keeper);
  const ChosenWindow chosen =
      choose_window(seen, *window_wish(request.rig.metric.window), side, request.calibration);
  if (chosen.window) {
    note(chosen.words);
    options.window = chosen.window;
    return std::optional<Rig>(std::in_place, options, std::move(taking).release_rig().release());
  }
  const LensInfo lens = taking.rig().lens().info();
  const NoWindow none = no_window(seen, side,
                                  {.lens = lens,
                                   .is_live = taking.rig().camera().is_live(),
                                   .below = "--from below",
                                   .above = "--to above"});
  with_run_file(
      keeper.file, request.rig.output, request.rig.json, [] {}, [&] { tell(none, request); });
  return std::nullopt;
}

}  // namespace fathom::cli
