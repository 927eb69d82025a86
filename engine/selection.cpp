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
#include "engine/error.hpp"

namespace fathom {
namespace {

struct Candidate {
  const Backend* backend;
  std::size_t index;
  DeviceInfo info;

  std::string label() const { return fmt::format("{}:{} ({})", backend->name(), index, info.name); }
};

std::vector<Candidate> devices_of(const Backend& backend) {
  std::vector<Candidate> candidates;
  const auto infos = backend.devices();
  for (std::size_t i = 0; i < infos.size(); ++i) candidates.push_back({&backend, i, infos[i]});
  return candidates;
}

/// The first candidate that opens and takes the metric; appends to `others` why each other one was
/// not taken.
std::optional<Selection> first_that_accepts(const std::vector<Candidate>& candidates,
                                            const MetricSpec& spec, const DeviceOptions& options,
                                            std::vector<std::string>& others) {
  std::optional<Selection> chosen;
  for (const Candidate& candidate : candidates) {
    if (chosen) {  // a backend's other devices are no other choice
      if (chosen->backend != candidate.backend->name()) {
        others.push_back(candidate.label() + ": comes later");
      }
      continue;
    }
    try {
      auto device = candidate.backend->open(candidate.index, options);
      const std::string reason = device->unsupported(spec);
      if (reason.empty()) {
        chosen = Selection{candidate.backend->name(), std::move(device), candidate.label()};
      } else {
        others.push_back(candidate.label() + ": " + reason);
      }
    } catch (const Error& error) {
      if (error.code() == ErrorCode::bad_argument)
        throw;  // the options; no other device likes them
      others.push_back(candidate.label() + ": " + error.what());
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
  std::vector<Candidate> cpus, gpus;
};

/// GPUs are looked for only if they are wanted, because connecting to their drivers takes longer
/// than many a score.
Field field_of(std::span<const Backend* const> backends, bool wants_gpus,
               std::vector<std::string>& others) {
  Field field;
  for (const Backend* backend : backends) {
    if (!wants_gpus && backend->is_for_gpus()) {
      others.push_back(
          fmt::format("{}: only for {} windows a call and more", backend->name(), kFewestForGpu));
      continue;
    }
    for (Candidate& candidate : devices_of(*backend)) {
      if (candidate.info.kind == DeviceKind::software) {
        others.push_back(candidate.label() + ": a software rasteriser, only on request");
      } else {
        (candidate.info.kind == DeviceKind::gpu ? field.gpus : field.cpus)
            .push_back(std::move(candidate));
      }
    }
  }
  return field;
}

/// The first GPU that scores so many windows sooner than the CPU.
std::optional<Selection> gpu_that_wins(const Field& field, Device& cpu, const MetricSpec& spec,
                                       std::size_t windows, const DeviceOptions& options,
                                       std::vector<std::string>& others) {
  for (const Candidate& candidate : field.gpus) {
    auto gpu = first_that_accepts({candidate}, spec, options, others);
    if (!gpu) continue;
    try {
      const std::size_t from = crossover(candidate.backend->name(), *gpu->device, cpu, spec);
      if (windows >= from) {
        gpu->reason = fmt::format("{}, which wins from {} windows a call on", gpu->reason, from);
        return gpu;
      }
      others.push_back(candidate.label() +
                       (from == kNever ? std::string(": slower than the CPU")
                                       : fmt::format(": wins from {} windows a call on", from)));
    } catch (const Error& error) {
      others.push_back(candidate.label() + ": " + error.what());
    }
  }
  return std::nullopt;
}

Selection select_automatically(std::span<const Backend* const> backends, const MetricSpec& spec,
                               std::size_t windows, const DeviceOptions& options) {
  const bool wants_gpus = windows >= kFewestForGpu;
  std::vector<std::string> others;
  Field field = field_of(backends, wants_gpus, others);
  auto cpu = first_that_accepts(field.cpus, spec, options, others);
  if (!cpu) {  // then any GPU will do
    if (!wants_gpus) {
      others.clear();
      field = field_of(backends, true, others);
    }
    auto gpu = first_that_accepts(field.gpus, spec, options, others);
    if (gpu) return finish(std::move(*gpu), "there being no CPU for it", others);
    refuse_all(spec, others);
  }
  if (auto gpu = gpu_that_wins(field, *cpu->device, spec, windows, options, others)) {
    others.insert(others.begin(), cpu->reason + ": slower for so many windows");
    return finish(std::move(*gpu), fmt::format("for {} a call", windows), others);
  }
  const bool is_one = windows == 1;
  return finish(
      std::move(*cpu),
      is_one ? std::string("for single windows") : fmt::format("for {} windows a call", windows),
      others);
}

std::vector<Candidate> matching(std::vector<Candidate> devices, std::string_view which) {
  std::size_t index = 0;
  const char* const end = which.data() + which.size();
  const auto [next, problem] = std::from_chars(which.data(), end, index);
  const bool by_index = problem == std::errc() && next == end;
  std::erase_if(devices, [&](const Candidate& candidate) {
    return by_index ? candidate.index != index
                    : candidate.info.name.find(which) == std::string::npos;
  });
  return devices;
}

Selection select_by_name(std::span<const Backend* const> backends, std::string_view choice,
                         const MetricSpec& spec, const DeviceOptions& options) {
  const std::size_t colon = choice.find(':');
  const std::string_view name = choice.substr(0, colon);
  std::vector<std::string> names;
  for (const Backend* backend : backends) {
    names.emplace_back(backend->name());
    if (name != backend->name()) continue;
    auto devices = devices_of(*backend);
    std::vector<std::string> labels;
    for (const Candidate& device : devices) labels.push_back(device.label());
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

Selection select_device(std::span<const Backend* const> backends, std::string_view choice,
                        const MetricSpec& spec, std::size_t windows, const DeviceOptions& options) {
  if (choice.empty()) {
    const char* const wished = std::getenv("FATHOM_BACKEND");
    choice = wished != nullptr ? wished : "auto";
  }
  if (choice.empty() || choice == "auto")
    return select_automatically(backends, spec, windows, options);
  if (choice.starts_with("auto:")) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("backend \"{}\": auto takes no index, it chooses the device itself; "
                            "write auto, or NAME:INDEX as fathom devices lists them",
                            choice));
  }
  return select_by_name(backends, choice, spec, options);
}

}  // namespace fathom
