// SPDX-License-Identifier: Apache-2.0
// The camera of a rig that another computer serves.
#pragma once

#include <memory>

#include "hal/camera.hpp"
#include "hal/drivers/http/link.hpp"

namespace fathom::http {

/// Its settings are those that it was opened with over there.
class HttpCamera final : public Camera {
 public:
  explicit HttpCamera(std::shared_ptr<Link> link) : link_(std::move(link)) {}

  std::string description() const override;
  CameraSettings settings() const override { return link_->facts().camera.settings; }
  Validity validate(CameraSettings& wished) const override;
  void apply(const CameraSettings& settings) override;
  bool is_live() const override { return link_->facts().camera.is_live; }
  bool streams() const override { return link_->facts().camera.streams; }
  int recorded_here() const override { return link_->recorded_here(); }
  std::chrono::milliseconds patience() const override;
  FrameCounts counts() const override { return counts_; }
  std::optional<Frame> grab(std::chrono::milliseconds timeout) override;

 private:
  std::optional<Frame> ask_for_frame(std::chrono::milliseconds timeout);
  void count(const Answer& answer);

  std::shared_ptr<Link> link_;
  FrameCounts counts_;
  std::optional<FrameCounts> lost_before_;  ///< As the first answer told.
};

}  // namespace fathom::http
