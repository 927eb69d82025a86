// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/replay/manifest.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "tests/support/expect_error.hpp"

namespace fathom::test {
namespace {

void expect_refused(const std::string& text, std::initializer_list<const char*> texts) {
  expect_error(
      ErrorCode::bad_data, [&] { parse_manifest(text, "m.csv"); }, texts);
}

TEST(Manifest, ReadsColumnsInAnyOrder) {
  const Manifest manifest = parse_manifest(
      "# made by hand\n# unit: steps\n# coarse_spacing: 100\n\n"
      "position,page,file\r\n  12.5 , 3, a b.tif \n-1e3,0,\"x,\"\"y\"\".png\"\n",
      "m.csv");
  EXPECT_EQ(manifest.unit, "steps");
  EXPECT_EQ(manifest.coarse_spacing, 100);
  ASSERT_EQ(manifest.entries.size(), 2u);
  EXPECT_EQ(manifest.entries[0].file, "a b.tif");
  EXPECT_EQ(manifest.entries[0].position, 12.5);
  EXPECT_EQ(manifest.entries[0].page, 3u);
  EXPECT_EQ(manifest.entries[0].line, 6);
  EXPECT_EQ(manifest.entries[1].file, "x,\"y\".png");
  EXPECT_EQ(manifest.entries[1].position, -1000);
}

TEST(Manifest, UnitAndSpacingMayBeLeftOut) {
  const Manifest manifest = parse_manifest(
      "\xef\xbb\xbf"
      "file,position\na.png,1",
      "m.csv");
  EXPECT_EQ(manifest.unit, "units");
  EXPECT_FALSE(manifest.coarse_spacing);
}

TEST(Manifest, SeveralPicturesMayHaveOnePositionButNoneTwice) {
  const Manifest manifest = parse_manifest("file,position\na.png,1\nb.png,2\nc.png,1.0\n", "m.csv");
  EXPECT_EQ(manifest.entries.size(), 3u);
  expect_refused("file,position\na.png,0\nb.png,1\na.png,-0\n", {"m.csv line 4", "also on line 2"});
  expect_refused("file,position\na.png,0\n./a.png,2\n", {"line 3", "on line 2, at position 0"});
  EXPECT_EQ(parse_manifest("file,position,page\na.tif,0,0\na.tif,1,1\n", "m").entries.size(), 2u);
}

TEST(Manifest, OtherColumnsAndSeparatorsAreOthersAffair) {
  for (const char separator : {',', ';', '\t'}) {
    std::string text = "exposure,file,note,position\n20,a.png,,1.5\n20,b.png,x,2\n";
    std::replace(text.begin(), text.end(), ',', separator);
    const Manifest manifest = parse_manifest(text, "m.csv");
    ASSERT_EQ(manifest.entries.size(), 2u) << separator;
    EXPECT_EQ(manifest.entries[0].file, "a.png");
    EXPECT_EQ(manifest.entries[0].position, 1.5);
  }
}

TEST(Manifest, SpreadsheetsMayWriteCapitalsAndDecimalCommas) {
  for (const char separator : {';', '\t'}) {
    std::string text = "File;POSITION;Page\na.tif;-1,5;1\nb.tif;2.25;0\nc.tif;1e1;0\n";
    std::replace(text.begin(), text.end(), ';', separator);
    const Manifest manifest = parse_manifest(text, "m.csv");
    ASSERT_EQ(manifest.entries.size(), 3u);
    EXPECT_EQ(manifest.entries[0].position, -1.5);
    EXPECT_EQ(manifest.entries[0].page, 1u);
    EXPECT_EQ(manifest.entries[1].position, 2.25);
  }
  expect_refused("file;position\na.png;1.000,5\n", {"line 2", "\"1.000,5\" is not a number"});
  expect_refused("File,file,position\na,b,1\n", {"column file is there twice"});
}

TEST(Manifest, WhatBeginsWithANumberSignMayBeAPicture) {
  const Manifest manifest = parse_manifest(
      "# unit: um\n#file,position\nfile,position\na.png,1\n#b.png,2\n# later, perhaps\n# \"\n",
      "m.csv");
  EXPECT_EQ(manifest.entries.size(), 1u);
  ASSERT_EQ(manifest.perhaps.size(), 1u);
  EXPECT_EQ(manifest.perhaps[0].file, "#b.png");
  EXPECT_EQ(manifest.perhaps[0].position, 2);
}

TEST(Manifest, Utf16IsNamedAndNoRawBytesAreShown) {
  const auto wide = [](const std::string& text) {
    std::string result;
    for (const char c : text) result += {c, '\0'};
    return result;
  };
  expect_refused("\xff\xfe" + wide("file,position\n"), {"m.csv is UTF-16", "UTF-8"});
  expect_refused(wide("file,position\n"), {"m.csv is UTF-16"});
  expect_error(ErrorCode::bad_data, [] { parse_manifest("\x1b[31mfoo,bar\n", "m.csv"); },
               {"?[31mfoo,bar"});
}

TEST(Manifest, APositionThatIsNoNumberNamesItsLine) {
  for (const char* position :
       {"near", "nan", "inf", "-inf", "1e999", "1,5", "", "3 steps", "0x10"}) {
    expect_refused(std::string("file,position\na.png,1\nb.png,") + position + "\n",
                   {"m.csv line 3"});
  }
  expect_refused("file,position\na.png,near\n", {"position \"near\" is not a number"});
}

TEST(Manifest, OtherMistakesNameTheirLine) {
  expect_refused("", {"m.csv lists no pictures"});
  expect_refused("# unit: steps\n", {"lists no pictures"});
  expect_refused("file,position\n", {"lists no pictures"});
  expect_refused("file,place\na.png,1\n", {"line 1", "column position is missing", "file,place"});
  expect_refused("a.png,1\n", {"line 1", "column file is missing", "a.png,1"});
  expect_refused("file\na.png\n", {"column position is missing"});
  expect_refused("position\n1\n", {"column file is missing"});
  expect_refused("file,file,position\na,b,1\n", {"column file is there twice"});
  expect_refused("file,position\na.png\n", {"line 2", "1 fields where the first line names 2"});
  expect_refused("file,position\n,1\n", {"line 2", "name is missing"});
  expect_refused("file,position\n\"a.png,1\n", {"line 2", "a quote is not closed"});
  expect_refused("file,position\n\"a\"b,1\n", {"line 2", "text after a closing quote"});
  expect_refused("file,position,page\na.tif,1,-1\n", {"page \"-1\""});
  expect_refused("file,position,page\na.tif,1,1.5\n", {"page \"1.5\""});
  expect_refused("# unit:\nfile,position\na,1\n", {"line 1", "the unit is empty"});
  expect_refused("# unit: a\n# unit: b\nfile,position\na,1\n", {"line 2", "given twice"});
  expect_refused("# coarse_spacing: 0\nfile,position\na,1\n", {"line 1", "above 0"});
  expect_refused("# coarse_spacing: x\nfile,position\na,1\n", {"line 1", "not a number"});
}

TEST(Manifest, ComesBackExactlyAsItWasWritten) {
  Manifest manifest;
  manifest.unit = "um";
  manifest.coarse_spacing = 0.1;
  std::mt19937_64 random(21);
  std::uniform_real_distribution<double> exponent(-300, 300);
  for (int i = 0; i < 300; ++i) {
    manifest.entries.push_back({"frame_" + std::to_string(i) + ".png",
                                std::pow(10.0, exponent(random)) * (i % 2 == 0 ? 1 : -1),
                                static_cast<std::size_t>(i % 3)});
  }
  manifest.entries.push_back({"odd, \"name\".png", std::numeric_limits<double>::denorm_min()});
  manifest.entries.push_back({" # .png", 1.0 / 3});
  const std::string text = manifest_text(manifest);
  const Manifest back = parse_manifest(text, "m.csv");
  EXPECT_EQ(back.unit, manifest.unit);
  EXPECT_EQ(back.coarse_spacing, manifest.coarse_spacing);
  ASSERT_EQ(back.entries.size(), manifest.entries.size());
  for (std::size_t i = 0; i < back.entries.size(); ++i) {
    EXPECT_EQ(back.entries[i].file, manifest.entries[i].file);
    EXPECT_EQ(back.entries[i].position, manifest.entries[i].position);
    EXPECT_EQ(back.entries[i].page, manifest.entries[i].page);
  }
  EXPECT_EQ(manifest_text(back), text);
}

TEST(Manifest, WhatCouldNotBeReadIsNotWritten) {
  const auto write = [](Manifest manifest) { return [=] { manifest_text(manifest); }; };
  EXPECT_EQ(manifest_text({"um", {}, {}}), "# unit: um\nfile,position\n") << "as a capture begins";
  expect_error(ErrorCode::bad_argument, write({"um", {}, {{"a", 1}, {"a", 1}}}));
  expect_error(ErrorCode::bad_argument, write({"um", {}, {{"a", std::nan("")}}}));
  expect_error(ErrorCode::bad_argument, write({"um", {}, {{"a\nb", 1}}}));
  expect_error(ErrorCode::bad_argument, write({"", {}, {{"a", 1}}}));
}

}  // namespace
}  // namespace fathom::test
