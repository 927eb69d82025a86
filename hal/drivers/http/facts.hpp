// SPDX-License-Identifier: Apache-2.0
// What a service says of its rig: foreign data, read strictly. docs/http.md tells of the members.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

#include "engine/error.hpp"
#include "hal/camera.hpp"
#include "hal/lens.hpp"

namespace fathom::http {

struct CameraFacts {
  std::string description;
  CameraSettings settings;
  bool is_live = true;
  bool streams = false;
  int recorded_here = 1;
  std::chrono::milliseconds patience{0};
};

struct Facts {
  CameraFacts camera;
  LensInfo lens;
  bool has_stage = false;
};

/// Throws Error(bad_data) for what is no rig.
Facts facts_from(std::string_view json);

/// How a move stands.
struct Moved {
  bool is_done = false;
  Arrival arrival;        ///< Where it was done, and nothing failed; on the service's clock.
  int recorded_here = 1;  ///< Pictures of that place.
  std::optional<Error> failure;
};
/// Throws likewise.
Moved moved_from(std::string_view json);

/// A number under a name, and a whole one. Throw likewise.
double number_from(std::string_view json, const char* name);
int whole_from(std::string_view json, const char* name);

/// What {"error":{"code":..,"message":..}} says; "" of what does not.
struct Refusal {
  std::string code;
  std::string message;
};
Refusal refusal_from(std::string_view json);

/// The code of a name; bad_data for one that is not known.
ErrorCode code_named(std::string_view name);

/// A frame of a PGM. Throws likewise unless it has this shape.
Frame frame_from(std::string_view pgm, const CameraSettings& shape);

}  // namespace fathom::http
