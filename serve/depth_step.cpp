// SPDX-License-Identifier: Apache-2.0
#include "serve/depth_step.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>

#include "backends/backends.hpp"
#include "engine/error.hpp"
#include "hal/clock.hpp"
#include "mapping/depth_maker.hpp"
#include "mapping/growing.hpp"
#include "mapping/stack_taker.hpp"
#include "mapping/writing.hpp"
#include "session/json_line.hpp"
#include "session/run_store.hpp"
#include "session/session.hpp"

namespace fathom::serve {

using namespace mapping;
namespace {

std::string map_json(int columns, int rows, const std::string& unit, std::string_view values) {
  return JsonLine()
      .add("columns", columns)
      .add("rows", rows)
      .add("unit", unit)
      .add_json("values", values)
      .text();
}

void append_value(std::string& list, double value) {
  list += list.empty() ? "" : ",";
  list += std::isfinite(value) ? fmt::format("{:.6g}", value) : "null";
}

/// Where each place has been sharpest until now.
std::string growing_json(const DepthMaker& maker, const std::vector<double>& positions,
                         const std::string& unit) {
  const CurveGrid& curves = maker.curves();
  std::string values;
  for (const int frame : sharpest_frames(curves, curves.columns, curves.rows))
    append_value(values, frame == kNoFrame ? NAN : positions[static_cast<std::size_t>(frame)]);
  return map_json(curves.columns, curves.rows, unit, "[" + values + "]");
}

/// The whole map, in as many places.
std::string whole_json(const DepthResult& result) {
  const int columns = result.curves.columns, rows = result.curves.rows;
  std::string values;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const int x = (2 * column + 1) * result.maps.width_px / (2 * columns);
      const int y = (2 * row + 1) * result.maps.height_px / (2 * rows);
      append_value(values,
                   result.maps.position[static_cast<std::size_t>(y) * result.maps.width_px + x]);
    }
  }
  return map_json(columns, rows, result.unit, "[" + values + "]");
}

class Taker final : public StackTaker {
 public:
  Taker(DepthMaker& maker, StackAligner& aligner, const std::vector<double>& positions,
        std::string unit, Publisher& publisher)
      : StackTaker(maker, aligner),
        positions_(positions),
        unit_(std::move(unit)),
        publisher_(publisher) {}

  void frame(const Frame& frame, const Arrival& arrival, std::span<const double> scores) override {
    StackTaker::frame(frame, arrival, scores);
    constexpr std::int64_t kApart_ns = 500'000'000;
    const std::int64_t now = monotonic_now_ns();
    if (now - told_ns_ < kApart_ns || publisher_.events.readers() == 0) return;
    told_ns_ = now;
    publisher_.show_map(growing_json(maker(), positions_, unit_));
  }

 private:
  const std::vector<double>& positions_;
  std::string unit_;
  Publisher& publisher_;
  std::int64_t told_ns_ = 0;
};

std::vector<double> positions_for(const Order& order, const LensInfo& lens) {
  const FocusLimits limits = resolve_limits(FocusRequest::within(order.from, order.to), lens);
  std::vector<double> positions = sweep_positions(lens, limits.from, limits.to, order.step);
  constexpr std::size_t kFewest = 3;
  if (positions.size() >= kFewest) return positions;
  throw Error(ErrorCode::bad_argument,
              fmt::format("a depth takes {} positions at least, and these are {}", kFewest,
                          positions.size()));
}

/// Computes the map and writes it.
DepthResult finish(const Work& work, DepthMaker& maker, const LensInfo& lens, ReportFacts facts,
                   OutputFolder& folder) {
  facts.made = utc_now();
  facts.align = to_string(Alignment::similarity);
  facts.moved_px = maker.moved_px();
  DepthResult result = maker.finish(false);
  result.rig = work.rig.rig;
  result.lens_unit = result.unit = lens.unit;
  write_map(result, summary_of(result.maps), {}, facts, folder);
  folder.move_in();
  return result;
}

}  // namespace

void map_depth(Work& work, Rig& rig, Observer& all, Outcome& outcome) {
  const LensInfo lens = rig.lens().info();
  const CameraSettings picture = rig.camera().settings();
  const std::vector<double> positions = positions_for(work.order, lens);
  const auto name = std::filesystem::path("maps") / work.order.name;
  OutputFolder folder(work.folder / name);  // what cannot be written costs no measurement
  ReportFacts facts;
  facts.frames_expected = positions.size();
  const OpenDevice open = [&](const MetricSpec& spec, std::size_t windows) {
    Selection selection =
        select_device(all_backends(), work.rig.backend, spec, windows, work.rig.device);
    facts.backend = selection.backend;
    return selection;
  };
  DepthMaker maker(open, {picture.width_px, picture.height_px, picture.depth}, false, positions,
                   {.blur = rig.blur()});
  StackAligner aligner(Alignment::similarity);
  Taker taker(maker, aligner, positions, lens.unit, work.publisher);
  {
    LensReturn put_back(rig.lens(), all);
    Observers both({&taker, &all});
    Session(rig).visit(positions, both);
  }
  work.publisher.show_map(whole_json(finish(work, maker, lens, facts, folder)));
  outcome.folder = name;
  outcome.words = fmt::format("a map of {} pictures in {}", positions.size(), name.string());
}

}  // namespace fathom::serve
