// SPDX-License-Identifier: Apache-2.0
#include "engine/error.hpp"
#include "hal/rig_driver.hpp"
namespace fathom {
namespace {
struct Driver final : RigDriver {
  const char* name() const noexcept override { return "replay"; }
  const char* summary() const noexcept override { return ""; }
  Hardware open(const RigSettings&) const override { throw Error(ErrorCode::unavailable, "wip"); }
};
}  // namespace
const RigDriver& replay_driver() { static const Driver d; return d; }
}  // namespace fathom
