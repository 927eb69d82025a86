// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/named_options.hpp"

#include <gtest/gtest.h>

namespace fathom::cli {
namespace {

TEST(Listed, ReadsLikeASentence) {
  const NamedOption options[] = {{"auto", "coarse, then fine"}, {"golden", ""}, {"full", "slow"}};
  EXPECT_EQ(listed(options, " or "), "auto (coarse, then fine), golden or full (slow)");
  EXPECT_EQ(listed(options, ", "), "auto (coarse, then fine), golden, full (slow)");
  EXPECT_EQ(listed({options, 1}, " or "), "auto (coarse, then fine)");
  EXPECT_EQ(listed({}, " or "), "");
}

}  // namespace
}  // namespace fathom::cli
