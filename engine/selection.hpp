// SPDX-License-Identifier: Apache-2.0
// Which backend computes: the caller's choice, or the best that is there, and why.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "backend.hpp"
#include "clock.hpp"

namespace fathom {

/// An opened device and how it came to be chosen.
struct Selection {
  std::string backend;  ///< Its backend's name, e.g. "reference".
  std::unique_ptr<Device> device;
  std::string reason;  ///< One line: what was chosen and why each other was not.
};

/// What a backend that lists no device says when one is to be opened: the loader or the driver that
/// is missing.
std::string why_no_device(const Backend& backend);

/// Opens the device that a user's text names, for a metric.
///   "auto" or ""         the first CPU device that takes the metric, in the table's order; the
///                        fastest real GPU where a call holds so many windows that it wins (both
///                        are measured and kept: crossover.hpp); never a software rasteriser.
///                        Drivers that are known to have no such GPU are not asked again
///                        (device_list.hpp);
///   "NAME"               the first device of that backend that takes the metric;
///   "NAME:INDEX"         that device; "NAME:TEXT" the first whose name contains TEXT.
/// An empty text is first looked up in the environment variable FATHOM_BACKEND.
/// windows: how many a call will hold. The device is opened with the options, whose on_work hears
/// of what may take long. The clock is what devices are timed with.
/// Throws Error(bad_argument) for "NAME:" and "auto:...", Error(unavailable), listing the choices,
/// for a name that is not there, and Error(unsupported) with every reason where no device takes the
/// metric.
Selection select_device(std::span<const Backend* const> backends, std::string_view choice,
                        const MetricSpec& spec, std::size_t windows,
                        const DeviceOptions& options = {}, const Clock& clock = machine_clock());

}  // namespace fathom
