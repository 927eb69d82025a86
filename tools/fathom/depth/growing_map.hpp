// SPDX-License-Identifier: Apache-2.0
// A map of depth in a terminal, while its frames are taken.
#pragma once

#include "tools/fathom/depth/taking.hpp"

namespace fathom::cli {

class GrowingMap final : public TakingView {
 public:
  /// Whether the terminal can show it.
  bool is_live() const { return block_.is_live(); }
  void added(const DepthMaker& maker, std::size_t done, std::size_t total) override;
  void clear() override { block_.clear(); }

 private:
  ProgressBlock block_;
};

}  // namespace fathom::cli
