// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/replay/names.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace fathom::test {
namespace {

TEST(NaturalOrder, CountsAsPeopleDo) {
  using replay::natural_less;
  EXPECT_TRUE(natural_less("pcb_2.jpg", "pcb_10.jpg"));
  EXPECT_FALSE(natural_less("pcb_10.jpg", "pcb_2.jpg"));
  EXPECT_TRUE(natural_less("pcb_002.jpg", "pcb_10.jpg"));
  EXPECT_TRUE(natural_less("a", "b"));
  EXPECT_TRUE(natural_less("a", "a1"));
  EXPECT_TRUE(natural_less("a1b2", "a1b10"));
  EXPECT_TRUE(natural_less("a99999999999999999999998", "a99999999999999999999999"));
  EXPECT_FALSE(natural_less("a", "a"));
  // Names that differ by zeros only still have one order.
  EXPECT_NE(natural_less("x_01", "x_1"), natural_less("x_1", "x_01"));
}

/// The names, shuffled and put in order.
std::vector<std::string> sorted(std::vector<std::string> names) {
  std::mt19937 random(5);
  std::shuffle(names.begin(), names.end(), random);
  std::vector<std::string> result;
  for (const std::size_t index : replay::order_of(names).order) result.push_back(names[index]);
  return result;
}

TEST(OrderOfNames, NumbersCountAsNumbers) {
  const std::vector<std::vector<std::string>> rows = {
      {"lens_0.0.pgm", "lens_0.05.pgm", "lens_0.1.pgm", "lens_0.15.pgm", "lens_1.0.pgm"},
      {"z_-10.5.png", "z_-10.png", "z_-2.png", "z_0.png", "z_0.25.png", "z_3.png"},
      {"z-3.png", "z-2.png", "z0.png", "z1.png"},
      {"z_-3.png", "z_-2.png", "z_-1.png"},
      {"f_-1e-05.tif", "f_1e-05.tif", "f_0.002.tif", "f_1.0.tif", "f_1e+16.tif"},
      {"p 0,5.jpg", "p 1,25.jpg", "p 10,0.jpg"},
      {"img-001.png", "img-002.png", "img-010.png"},    // a hyphen
      {"fig 1.9.png", "fig 1.10.png", "fig 1.20.png"},  // chapters
      {"run2_z1.png", "run2_z2.png", "run10_z1.png"},
      {"2024-05-09_1.png", "2024-05-09_2.png", "2024-05-10_1.png"},
      {"t99999999999999999998.png", "t99999999999999999999.png"},
      {"preview.png", "z_-1.png", "z_0.png", "z_1.png"},  // a stray one
      {"f_1.tif", "f_2.pgm", "f_10.png"}};
  for (const auto& row : rows) {
    EXPECT_EQ(sorted(row), row);
    EXPECT_TRUE(replay::order_of(row).by_numbers) << row.front();
  }
  EXPECT_FALSE(replay::order_of({"left.png", "right.png"}).by_numbers);
  EXPECT_TRUE(replay::order_of({}).order.empty());
}

TEST(OrderOfNames, NamesWithTwoEndingsAreSeen) {
  const auto twice = replay::order_of({"f0.jpg", "f1.png", "f1.jpg", "f0.png", "f10.png"}).twice;
  ASSERT_TRUE(twice);
  EXPECT_EQ(twice->count, 2u);
  EXPECT_EQ(twice->first, "f0.jpg");
  EXPECT_EQ(twice->second, "f0.png");
  EXPECT_EQ(replay::order_of({"left.png", "right.png", "left.pgm"}).twice.value().count, 1u);
  EXPECT_FALSE(replay::order_of({"f1.png", "f01.png", "f1.5.png", "f2.jpg"}).twice);
}

TEST(OrderOfNames, LeftOutNumbersAreSeen) {
  const auto gap = replay::order_of({"f1.png", "f2.png", "f5.png", "f6.png", "f7.png"}).gap;
  ASSERT_TRUE(gap);
  EXPECT_EQ(gap->count, 2u);
  EXPECT_EQ(gap->before, "f2.png");
  EXPECT_EQ(gap->after, "f5.png");
  EXPECT_FALSE(replay::order_of({"f1.png", "f2.png", "f3.png", "f4.png"}).gap);
  // A travel of uneven steps leaves nothing out.
  EXPECT_FALSE(replay::order_of({"f0.png", "f10.png", "f13.png", "f40.png", "f95.png"}).gap);
  EXPECT_FALSE(replay::order_of({"f1.png", "f11.png", "f12.png", "f50.png", "f90.png"}).gap);
}

}  // namespace
}  // namespace fathom::test
