// SPDX-License-Identifier: Apache-2.0
// fathom devices: what this machine computes with.
#include <map>

#include "backends/backends.hpp"
#include "engine/crossover.hpp"
#include "engine/device_list.hpp"
#include "engine/error.hpp"
#include "engine/selection.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/patience.hpp"
#include "tools/fathom/verbs.hpp"

namespace fathom::cli {
namespace {

struct Arguments {
  std::vector<std::string> metrics;
  bool json = false;
};

/// Metrics for which it is said what a device declines: those asked for, or every transform and
/// size with the options that a kernel could stumble over.
std::vector<MetricSpec> metrics_to_try(const std::vector<std::string>& asked) {
  std::vector<MetricSpec> specs;
  for (const std::string& text : asked) specs.push_back(MetricSpec::parse(text));
  if (!specs.empty()) return specs;
  for (int n = kSmallestWindow; n <= kLargestWindow; n *= 2) {
    for (const char* text :
         {"fft", "fft:power", "fft:none", "fft:band=0-0.25", "walsh-paley", "walsh-sequency",
          "walsh-hadamard", "walsh-sequency:hann", "walsh-sequency:power",
          "walsh-sequency:band=0-0.25", "fft:power:rings=4", "walsh-sequency:rings=3", "dct",
          "dct:power", "dct:entropy", "dct:entropy:band=0-0.25", "dct:rings=3"}) {
      specs.push_back(MetricSpec::parse(text, n));
    }
  }
  return specs;
}

/// Metrics for which it is said from how many windows on a GPU wins.
std::vector<MetricSpec> metrics_to_time(const std::vector<std::string>& asked) {
  if (!asked.empty()) return metrics_to_try(asked);
  return {MetricSpec::standard(Transform::fft, 64),
          MetricSpec::standard(Transform::walsh_sequency, 64)};
}

std::string joined(const std::vector<std::string>& texts) {
  constexpr std::size_t kMost = 6;
  std::string all;
  for (std::size_t i = 0; i < std::min(texts.size(), kMost); ++i) {
    all += (i == 0 ? "" : ", ") + texts[i];
  }
  if (texts.size() > kMost) all += fmt::format(" and {} more", texts.size() - kMost);
  return all;
}

/// "takes every metric", or what it declines and why.
std::string declines(const Device& device, const std::vector<MetricSpec>& specs) {
  std::map<std::string, std::vector<std::string>> by_reason;
  for (const MetricSpec& spec : specs) {
    const std::string reason = device.unsupported(spec);
    if (!reason.empty()) by_reason[reason].push_back(spec.text());
  }
  std::string text;
  for (const auto& [reason, declined] : by_reason) {
    text += fmt::format("{}declines {}: {}", text.empty() ? "" : "; ", joined(declined), reason);
  }
  return text.empty() ? "takes every metric" : text;
}

/// Which of the metrics that it takes have a kernel of their own: "; all are fused", or the others.
std::string unfused(const Device& device, const std::vector<MetricSpec>& specs) {
  std::vector<std::string> slow;
  std::size_t taken = 0;
  for (const MetricSpec& spec : specs) {
    if (!device.unsupported(spec).empty()) continue;
    ++taken;
    if (!device.fuses(spec)) slow.push_back(spec.text());
  }
  if (taken == 0) return {};
  return slow.empty() ? "; all are fused" : fmt::format("; not fused, so slow: {}", joined(slow));
}

/// From how many windows a call `auto` takes a GPU; measured where nobody has yet.
std::string crossovers(const Listed& listed, Device& gpu, const std::vector<MetricSpec>& specs,
                       const OnWork& say) {
  Progress progress;
  std::string text;
  for (const MetricSpec& spec : specs) {
    if (!gpu.unsupported(spec).empty()) continue;
    progress.show(
        [&] { return "measuring from how many windows on " + gpu.info().name + " wins"; });
    const auto cpu = select_device(all_backends(), "auto", spec, 1, {.on_work = say}).device;
    const std::size_t from = crossover(listed, gpu, *cpu, spec);
    text += fmt::format("{}{} for {}", text.empty() ? "" : ", ",
                        from == kNever ? "never" : fmt::format("from {} windows a call", from),
                        spec.text());
  }
  return "auto takes it " + (text.empty() ? "for no metric" : text);
}

std::unique_ptr<Device> open(const Backend& backend, std::size_t index, const OnWork& say) {
  if (backend.is_for_gpus()) say(Work::opening, fmt::format("{}:{}", backend.name(), index));
  return backend.open(index, {});
}

/// What is known of an opened device beyond its entry in the list.
std::vector<std::string> findings(const Backend& backend, std::size_t index,
                                  const Arguments& arguments, const OnWork& say) {
  try {
    const auto device = open(backend, index, say);
    const auto specs = metrics_to_try(arguments.metrics);
    std::vector<std::string> lines = {declines(*device, specs) + unfused(*device, specs)};
    say(Work::done, {});
    if (device->info().kind == DeviceKind::gpu) {
      lines.push_back(crossovers({&backend, index, device->info()}, *device,
                                 metrics_to_time(arguments.metrics), say));
    } else if (device->info().kind == DeviceKind::software) {
      lines.push_back("auto never takes a software rasteriser");
    }
    return lines;
  } catch (const Error& error) {
    say(Work::done, {});
    if (error.code() == ErrorCode::bad_argument) throw;
    return {fmt::format("cannot be used: {}", error.what())};
  }
}

void print_device(const Backend& backend, std::size_t index, const DeviceInfo& info,
                  const Arguments& arguments, const OnWork& say) {
  const auto lines = findings(backend, index, arguments, say);
  if (arguments.json) {
    JsonLine line;
    line.add("backend", backend.name())
        .add("index", index)
        .add("name", info.name)
        .add("kind", to_string(info.kind))
        .add("details", info.details)
        .add("metrics", lines[0]);
    if (lines.size() > 1) line.add("auto", lines[1]);
    return print_line(line.text());
  }
  print_line(fmt::format("{:<16} {:<9} {}: {}", fmt::format("{}:{}", backend.name(), index),
                         to_string(info.kind), info.name, info.details));
  for (const std::string& text : lines) print_line(fmt::format("{:<26} {}", "", text));
}

void run(const Arguments& arguments) {
  const OnWork say = patient_words();
  for (const Backend* backend : all_backends()) {
    if (backend->is_for_gpus()) say(Work::listing, backend->name());
    const auto infos = list_devices(*backend);
    say(Work::done, {});
    for (std::size_t i = 0; i < infos.size(); ++i)
      print_device(*backend, i, infos[i], arguments, say);
    if (infos.empty() && !arguments.json) {
      print_line(fmt::format("{:<16} {:<9} {}", backend->name(), "none", why_no_device(*backend)));
    }
  }
  if (arguments.json) return;
  for (const MetricSpec& spec : metrics_to_time(arguments.metrics)) {
    print_line(
        fmt::format("for {} auto takes {}", spec.text(),
                    select_device(all_backends(), "auto", spec, 1, {.on_work = say}).reason));
  }
}

}  // namespace

void add_devices(Verb& program) {
  Verb verb = program.add_verb("devices", "List the backends and devices of this machine");
  verb.set_footer("Examples:\n  fathom devices --json\n  fathom devices --metric fft:512");
  auto arguments = std::make_shared<Arguments>();
  verb.add_option("--metric", arguments->metrics,
                  "Say which devices decline it and from how many windows a call auto takes a GPU "
                  "for it, repeatable (default: every transform and size; two metrics of N = 64)")
      .takes_one_at_a_time();
  verb.add_flag("--json", arguments->json, "One JSON object a line on standard output");
  verb.on_run([arguments] {
    run(*arguments);
    return kDone;
  });
}

}  // namespace fathom::cli
