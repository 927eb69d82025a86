// SPDX-License-Identifier: Apache-2.0
// The colours of every plot. Those of lines and marks are told apart by those who see no red or no green, too
// (M. Okabe and K. Ito, "Color Universal Design", 2008). Six hexadecimal digits each, as Curve has them.
#pragma once

namespace fathom::cli::palette {

inline constexpr const char* kBlue = "0072b2";
inline constexpr const char* kVermilion = "d55e00";
inline constexpr const char* kGreen = "009e73";
inline constexpr const char* kPurple = "cc79a7";
inline constexpr const char* kOrange = "e69f00";
inline constexpr const char* kSky = "56b4e9";
inline constexpr const char* kBlack = "000000";

/// In the order in which lines take turns with them: neighbours differ most.
inline constexpr const char* kTurns[] = {kBlue, kVermilion, kGreen, kPurple, kOrange, kSky, kBlack};

// Greys, for what is no measurement, and faint fills, which carry no meaning of their own.
inline constexpr const char* kInk = "333333";
inline constexpr const char* kSoft = "6b7480";
inline constexpr const char* kFaint = "9aa5b1";
inline constexpr const char* kJoined = "c3ccd6";
inline constexpr const char* kGrid = "dddddd";
inline constexpr const char* kBand = "e8edf3";
inline constexpr const char* kBlueBand = "cfe0f3";
inline constexpr const char* kVermilionBand = "f6d5bd";

}  // namespace fathom::cli::palette
