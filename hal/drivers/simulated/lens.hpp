// SPDX-License-Identifier: Apache-2.0
// The simulated lens: it moves while the caller waits, or while the caller watches.
#pragma once

#include <memory>

#include "hal/drivers/simulated/world.hpp"
#include "hal/lens.hpp"
#include "hal/step_log.hpp"
#include "hal/stop.hpp"

namespace fathom::simulated {

class SimulatedMotion;

class SimulatedLens final : public Lens {
 public:
  SimulatedLens(std::shared_ptr<World> world, StopRequests stop_requests)
      : world_(std::move(world)), stop_requests_(std::move(stop_requests)) {}

  LensInfo info() const override;
  double position() const override;
  Arrival move_to(double position) override;
  Arrival home() override;
  std::unique_ptr<Motion> start(double position) override;
  std::string why_unwatched() const override { return {}; }

 private:
  friend class SimulatedMotion;

  void require_its_own() const;
  std::vector<int> legs(int to) const;
  Arrival settled(std::int64_t started_ns);

  std::shared_ptr<World> world_;
  StopRequests stop_requests_;
  bool is_approached_ = true;                // from below, the play taken up
  const SimulatedMotion* motion_ = nullptr;  // the one that lives
};

/// A move in simulated time, which passes while the camera exposes. It also passes, up to the next
/// step, when arrived() is asked twice with nothing between: somebody waits.
class SimulatedMotion final : public Motion {
 public:
  /// legs: of the way to `to`, perhaps none. `lens` must outlive this.
  SimulatedMotion(SimulatedLens& lens, std::vector<int> legs, int to);
  ~SimulatedMotion() override;

  void stop() override;
  std::optional<Arrival> arrived() override;
  Arrival wait() override;

  /// Whether the lens has arrived and settled, or the user did not want to wait for that.
  bool is_over() const;

 private:
  Where do_during(const Exposure& exposure) const override;

  /// When it settles if nothing more moves it.
  std::int64_t settled_ns() const { return stopped_ns() + World::kSettleNs; }
  std::int64_t stopped_ns() const;
  void heed_wish();
  void pass_time();
  Arrival arrival() const;

  SimulatedLens& lens_;
  World& world_;
  std::shared_ptr<StepLog> log_;
  StopWatch watch_;
  int from_, to_;
  std::int64_t started_ns_;
  std::int64_t asked_ns_ = -1;  // when arrived() was last asked
  bool was_stopped_ = false;    // on the way, by whomever,
  bool was_cancelled_ = false;  // and by the user
};

}  // namespace fathom::simulated
