// SPDX-License-Identifier: Apache-2.0
// Windows of several sizes together: what the smaller ones tell counts first, and what they cannot tell
// the larger ones do.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "depth/ends.hpp"
#include "depth/nodes.hpp"
#include "depth/scoring.hpp"

namespace fathom::depth {

class Cascade {
 public:
  /// frames: numbers of those that were scored; positions: theirs; ends: of these. What is given must
  /// stay.
  Cascade(const Scoring& scoring, std::span<const std::size_t> frames,
          std::span<const double> positions, const StackBlur& blur, const FocusGrid& grid,
          const Ends& ends);

  /// Those of some rows of the finest level, row by row.
  std::vector<Peak> peaks(int first_row, int end_row) const;

  /// The nodes of the finest level. A few rows are in memory at a time.
  Nodes nodes(int threads) const;

 private:
  /// Where what a profile is made of comes from.
  struct Origin {
    float most = 0;     ///< Highest of the profile: how much it tells.
    float side_px = 0;  ///< Of the windows, in the mean.
    float dx_px = 0;    ///< Their middle, by what they tell, from the node.
    float dy_px = 0;

    /// The mean of both, by how much they tell.
    void add(const Origin& other);
  };

  /// What MatchedFilter::explain tells of some rows of a level: of each node a number for each focus,
  /// its profile, then one for each frame, its detail.
  struct Rows {
    Rows(int first_row, int end_row, std::size_t columns, std::size_t numbers)
        : first(first_row),
          end(end_row),
          told((end - first) * columns * numbers),
          origins((end - first) * columns) {}

    int first, end;
    std::vector<float> told;      ///< [row][column][number]
    std::vector<Origin> origins;  ///< [row][column]
  };

  /// Of node number i of the rows.
  template <class SomeRows>
  auto told(SomeRows& rows, std::size_t i) const {
    return std::span(rows.told).subspan(i * numbers_, numbers_);
  }
  template <class SomeRows>
  auto profile(SomeRows& rows, std::size_t i) const {
    return told(rows, i).first(foci_);
  }

  Rows own(std::size_t level, int first, int end) const;
  Rows smoothed(std::size_t level, int first, int end) const;
  Rows combined(std::size_t level, int first, int end) const;
  void add_coarser(std::size_t level, const Rows& coarser, Rows& rows) const;
  void smooth_origins(std::size_t level, const Rows& own_rows, Rows& rows) const;
  const Level& at(std::size_t level) const { return scoring_.levels()[level]; }
  int rows_at_once() const;

  const Scoring& scoring_;
  std::span<const std::size_t> frames_;
  std::vector<MatchedFilter> filters_;
  std::size_t foci_, numbers_;
  FocusGrid grid_;
  const Ends& ends_;
};

}  // namespace fathom::depth
