// SPDX-License-Identifier: Apache-2.0
// The lens and the stage of a rig that another computer serves.
#pragma once

#include <memory>
#include <string>

#include "hal/drivers/http/link.hpp"
#include "hal/lens.hpp"

namespace fathom::http {

class HttpLens final : public Lens {
 public:
  explicit HttpLens(std::shared_ptr<Link> link) : link_(std::move(link)) {}

  LensInfo info() const override;
  double position() const override;
  Arrival move_to(double position) override;
  Arrival home() override;
  std::string why_unwatched() const override;
  void declare_at(double position) override;

 private:
  Arrival go(const std::string& body);
  Moved follow(int id);
  Moved stop(int id);
  Moved look(int id, std::chrono::milliseconds wait, bool may_stop);

  std::shared_ptr<Link> link_;
};

class HttpStage final : public TargetStage {
 public:
  explicit HttpStage(std::shared_ptr<Link> link) : link_(std::move(link)) {}
  double distance_mm() const override;
  double distance_mm(double x_px, double y_px) const override;
  void place_at(double distance_mm) override;

 private:
  std::shared_ptr<Link> link_;
};

}  // namespace fathom::http
