// SPDX-License-Identifier: Apache-2.0
// The one JSON form of a focus: in run files, and in what programs print of one. It is complete, so
// that a run that is computed again can be compared in everything.
//
//   result, confidence                   the verdict
//   position, sigma, score, shape, ...   the answer; `nearest` is where the lens can go,
//                                        `nearest_file` the picture that a recording has there
//   lobes, evaluations                   where all peaks are; how many positions were evaluated
//   contrast, rise, needed_rise, reason  why the verdict is what it is
//   floor                                the score far from any focus
//   peaks, trace, background             all peaks; all evaluations; those of an earlier search
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "../engine/travel.hpp"
#include "../focus/focus.hpp"

namespace fathom {

nlohmann::ordered_json focus_to_json(const Focus& focus, const LensInfo& lens);

/// Reads what focus_to_json() writes. Throws nlohmann::json::exception, or Error(bad_data), for
/// anything else.
Focus focus_from_json(const nlohmann::ordered_json& json);

/// Reads the form of run files of version 2, which kept neither the floor nor what was evaluated.
Focus focus_from_version_2(const nlohmann::ordered_json& json, std::vector<Evaluation> evaluations);

/// The members of the same form on one line, without the braces round them: "result":"focused",...
/// A number is as short as it can be: 960, not 960.0.
std::string focus_members(const Focus& focus, const LensInfo& lens);

}  // namespace fathom
