// SPDX-License-Identifier: Apache-2.0
// Whether what is told of a target that moves is true: random targets of `sim`, at random speeds,
// followed for some answers each.
//
//   fathom_honesty_following [TARGETS [FASTEST]]     default: 100, 58 mm/s
//
// Prints how many answers were told, how many were off by more than half the depth of field, how
// many of those beyond 4 sigma as well (which are wrong), and error over sigma. Exit status 1 where
// more than one of a thousand is wrong.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>

#include "bench/honesty/thesis_rig.hpp"
#include "session/run_keeper.hpp"
#include "session/session.hpp"

namespace fathom::honesty {
namespace {

constexpr int kAnswers = 6;  ///< Of each target, the first search among them.
constexpr const char* kMetrics[] = {"fft", "walsh-sequency", "walsh-paley"};
constexpr const char* kObjects[] = {"usaf", "usaf", "seedling", "orange"};

struct Told {
  double answers = 0, focused = 0, off = 0, wrong = 0, squares = 0, evaluations = 0;

  void add(const Told& other) {
    answers += other.answers;
    focused += other.focused;
    off += other.off;
    wrong += other.wrong;
    squares += other.squares;
    evaluations += other.evaluations;
  }
  void print(const std::string& what) const {
    std::printf(
        "%-28s %5.0f answers, %5.0f focused, %4.0f off, %4.0f wrong, error/sigma %.2f rms, "
        "%.1f evaluations\n",
        what.c_str(), answers, focused, off, wrong, focused > 0 ? std::sqrt(squares / focused) : 0,
        evaluations / answers);
  }
};

void judge(const Focus& focus, double truth_mm, const std::string& rig, Told& told) {
  ++told.answers;
  told.evaluations += static_cast<double>(focus.evaluations.size());
  if (focus.result() != FocusResult::focused) return;
  const double error = focus.position() - steps_of(truth_mm);
  // An object has its depth elsewhere: bench/honesty/across knows of that.
  const double relief = rig.find("usaf") == std::string::npos ? 6 * steps_of(truth_mm) / 1700 : 0;
  const double z = error / std::hypot(focus.peak.sigma, relief);
  const bool off = std::abs(error) > half_depth_in_steps(truth_mm);
  ++told.focused;
  told.squares += z * z;
  told.off += off ? 1 : 0;
  if (off && std::abs(error) > 4 * focus.peak.sigma) {
    ++told.wrong;
    std::printf("  wrong: %s truth %.1f, told %.2f +- %.2f, confidence %.2f\n", rig.c_str(),
                steps_of(truth_mm), focus.position(), focus.peak.sigma, focus.verdict.confidence);
  }
}

/// first: the answer of the search that begins; rest: those that follow.
void follow(std::mt19937& random, double fastest, Told& first, Told& rest) {
  RigOptions options;
  options.metric = kMetrics[random() % 3];
  const std::string object = kObjects[random() % 4];
  const double distance = pick(random, 1350, 2600), speed = pick(random, -fastest, fastest);
  const double noise = pick(random, 0.5, 2);
  options.rig = "sim:target=" + object + ",seed=" + std::to_string(random() % 1000000) +
                ",distance=" + std::to_string(distance) + ",speed=" + std::to_string(speed) +
                ",noise=" + std::to_string(noise);
  options.backend = "cpu";
  Rig rig(options);
  // Whoever follows starts where the target is, within a part of the travel.
  const double at = steps_of(distance);
  RunKeeper keeper(setup_of(rig));
  Session session(rig);
  session.focus(FocusRequest::within(std::max(0.0, at - 250), std::min(1200.0, at + 250)), keeper);
  const std::string named = options.rig + " " + options.metric;
  judge(*keeper.file.runs.back().focus, rig.stage()->distance_mm(), named, first);
  for (int i = 1; i < kAnswers; ++i) {
    session.track(keeper.file.runs.back(), keeper);
    judge(*keeper.file.runs.back().focus, rig.stage()->distance_mm(), named, rest);
  }
}

int measure(int targets, double fastest) {
  std::mt19937 random(23);
  Told first, rest;
  for (int i = 0; i < targets; ++i) follow(random, fastest, first, rest);
  first.print("the first search");
  rest.print("what follows");
  return rest.wrong <= rest.answers / 1000 ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace
}  // namespace fathom::honesty

int main(int argc, char** argv) {
  const int targets = argc > 1 ? std::atoi(argv[1]) : 100;
  const double fastest = argc > 2 ? std::atof(argv[2]) : 58;
  if (targets > 0 && fastest > 0 && argc <= 3) return fathom::honesty::measure(targets, fastest);
  std::fprintf(stderr, "usage: fathom_honesty_following [TARGETS [FASTEST]]\n");
  return 2;
}
