// SPDX-License-Identifier: Apache-2.0
// How far and how long the lens travels for a focus, and how true the answer is: on the simulated
// thesis rig, from random places to random distances.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "bench/honesty/thesis_rig.hpp"
#include "bench/spectral/set_aside.hpp"
#include "bench/spectral/webcam.hpp"
#include "session/session.hpp"

namespace fathom {
namespace {

struct Options {
  int runs = 100;
  unsigned seed = 1;
  std::string target = "usaf";
  double noise = 1;
  std::string search = "auto";
  std::string metric = kSearchMetric;
  int frames = 0;     ///< A budget; 0: none.
  double within = 0;  ///< Starts no farther from the focus than so many steps; 0: anywhere.
  std::optional<bool> moving;  ///< While the lens travels, or with halts; else as it comes.
  bool list = false;
  bool webcam = false;  ///< Recordings like a webcam's instead.
};

/// Of a target that is in focus there, mm.
double distance_of(double steps) { return 135 + 1200.0 * 1084 / steps; }

/// One search, and what it came to.
struct Outcome {
  bool is_focused = false;
  double direct = 0;    ///< Steps from the start to the focus.
  double travel = 0;    ///< Steps that the lens was sent, all in all.
  double seconds = 0;   ///< Of the rig's clock.
  double error_mm = 0;  ///< Of the distance, by the rig's optics.
  double error = 0;     ///< Steps.
  double sigma = 0;     ///< Steps, as told.
  double distance = 0;  ///< mm.
  std::size_t evaluations = 0, at_rest = 0;
  double computing_ms = 0;  ///< Of all processors, for all but the making of pictures.
};

/// Where the scene is in focus: of one with a depth, where its pictures are sharpest.
double truth_of(const Options& options, const std::string& still, double distance_mm) {
  if (options.target == "usaf") return honesty::steps_of(distance_mm);
  return honesty::sharpest(still, options.metric, {}, distance_mm);
}

Outcome search_once(std::mt19937& random, const Options& options) {
  Outcome outcome;
  outcome.distance = honesty::pick(random, 1400, 2600);
  const double taped = honesty::steps_of(outcome.distance);
  const double reach = options.within > 0 ? options.within : 1200;
  const double start = std::floor(
      honesty::pick(random, std::max(0.0, taped - reach), std::min(1200.0, taped + reach)));
  const std::string still = fmt::format("sim:target={},distance={:.3f},seed={}", options.target,
                                        outcome.distance, random() % 1000000);
  const double truth = truth_of(options, still, outcome.distance);
  RigOptions rig_options;
  rig_options.rig = still + fmt::format(",start={},noise={}", start, options.noise);
  rig_options.metric = options.metric;
  const auto aside = std::make_shared<double>(0);
  Rig rig(rig_options, set_aside(open_hardware(rig_options.rig), aside));
  FocusRequest request;
  request.search = parse_search_method(options.search);
  if (options.frames > 0) request.frames = options.frames;
  request.moving = options.moving;
  Observer nobody;
  *aside = 0;
  const double began = processor_ms();
  const Run run = Session(rig).focus(request, nobody);
  outcome.computing_ms = processor_ms() - began - *aside;
  outcome.direct = std::abs(truth - start);
  const Journey journey = journey_of(run);
  outcome.travel = journey.travel;
  outcome.seconds = journey.rig_seconds;
  outcome.evaluations = run.measurements.size();
  outcome.at_rest = run.evaluations_at_rest().size();
  outcome.is_focused = run.focus->result() == FocusResult::focused;
  outcome.error = run.focus->position() - truth;
  outcome.sigma = run.focus->peak.sigma;
  outcome.error_mm = distance_of(run.focus->position()) - distance_of(truth);
  if (options.list)
    fmt::print(
        "{} : {} {:.2f} +- {:.2f} (truth {:.2f}), travel {:.0f} of {:.0f}, {} evaluations, "
        "{:.1f} ms, {}\n",
        rig_options.rig, to_string(run.focus->result()), run.focus->position(), outcome.sigma,
        truth, outcome.travel, outcome.direct, outcome.evaluations, outcome.computing_ms,
        run.focus->spectral_end ? to_string(*run.focus->spectral_end) : "by scores");
  return outcome;
}

void report(const std::vector<Outcome>& outcomes, const Options& options) {
  double direct = 0, travel = 0, seconds = 0, allowed = 0, part = 0, squares = 0, steps = 0;
  double evaluations = 0, at_rest = 0;
  std::vector<double> computing;
  std::size_t focused = 0, wrong = 0, close = 0;
  for (const Outcome& o : outcomes) {
    direct += o.direct;
    travel += o.travel;
    seconds += o.seconds;
    allowed += 1.5 * o.direct / 25 + 3;
    evaluations += static_cast<double>(o.evaluations);
    at_rest += static_cast<double>(o.at_rest);
    computing.push_back(o.computing_ms);
    if (!o.is_focused) continue;
    ++focused;
    part += std::abs(o.error_mm) / o.distance;
    squares += o.error * o.error / (o.sigma * o.sigma);
    steps += o.error * o.error;
    wrong += std::abs(o.error) > honesty::half_depth_in_steps(o.distance);
    close += std::abs(o.error_mm) < 0.005 * o.distance;
  }
  const auto n = static_cast<double>(outcomes.size()), f = static_cast<double>(focused);
  fmt::print("{} at noise {:g}, search {}, metric {}: {} of {} focused, {} wrong\n", options.target,
             options.noise, options.search, options.metric, focused, outcomes.size(), wrong);
  fmt::print("  travel       {:.0f} steps, {:.2f} times the direct way\n", travel / n,
             travel / direct);
  fmt::print("  rig time     {:.1f} s; 1.5 times direct travel at 25 steps/s and 3 s: {:.1f} s\n",
             seconds / n, allowed / n);
  fmt::print("  evaluations  {:.1f}, {:.1f} of them at rest\n", evaluations / n, at_rest / n);
  const auto middle = computing.begin() + static_cast<std::ptrdiff_t>(computing.size() / 2);
  std::nth_element(computing.begin(), middle, computing.end());
  fmt::print("  computing    {:.1f} ms of one processor, median; {:.1f} at most\n", *middle,
             *std::max_element(computing.begin(), computing.end()));
  fmt::print("  within 0.5 % of the distance: {} of {}\n", close, outcomes.size());
  fmt::print("  error        {:.4f} % of the distance, {:.2f} steps rms, {:.2f} sigmas rms\n",
             100 * part / f, std::sqrt(steps / f), std::sqrt(squares / f));
}

void search_all(const Options& options) {
  std::mt19937 random(options.seed);
  std::vector<Outcome> outcomes;
  for (int i = 0; i < options.runs; ++i) outcomes.push_back(search_once(random, options));
  if (options.moving) fmt::print("{}:\n", *options.moving ? "without a halt" : "with halts");
  report(outcomes, options);
}

[[noreturn]] void refuse(const std::string& what) {
  fmt::print(stderr,
             "fathom_spectral: {}\nusage: fathom_spectral [--runs N] [--seed N] [--target NAME] "
             "[--noise X] [--search NAME] [--metric M] [--frames N] [--within STEPS] "
             "[--moving | --halting] [--list]\n"
             "       fathom_spectral --webcam [--runs N] [--seed N] [--list]\n",
             what);
  std::exit(2);
}

template <class Number>
Number number(const std::string& name, const std::string& text) {
  Number value{};
  const char* const end = text.data() + text.size();
  const auto [next, problem] = std::from_chars(text.data(), end, value);
  if (problem != std::errc() || next != end || !(value >= 0)) refuse(name + " takes a number");
  return value;
}

/// Takes an option that has a value.
void take(Options& options, const std::string& name, const std::string& value) {
  if (name == "--runs") {
    options.runs = number<int>(name, value);
    if (options.runs == 0) refuse("--runs takes 1 or more");
  } else if (name == "--seed") {
    options.seed = number<unsigned>(name, value);
  } else if (name == "--target") {
    options.target = value;
  } else if (name == "--noise") {
    options.noise = number<double>(name, value);
  } else if (name == "--search") {
    options.search = value;
  } else if (name == "--metric") {
    options.metric = value;
  } else if (name == "--frames") {
    options.frames = number<int>(name, value);
  } else if (name == "--within") {
    options.within = number<double>(name, value);
  } else {
    refuse("there is no option " + name);
  }
}

int run(int count, char** arguments) {
  Options options;
  for (int i = 1; i < count; ++i) {
    const std::string name = arguments[i];
    if (name == "--moving" || name == "--halting") {
      options.moving = name == "--moving";
    } else if (name == "--list") {
      options.list = true;
    } else if (name == "--webcam") {
      options.webcam = true;
    } else if (i + 1 < count) {
      take(options, name, arguments[++i]);
    } else {
      refuse("there is no option " + name + ", or it lacks its value");
    }
  }
  if (options.webcam) return measure_webcam(options.runs, options.seed, options.list) ? 0 : 1;
  if (options.moving.value_or(false)) {  // beside the same scenes with halts
    Options halting = options;
    halting.moving = false;
    search_all(halting);
  }
  search_all(options);
  return 0;
}

}  // namespace
}  // namespace fathom

int main(int count, char** arguments) { return fathom::run(count, arguments); }
