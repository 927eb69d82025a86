// SPDX-License-Identifier: Apache-2.0
#include "engine/selection.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <optional>
#include <vector>

#include "engine/crossover.hpp"
#include "engine/device_list.hpp"
#include "engine/error.hpp"

namespace fathom {
namespace {

std::string label_of(const Listed& device) {
  return fmt::format("{}:{} ({})", device.backend->name(), device.index, device.info.name);
}

std::vector<Listed> numbered(const Backend& backend, std::vector<DeviceInfo> infos) {
  std::vector<Listed> devices;
  for (std::size_t i = 0; i < infos.size(); ++i) {
    devices.push_back({&backend, i, std::move(infos[i])});
  }
  return devices;
}

void tell(const DeviceOptions& options, Work work, const std::string& subject) {
  if (options.on_work) options.on_work(work, subject);
}

/// Tells that nothing takes long any more, however the choice ends.
class Done {
 public:
  explicit Done(const DeviceOptions& options) : options_(options) {}
  Done(const Done&) = delete;
  Done& operator=(const Done&) = delete;
  ~Done() { tell(options_, Work::done, {}); }

 private:
  const DeviceOptions& options_;
};

/// Throws Error(unavailable) where another device is in its place by now.
std::unique_ptr<Device> open(const Listed& listed, const DeviceOptions& options) {
  if (listed.backend->is_for_gpus()) tell(options, Work::opening, label_of(listed));
  try {
    auto device = listed.backend->open(listed.index, options);
    if (device->info().name == listed.info.name) return device;
  } catch (const Error& error) {
    if (error.code() == ErrorCode::unavailable) forget_devices(*listed.backend);
    throw;
  }
  forget_devices(*listed.backend);
  throw Error(ErrorCode::unavailable, "it is not there any more; the next start looks again");
}

/// The first device that opens and takes the metric; appends to `others` why each other one was
/// not taken.
std::optional<Selection> first_that_accepts(const std::vector<Listed>& devices,
                                            const MetricSpec& spec, const DeviceOptions& options,
                                            std::vector<std::string>& others) {
  std::optional<Selection> chosen;
  for (const Listed& listed : devices) {
    if (chosen) {  // a backend's other devices are no other choice
      if (chosen->backend != listed.backend->name()) {
        others.push_back(label_of(listed) + ": comes later");
      }
      continue;
    }
    try {
      auto device = open(listed, options);
      const std::string reason = device->unsupported(spec);
      if (reason.empty()) {
        chosen = Selection{listed.backend->name(), std::move(device), label_of(listed)};
      } else {
        others.push_back(label_of(listed) + ": " + reason);
      }
    } catch (const Error& error) {
      if (error.code() == ErrorCode::bad_argument)
        throw;  // the options; no other device likes them
      others.push_back(label_of(listed) + ": " + error.what());
    }
  }
  return chosen;
}

[[noreturn]] void refuse_all(const MetricSpec& spec, const std::vector<std::string>& refusals) {
  throw Error(ErrorCode::unsupported,
              fmt::format("no device computes {}: {}", spec.text(), fmt::join(refusals, "; ")));
}

Selection finish(Selection selection, std::string_view why,
                 const std::vector<std::string>& refusals) {
  selection.reason = fmt::format("{}, {}", selection.reason, why);
  if (!refusals.empty()) selection.reason += fmt::format("; not {}", fmt::join(refusals, "; not "));
  return selection;
}

/// Devices that `auto` may take, by what it takes them for.
struct Field {
  std::vector<Listed> cpus, gpus;
};

/// What `auto` is asked for.
struct Wish {
  const MetricSpec& spec;
  std::size_t windows;
  const DeviceOptions& options;
  const Clock& clock;
};

/// GPUs are looked for only if they are wanted, because connecting to their drivers takes longer
/// than many a score; and drivers are asked only if nobody knows what they answer.
Field field_of(std::span<const Backend* const> backends, bool wants_gpus, const Wish& wish,
               std::vector<std::string>& others) {
  Field field;
  for (const Backend* backend : backends) {
    if (!wants_gpus && backend->is_for_gpus()) {
      others.push_back(
          fmt::format("{}: only for {} windows a call and more", backend->name(), kFewestForGpu));
      continue;
    }
    auto infos = known_devices(*backend, wish.options.on_work, wish.clock);
    for (Listed& listed : numbered(*backend, std::move(infos))) {
      if (listed.info.kind == DeviceKind::software) {
        others.push_back(label_of(listed) + ": a software rasteriser, only on request");
      } else {
        (listed.info.kind == DeviceKind::gpu ? field.gpus : field.cpus)
            .push_back(std::move(listed));
      }
    }
  }
  return field;
}

std::string why_not(const Listed& gpu, std::size_t from) {
  return label_of(gpu) + (from == kNever ? std::string(": slower than the CPU")
                                         : fmt::format(": wins from {} windows a call on", from));
}

/// Without those that are known to lose to the CPU: they need not be opened.
std::vector<Listed> worth_opening(std::vector<Listed> gpus, const Device& cpu, const Wish& wish,
                                  std::vector<std::string>& others) {
  std::erase_if(gpus, [&](const Listed& gpu) {
    const auto from = crossovers_of(gpu, cpu, wish.clock).known(wish.spec.text());
    const bool loses = from && wish.windows < *from;
    if (loses) others.push_back(why_not(gpu, *from));
    return loses;
  });
  return gpus;
}

/// A GPU that scores so many windows sooner than the CPU.
struct Winner {
  Listed listed;
  Selection selection;
  std::size_t from;  ///< Windows a call.
};

/// Opens the GPU and measures it if need be; nothing where the CPU is sooner.
std::optional<Winner> winner_of(const Listed& gpu, Device& cpu, const Wish& wish,
                                std::vector<std::string>& others) {
  try {
    auto opened = first_that_accepts({gpu}, wish.spec, wish.options, others);
    if (!opened) return std::nullopt;
    if (!crossovers_of(gpu, cpu, wish.clock).known(wish.spec.text())) {
      tell(wish.options, Work::timing, label_of(gpu));
    }
    const std::size_t from = crossover(gpu, *opened->device, cpu, wish.spec, wish.clock);
    if (wish.windows >= from) return Winner{gpu, std::move(*opened), from};
    others.push_back(why_not(gpu, from));
  } catch (const Error& error) {
    others.push_back(label_of(gpu) + ": " + error.what());
  }
  return std::nullopt;
}

/// The fastest of several, which is measured if need be; the first where that fails.
std::size_t fastest_of(const std::vector<Winner>& winners, Rivals& rivals, const Wish& wish,
                       std::vector<std::string>& others) {
  std::vector<Device*> devices;
  std::string labels;
  for (const Winner& winner : winners) {
    devices.push_back(winner.selection.device.get());
    labels += (labels.empty() ? "" : " and ") + label_of(winner.listed);
  }
  try {
    tell(wish.options, Work::timing, labels);
    return rivals.measure(devices);
  } catch (const Error& error) {
    others.push_back(fmt::format("timing {}: {}", labels, error.what()));
    return 0;
  }
}

/// Of several GPUs the one that is known to be the fastest, if it still wins; so that the others
/// are not opened.
std::optional<Winner> known_winner(const std::vector<Listed>& gpus, Device& cpu, const Wish& wish,
                                   std::vector<std::string>& others) {
  const auto known = Rivals(gpus, wish.spec, wish.windows, wish.clock).known();
  if (!known || *known >= gpus.size()) return std::nullopt;
  std::vector<std::string> reasons;
  auto winner = winner_of(gpus[*known], cpu, wish, reasons);
  if (!winner) return winner;
  for (const Listed& gpu : gpus) {
    if (&gpu != &gpus[*known]) others.push_back(label_of(gpu) + ": slower than the other GPU");
  }
  return winner;
}

/// All of them are opened.
std::optional<Winner> measured_winner(const std::vector<Listed>& gpus, Device& cpu,
                                      const Wish& wish, std::vector<std::string>& others) {
  std::vector<Winner> winners;
  std::vector<Listed> rivals;
  for (const Listed& gpu : gpus) {
    auto winner = winner_of(gpu, cpu, wish, others);
    if (!winner) continue;
    rivals.push_back(gpu);
    winners.push_back(std::move(*winner));
  }
  if (winners.empty()) return std::nullopt;
  std::size_t best = 0;
  if (winners.size() > 1) {
    Rivals race(rivals, wish.spec, wish.windows, wish.clock);
    best = race.known().value_or(winners.size());
    if (best >= winners.size()) best = fastest_of(winners, race, wish, others);
  }
  for (std::size_t i = 0; i < winners.size(); ++i) {
    if (i != best) others.push_back(label_of(rivals[i]) + ": slower than the other GPU");
  }
  return std::move(winners[best]);
}

std::optional<Selection> gpu_that_wins(const std::vector<Listed>& listed, Device& cpu,
                                       const Wish& wish, std::vector<std::string>& others) {
  const auto gpus = worth_opening(listed, cpu, wish, others);
  std::optional<Winner> winner;
  if (gpus.size() > 1) winner = known_winner(gpus, cpu, wish, others);
  if (!winner) winner = measured_winner(gpus, cpu, wish, others);
  if (!winner) return std::nullopt;
  winner->selection.reason += fmt::format(", which wins from {} windows a call on", winner->from);
  return std::move(winner->selection);
}

Selection select_automatically(std::span<const Backend* const> backends, const Wish& wish) {
  const bool wants_gpus = wish.windows >= kFewestForGpu;
  std::vector<std::string> others;
  Field field = field_of(backends, wants_gpus, wish, others);
  auto cpu = first_that_accepts(field.cpus, wish.spec, wish.options, others);
  if (!cpu) {  // then any GPU will do
    if (!wants_gpus) {
      others.clear();
      field = field_of(backends, true, wish, others);
    }
    auto gpu = first_that_accepts(field.gpus, wish.spec, wish.options, others);
    if (gpu) return finish(std::move(*gpu), "there being no CPU for it", others);
    refuse_all(wish.spec, others);
  }
  if (auto gpu = gpu_that_wins(field.gpus, *cpu->device, wish, others)) {
    others.insert(others.begin(), cpu->reason + ": slower for so many windows");
    return finish(std::move(*gpu), fmt::format("for {} a call", wish.windows), others);
  }
  return finish(std::move(*cpu),
                wish.windows == 1 ? std::string("for single windows")
                                  : fmt::format("for {} windows a call", wish.windows),
                others);
}

std::vector<Listed> matching(std::vector<Listed> devices, std::string_view which) {
  std::size_t index = 0;
  const char* const end = which.data() + which.size();
  const auto [next, problem] = std::from_chars(which.data(), end, index);
  const bool by_index = problem == std::errc() && next == end;
  std::erase_if(devices, [&](const Listed& listed) {
    return by_index ? listed.index != index : listed.info.name.find(which) == std::string::npos;
  });
  return devices;
}

Selection select_by_name(std::span<const Backend* const> backends, std::string_view choice,
                         const MetricSpec& spec, const DeviceOptions& options, const Clock& clock) {
  const std::size_t colon = choice.find(':');
  const std::string_view name = choice.substr(0, colon);
  std::vector<std::string> names;
  for (const Backend* backend : backends) {
    names.emplace_back(backend->name());
    if (name != backend->name()) continue;
    if (backend->is_for_gpus()) tell(options, Work::listing, backend->name());
    auto devices = numbered(*backend, list_devices(*backend, clock));
    std::vector<std::string> labels;
    for (const Listed& device : devices) labels.push_back(label_of(device));
    if (colon != std::string_view::npos) {
      if (colon + 1 == choice.size()) {
        throw Error(ErrorCode::bad_argument,
                    fmt::format("backend \"{}\" names no device; write {} or {}:INDEX, as fathom "
                                "devices lists them",
                                choice, name, name));
      }
      devices = matching(std::move(devices), choice.substr(colon + 1));
    }
    if (devices.empty()) {
      throw Error(
          ErrorCode::unavailable,
          labels.empty()
              ? fmt::format("backend {} has no device: {}", name, why_no_device(*backend))
              : fmt::format("no device \"{}\"; there are {}", choice, fmt::join(labels, ", ")));
    }
    std::vector<std::string> refusals;
    if (auto chosen = first_that_accepts(devices, spec, options, refusals)) {
      return finish(std::move(*chosen), "as asked", refusals);
    }
    refuse_all(spec, refusals);
  }
  throw Error(ErrorCode::unavailable,
              fmt::format("no backend \"{}\"; there are auto, {}", name, fmt::join(names, ", ")));
}

}  // namespace

std::string why_no_device(const Backend& backend) {
  try {
    backend.open(0, {});
  } catch (const Error& error) {
    return error.what();
  }
  return "it came just now; try again";
}

namespace {

Selection select_as_wished(std::span<const Backend* const> backends, std::string_view choice,
                           const Wish& wish) {
  if (choice.empty() || choice == "auto") return select_automatically(backends, wish);
  if (choice.starts_with("auto:")) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("backend \"{}\": auto takes no index, it chooses the device itself; "
                            "write auto, or NAME:INDEX as fathom devices lists them",
                            choice));
  }
  return select_by_name(backends, choice, wish.spec, wish.options, wish.clock);
}

}  // namespace

Selection select_device(std::span<const Backend* const> backends, std::string_view choice,
                        const MetricSpec& spec, std::size_t windows, const DeviceOptions& options,
                        const Clock& clock) {
  const Done done(options);
  const Wish wish{spec, windows, options, clock};
  if (!choice.empty()) return select_as_wished(backends, choice, wish);
  const char* const wished = std::getenv("FATHOM_BACKEND");
  if (wished == nullptr || *wished == '\0') return select_as_wished(backends, "auto", wish);
  try {
    return select_as_wished(backends, wished, wish);
  } catch (const Error& error) {  // nobody sees a variable in what was typed
    throw Error(error.code(), fmt::format("FATHOM_BACKEND={}: {}", wished, error.what()));
  }
}

}  // namespace fathom
