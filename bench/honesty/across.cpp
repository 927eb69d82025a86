// SPDX-License-Identifier: Apache-2.0
// Whether the sigma of a distance is honest, on the object that was calibrated and on others: every
// object of `sim` is calibrated, and all of them are ranged with it, at random distances.
//
//   fathom_honesty_across [RUNS]     ranges of each pair of objects (default: 12)
//
// Prints, for each pair and for all alike and all unlike ones, the mean error, the root mean square
// of error over sigma, and the share beyond 4 sigma. Exit status 1 where sigma boasts.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "bench/honesty/thesis_rig.hpp"
#include "session/ranging.hpp"
#include "session/run_keeper.hpp"
#include "session/session.hpp"

namespace fathom::honesty {
namespace {

constexpr const char* kMetrics[] = {"fft", "walsh-sequency", "walsh-paley"};
constexpr const char* kObjects[] = {"usaf", "seedling", "orange"};
constexpr double kNearestMm = 1400, kFarthestMm = 2600;
constexpr int kCalibrated = 8;
constexpr unsigned kSeeds = 1'000'000;

/// Errors of distances, in sigmas and as parts of the distance.
struct Errors {
  double count = 0, bias = 0, squares = 0, beyond = 0;

  void add(const Distance& found, double truth_mm) {
    const double z = (found.mm - truth_mm) / found.sigma_mm;
    ++count;
    bias += (found.mm - truth_mm) / truth_mm;
    squares += z * z;
    beyond += std::abs(z) > 4 ? 1 : 0;
  }
  void add(const Errors& other) {
    count += other.count;
    bias += other.bias;
    squares += other.squares;
    beyond += other.beyond;
  }
  double rms() const { return std::sqrt(squares / count); }
  double share_beyond() const { return beyond / count; }
  void print(const std::string& what) const {
    std::printf("%-50s %5.0f ranges, mean error %+.3f %%, error/sigma %.2f rms, %.1f %% beyond 4\n",
                what.c_str(), count, 100 * bias / count, rms(), 100 * share_beyond());
  }
};

Rig open_rig(const std::string& object, unsigned seed, const std::string& metric) {
  RigOptions options;
  options.rig = "sim:target=" + object + ",seed=" + std::to_string(seed);
  options.metric = metric;
  options.backend = "cpu";
  return Rig(options);
}

void focus_at(Rig& rig, double distance_mm, RunKeeper& keeper) {
  rig.stage()->place_at(distance_mm);
  keeper.target_at(distance_mm);
  Session(rig).focus({}, keeper);
}

Calibration calibrate(const std::string& object, unsigned seed, const std::string& metric) {
  Rig rig = open_rig(object, seed, metric);
  RunKeeper keeper(setup_of(rig));
  for (int i = 0; i < kCalibrated; ++i) {
    const double part = static_cast<double>(i) / (kCalibrated - 1);
    focus_at(rig, kNearestMm + part * (kFarthestMm - kNearestMm), keeper);
  }
  return Calibration::fit(CalibrationModel::inverse, calibration_points(keeper.file.runs),
                          conditions_of(keeper.file.setup));
}

/// Ranges an object at random distances, each as a user would: with a file of its own.
Errors range(const Calibration& calibration, const std::string& object, unsigned seed,
             const std::string& metric, int count, std::mt19937& random) {
  Rig rig = open_rig(object, seed, metric);
  Errors errors;
  for (int i = 0; i < count; ++i) {
    RunKeeper keeper(setup_of(rig));
    keeper.file.calibration = calibration;
    keeper.file.extrapolate = true;
    const double truth_mm = pick(random, kNearestMm, kFarthestMm);
    focus_at(rig, truth_mm, keeper);
    const Run& run = keeper.file.runs[0];
    if (run.focus->result() != FocusResult::focused) continue;
    errors.add(range_of(keeper.file, keeper.file.runs).distance, truth_mm);
  }
  return errors;
}

bool is_honest(const Errors& errors, double least_rms) {
  return errors.rms() >= least_rms && errors.rms() <= 1.3 && errors.share_beyond() <= 0.01;
}

int measure(int count) {
  std::mt19937 random(19);
  Errors alike, unlike;
  for (const char* const metric : kMetrics) {
    for (const char* const calibrated : kObjects) {
      const auto seed = static_cast<unsigned>(random() % kSeeds);
      const Calibration calibration = calibrate(calibrated, seed, metric);
      for (const std::string object : kObjects) {
        // The same object again, and others of other seeds.
        const bool same = object == calibrated;
        const unsigned its_seed = same ? seed : static_cast<unsigned>(random() % kSeeds);
        const Errors errors =
            range(calibration, object, its_seed, metric, same ? 3 * count : count, random);
        errors.print(std::string(metric) + ", " + object + " by " + calibrated);
        (same ? alike : unlike).add(errors);
      }
    }
  }
  alike.print("the calibrated object");
  unlike.print("another object");
  return is_honest(alike, 0.7) && is_honest(unlike, 0) ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace
}  // namespace fathom::honesty

int main(int argc, char** argv) {
  const int count = argc > 1 ? std::atoi(argv[1]) : 12;
  if (count > 0 && argc <= 2) return fathom::honesty::measure(count);
  std::fprintf(stderr, "usage: fathom_honesty_across [RUNS]\n");
  return 2;
}
