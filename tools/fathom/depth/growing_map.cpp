// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/depth/growing_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tools/fathom/depth/growing_rows.hpp"

namespace fathom::cli {

void GrowingMap::added(const DepthMaker& maker, std::size_t done, std::size_t total) {
  block_.show([&](const ProgressBlock::Room& room) {
    constexpr int kWidest = 72;
    std::vector<std::string> lines =
        growing_rows(maker.curves(), std::min(kWidest, room.columns), std::max(room.rows - 1, 1));
    if (may_colour()) std::ranges::transform(lines, lines.begin(), coloured_digits);
    std::string words = fmt::format("{} of {} frames; Ctrl-C keeps what is there", done, total);
    words.resize(std::min(words.size(), static_cast<std::size_t>(room.columns)));
    lines.push_back(words);
    return lines;
  });
}

}  // namespace fathom::cli
