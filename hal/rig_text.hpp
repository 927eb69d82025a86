// SPDX-License-Identifier: Apache-2.0
// What a rig text or a rig file asks for, read before any hardware is touched.
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "rig_driver.hpp"

namespace fathom {

/// One driver and its options.
struct RigPart {
  const RigDriver* driver = nullptr;  ///< Never null in what the functions below return.
  RigSettings settings;
};

struct RigRequest {
  RigPart camera;               ///< Gives the lens and the stage too where `lens` is absent.
  std::optional<RigPart> lens;  ///< Of a rig file with the tables [camera] and [lens].
};

/// Reads "DRIVER", "DRIVER:key=value,..." or "DRIVER:BARE VALUE". Throws Error(bad_argument), with
/// the choices for an unknown driver.
RigPart parse_rig_options(std::string_view text);

/// Reads what open_hardware() takes: a rig text, or the path of a rig file. Throws as these two, and
/// Error(io).
RigRequest parse_rig(std::string_view text);

/// Reads the text of a rig file (TOML): driver = "NAME" and its keys at the top level, or tables
/// [camera] and [lens], each with its own driver. Paths (RigDriver::path_keys) are relative to
/// the file's folder. Throws Error(bad_data) with the line for what is no TOML, Error(bad_data)
/// for what is no rig, Error(bad_argument) for an unknown driver.
RigRequest parse_rig_file(std::string_view toml, const std::filesystem::path& path);

}  // namespace fathom
