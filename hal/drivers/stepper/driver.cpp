// SPDX-License-Identifier: Apache-2.0
// A lens moved by a stepper motor, whose driver board hangs on GPIO lines or on a parallel port.
#include <memory>

#include "hal/drivers/stepper/stepper_lens.hpp"
#include "hal/rig_driver.hpp"

namespace fathom {
namespace {

using namespace stepper;

class StepperDriver final : public RigDriver {
 public:
  const char* name() const noexcept override { return "stepper"; }

  const char* summary() const noexcept override {
    return "a lens on a STEP/DIR driver board, beside a camera in a rig file: port = \"gpio\" with "
           "chip, step and dir, or port = \"/dev/parport0\"; lowest, highest, rate, limit, "
           "backlash, home_by";
  }

  const char* bare_key() const noexcept override { return "port"; }

  std::span<const std::string_view> path_keys() const noexcept override {
    static constexpr std::string_view kKeys[] = {"state"};
    return kKeys;
  }

  bool has_lens_traits() const noexcept override { return true; }

  std::vector<FoundHardware> find() const override {
    std::vector<FoundHardware> found = find_parallel_ports();
    for (FoundHardware& chip : find_gpio_chips()) found.push_back(std::move(chip));
    return found;
  }

  Hardware open(const RigSettings& rig, const OpenOptions& options) const override {
    const Settings settings = Settings::read(rig);
    rig.require_all_used();  // before a wire changes its level
    if (!options.lens) return {};
    auto lines = settings.is_gpio ? open_gpio(settings.gpio, settings.pulse.rest)
                                  : open_parallel_port(settings.parallel, settings.pulse.rest);
    return {nullptr,
            std::make_unique<StepperLens>(settings, std::move(lines), monotonic_time(),
                                          options.stop_requests),
            nullptr};
  }
};

}  // namespace

const RigDriver& stepper_driver() {
  static const StepperDriver driver;
  return driver;
}

}  // namespace fathom
