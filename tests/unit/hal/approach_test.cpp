// SPDX-License-Identifier: Apache-2.0
#include "hal/approach.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace fathom {
namespace {

using Moves = std::vector<int>;

TEST(Approach, UpwardIsOneMove) { EXPECT_EQ(approach_moves(10, 50, 8, 0), Moves{40}); }

TEST(Approach, DownwardGoesTooFarAndComesBackUp) {
  EXPECT_EQ(approach_moves(50, 10, 8, 0), (Moves{-48, 8}));
}

TEST(Approach, NoMoveWhereItStands) { EXPECT_EQ(approach_moves(10, 10, 8, 0), Moves{}); }

TEST(Approach, WithoutPlayDownwardIsOneMove) {
  EXPECT_EQ(approach_moves(50, 10, 0, 0), Moves{-40});
}

TEST(Approach, TheEndStopTakesThePlaceOfTheApproach) {
  EXPECT_EQ(approach_moves(50, 0, 8, 0), Moves{-50});
  EXPECT_EQ(approach_moves(50, 3, 8, 0), (Moves{-50, 3}));
  EXPECT_EQ(approach_moves(-10, -20, 8, -20), Moves{-10});
}

TEST(Approach, EveryPathArrivesNeverLeavesTheTravelAndEndsUpward) {
  for (int from = 0; from <= 40; ++from) {
    for (int to = 0; to <= 40; ++to) {
      for (const int takeup : {0, 1, 7, 100}) {
        const Moves moves = approach_moves(from, to, takeup, 0);
        int at = from;
        for (const int move : moves) {
          EXPECT_NE(move, 0);
          at += move;
          EXPECT_GE(at, 0);
        }
        EXPECT_EQ(at, to);
        if (takeup > 0 && to > 0 && !moves.empty()) {
          EXPECT_GT(moves.back(), 0) << from << " to " << to;
        }
      }
    }
  }
}

TEST(Approach, InDoubtEvenAShortUpwardMoveTakesUpThePlay) {
  EXPECT_EQ(approach_moves_in_doubt(50, 53, 8, 0), (Moves{-5, 8}));
  EXPECT_EQ(approach_moves_in_doubt(50, 50, 8, 0), (Moves{-8, 8}));
  EXPECT_EQ(approach_moves_in_doubt(50, 58, 8, 0), Moves{8}) << "that takes it up by itself";
  EXPECT_EQ(approach_moves_in_doubt(50, 10, 8, 0), (Moves{-48, 8}));
  EXPECT_EQ(approach_moves_in_doubt(3, 0, 8, 0), Moves{-3}) << "the end takes it up";
  EXPECT_EQ(approach_moves_in_doubt(50, 50, 0, 0), Moves{});
}

TEST(Accuracy, IsAStepOrWhatALongTravelHides) {
  EXPECT_EQ(accuracy_of({.description = "", .unit = "", .lowest = 0, .highest = 250, .stops = {}}),
            1.5);
  EXPECT_EQ(
      accuracy_of({.description = "", .unit = "", .lowest = 0, .highest = 100'000, .stops = {}}),
      50);
}

}  // namespace
}  // namespace fathom
