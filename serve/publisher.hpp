// SPDX-License-Identifier: Apache-2.0
// What everybody may see of the rig, and an observer that puts measurements there.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "serve/event_feed.hpp"
#include "serve/picture_feed.hpp"
#include "serve/state.hpp"
#include "session/observer.hpp"
#include "words/terms.hpp"

namespace fathom::serve {

struct Publisher {
  Board board;
  EventFeed events;
  PictureFeed pictures;

  /// Changes the state and tells everybody.
  void change(const std::function<void(State&)>& change) {
    board.change(change);
    tell_state();
  }
  void tell_state() { events.tell("state", board.read(state_members)); }

  /// A line that does not end a measurement.
  void warn(const std::string& text);

  /// A map, as far as it is.
  void show_map(const std::string& json) {
    board.change([&](State& state) { state.map = json; });
    events.tell("map", json);
  }

  bool has_watchers() const { return events.readers() > 0 || pictures.watchers() > 0; }
};

/// What the page calls what a user may change.
Terms page_terms();

/// Tells everybody of one measurement.
class Telling final : public Observer {
 public:
  Telling(Publisher& publisher, int id, Activity kind, std::int64_t began_ns)
      : publisher_(publisher), id_(id), kind_(kind), began_ns_(began_ns) {}

  void began(const Run& run, std::size_t positions) override;
  void evaluated(const Measurement& measurement) override;
  void warned(const Warning& warning) override;

 private:
  Publisher& publisher_;
  int id_;
  Activity kind_;
  std::int64_t began_ns_;
};

}  // namespace fathom::serve
