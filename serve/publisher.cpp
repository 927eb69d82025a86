// SPDX-License-Identifier: Apache-2.0
#include "serve/publisher.hpp"

#include "hal/clock.hpp"
#include "session/json_line.hpp"
#include "words/warning_words.hpp"

namespace fathom::serve {

void Publisher::warn(const std::string& text) {
  board.change([&](State& state) {
    if (state.measurement) state.measurement->warnings.push_back(text);
  });
  events.tell("warning", JsonLine().add("text", text).text());
}

Terms page_terms() {
  return {.average = "number of frames averaged",
          .window = "window",
          .ends = "the ends of the search",
          .wider = "a wider search",
          .metric_before = "metric ",
          .metric_after = "",
          .settling_check = "fathom rigs check"};
}

void Telling::began(const Run& run, std::size_t positions) {
  publisher_.board.change([&](State& state) {
    // A calibration has one curve after the other.
    state.measurement->points.clear();
    state.measurement->positions = positions;
    state.measurement->scatter = run.repeat_scatter;
  });
  publisher_.events.tell("began", JsonLine()
                                      .add("id", id_)
                                      .add("kind", to_string(kind_))
                                      .add("positions", positions)
                                      .add("scatter", run.repeat_scatter)
                                      .text());
}

void Telling::evaluated(const Measurement& measurement) {
  constexpr std::int64_t kMillisecond = 1'000'000;
  const PointView point{measurement.position, measurement.score,
                        (monotonic_now_ns() - began_ns_) / kMillisecond};
  publisher_.board.change([&](State& state) { state.measurement->points.push_back(point); });
  publisher_.events.tell("evaluated", JsonLine()
                                          .add("position", point.position)
                                          .add("score", point.score)
                                          .add("frames", measurement.frames)
                                          .text());
}

void Telling::warned(const Warning& warning) {
  for (const std::string& line : lines_of(warning, page_terms())) publisher_.warn(line);
}

}  // namespace fathom::serve
