// SPDX-License-Identifier: Apache-2.0
// Focus runs on the simulated rig, the thesis' way and Fathom's own.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "focus/focus.hpp"
#include "session/session.hpp"
#include "tools/fathom/reproduce/effort.hpp"

namespace fathom::reproduce {

/// One of the thesis' three focus quality functions.
struct Transform3 {
  const char* metric;
  const char* name;        ///< As the thesis calls it.
  const char* short_name;  ///< Of a legend.
};
inline constexpr Transform3 kTransforms[] = {
    {"fft:64:hann", "Fourier transform", "FFT"},
    {"walsh-paley:64", "normal-ordered Walsh", "normal Walsh"},
    {"walsh-sequency:64", "sequency-ordered Walsh", "sequency Walsh"}};
inline constexpr std::size_t kFft = 0, kPaley = 1, kSequency = 2, kTransformCount = 3;

/// Numbers between two limits from a fixed seed, the same on every machine.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : random_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * (static_cast<double>(random_() >> 11) * 0x1p-53);
  }
  int below(int count) { return static_cast<int>(between(0, count)); }

 private:
  std::mt19937_64 random_;
};

/// A simulated rig, as text and options.
struct RigChoice {
  std::string target = "usaf";
  std::string metric = kTransforms[0].metric;
  std::uint64_t seed = kSeed;
  int average = 1;
  std::optional<Window> window;
  std::string more;  ///< Further keys of the rig, ",key=value".
};
using ShouldStop = std::function<bool()>;
RigOptions options_of(const RigChoice& choice, const ShouldStop& should_stop);

/// One focus run with the target at a known distance.
struct FocusRun {
  double distance_mm = 0;
  FocusResult result = FocusResult::no_focus;
  double position = 0;  ///< Steps.
  double sigma = 0;     ///< Steps.
  int evaluations = 0;
  double start = 0;        ///< Where the lens stood before, steps.
  double travel = 0;       ///< Of the lens, steps.
  double rig_seconds = 0;  ///< Moves, waits and exposures, on the rig's clock.
  int frames = 0;          ///< Repeated ones and second looks counted.

  bool focused() const { return result == FocusResult::focused; }
};

/// Places the target and searches. Throws as Rig::measure and resolve_limits.
FocusRun focus_run(Rig& rig, double distance_mm, const FocusRequest& request);

/// The thesis' search: golden section to 2 steps within a bracket round the focus, the best
/// position evaluated (T9). The operator's bracket reaches 20 to 120 steps to either side, by the
/// dice: so wide that the thesis' 7 to 11 evaluations come out.
FocusRequest thesis_request(double distance_mm, Dice& dice,
                            SearchMethod search = SearchMethod::golden);

/// One picture scored by all three transforms, so that nothing but the transform differs.
class ThreeScores final : private Observer {
 public:
  /// The choice's metric is not looked at. Throws as Rig.
  ThreeScores(const RigChoice& choice, const ShouldStop& should_stop);

  /// Moves, settles, takes a picture and scores it. Throws as Rig::measure.
  std::array<double, kTransformCount> at(double position);
  Lens& lens() { return rig_.lens(); }

 private:
  void frame(const Frame& frame, const Arrival& arrival, std::span<const double> scores) override;

  Rig rig_;                     ///< Of the first transform.
  std::vector<Scorer> others_;  ///< Of the other ones, in order.
  std::array<double, kTransformCount> scores_{};
};

/// Where the lens of the rig truly is in focus on a distance, steps: geometry, not measured.
double true_position(double distance_mm);
/// Half of the depth of field of the rig's lens, mm (eq. 3-3).
double half_depth_mm(double distance_mm);

/// What is still to be done, in pieces that do not depend on each other.
using Tasks = std::vector<std::function<void()>>;

/// Runs tasks on as many threads as there are processors. Each task must write only what is its
/// own, so that results do not depend on the order. on_done is told how many are done, by one
/// thread at a time. Throws what the first task that failed threw.
void run_all(const Tasks& tasks,
             const std::function<void(std::size_t done, std::size_t all)>& on_done);

}  // namespace fathom::reproduce
