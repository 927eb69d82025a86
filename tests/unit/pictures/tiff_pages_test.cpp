// SPDX-License-Identifier: Apache-2.0
// What a TIFF's pages are: planes behind one directory, planes as samples, previews, pages that
// are not all there; and what ImageJ and OME say of them.
#include <gtest/gtest.h>
#include <tiffio.h>

#include <cstring>
#include <limits>

#include "make_pictures.hpp"
#include "pictures/picture.hpp"
#include "pictures/stack_text.hpp"
#include "raw_tiff.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom::test {
namespace {

constexpr std::size_t kMissing = PictureStack::kMissing;

/// A page of 4 x 2 whose every pixel is `grey`.
RawPage plain(char grey) { return {.pixels = std::string(8, grey)}; }

/// The grey of the first pixel of every page; -1 for one that is not read.
std::vector<int> greys_of(PictureFile& file) {
  std::vector<int> greys;
  for (std::size_t page = 0; page < file.page_count(); ++page) {
    try {
      greys.push_back(static_cast<int>(file.read(page).at(3, 1)));
    } catch (const Error&) {
      greys.push_back(-1);
    }
  }
  return greys;
}

TEST(TiffPages, PlanesBehindOneDirectoryAreAllThere) {
  RawPage page = plain(0);
  page.pixels = std::string("\1\1\1\1\1\1\1\1\2\2\2\2\2\2\2\2\3\3\3\3\3\3\3\3", 24);
  page.fields[279] = 8;
  page.description = "ImageJ=1.53t\nimages=3\nslices=3\n";
  std::string bytes = raw_tiff({page});
  PictureFile imagej(bytes, "s.tif");
  EXPECT_EQ(greys_of(imagej), (std::vector<int>{1, 2, 3}));

  page.description.clear();
  page.fields[33629] = 3;  // MetaMorph; a real one has three numbers there, libtiff counts one
  const std::string one = raw_tiff({page});
  EXPECT_EQ(PictureFile(one, "s.stk").page_count(), 1u);

  // Cut off in the third plane: the first two stay.
  bytes.resize(bytes.size() - 3);
  PictureFile cut(bytes, "cut.tif");
  EXPECT_EQ(greys_of(cut), (std::vector<int>{1, 2, -1}));
  expect_error(ErrorCode::bad_data, [&] { cut.read(2); }, {"cut.tif page 2", "beyond the end"});
}

/// As ImageJ writes a stack: the first directory, the planes, and then the other directories.
std::string planes_before_directories(int planes, bool big_endian) {
  RawPage page = plain(0);
  page.pixels.clear();
  for (int i = 0; i < planes; ++i) page.pixels += std::string(8, static_cast<char>(i));
  page.fields[279] = 8;
  page.description = "ImageJ=1.53t\nimages=" + std::to_string(planes) + "\nslices=5\n";
  return raw_tiff({page, plain(1)}, big_endian);
}

TEST(TiffPages, AStackWhoseDirectoriesWereCutOffKeepsItsWholePlanes) {
  for (const bool big_endian : {false, true}) {
    const std::string whole = planes_before_directories(5, big_endian);
    const std::size_t start = whole.find(std::string(8, '\1'));
    const std::string bytes = whole.substr(0, start + 8 + 5);
    PictureFile file(bytes, "cut.tif");
    EXPECT_EQ(greys_of(file), (std::vector<int>{0, 1, -1}));
    EXPECT_EQ(file.contents().lost, 2u);
    EXPECT_EQ(file.contents().stacks.at(0).pages,
              (std::vector<std::size_t>{0, 1, 2, kMissing, kMissing}));
  }
  // Where the next directory lies between the planes, nothing is known of what is behind it.
  RawPage page = plain(7);
  page.description = "ImageJ=1.53t\nimages=2\nslices=2\n";
  std::string apart = raw_tiff({page, plain(8)});
  apart.resize(apart.size() - 60);
  PictureFile file(apart, "cut.tif");
  EXPECT_EQ(greys_of(file), (std::vector<int>{7, -1}));
}

TEST(TiffPages, PlanesBehindOneDirectoryKeepTheirByteOrder) {
  RawPage page{.width = 2, .height = 1, .bits = 16};
  page.pixels = std::string("\1\2\1\2\3\4\3\4", 8);
  page.fields[279] = 4;
  page.description = "ImageJ=1.53t\nimages=2\nslices=2\n";
  const std::string bytes = raw_tiff({page}, true);
  PictureFile file(bytes, "s.tif");
  EXPECT_EQ(file.read(0).at(0, 0), 0x0102u);
  EXPECT_EQ(file.read(1).at(1, 0), 0x0304u);
}

TEST(TiffPages, HiddenPlanesThatCannotBeReachedAreRefused) {
  TiffMaker maker{.width = 8, .height = 8, .compression = COMPRESSION_LZW};
  maker.values = noise(64, 255, 3);
  maker.description = "ImageJ=1.53t\nimages=7\nslices=7\n";
  const std::string packed = make_tiff(maker);
  expect_error(ErrorCode::bad_data, [&] { PictureFile(packed, "s.tif"); }, {"7 planes"});
}

TEST(TiffPages, SamplesThatAreNoColoursArePictures) {
  for (const bool separate : {false, true}) {
    TiffMaker maker{.width = 4, .height = 2, .samples = 5, .separate_planes = separate};
    for (int i = 0; i < 8 * 5; ++i) maker.values.push_back(static_cast<std::uint16_t>(10 + i % 5));
    const std::string bytes = make_tiff(maker);
    PictureFile file(bytes, "s.tif");
    EXPECT_EQ(greys_of(file), (std::vector<int>{10, 11, 12, 13, 14})) << separate;
    EXPECT_EQ(file.contents().samples_as_pages, 5u);
  }
}

TEST(TiffPages, PreviewsAreLeftOut) {
  RawPage preview = plain(9);
  preview.fields[254] = FILETYPE_REDUCEDIMAGE;
  RawPage mask = plain(8);
  mask.fields[254] = FILETYPE_MASK;
  RawPage page = plain(1);
  page.fields[254] = FILETYPE_PAGE;
  const std::string bytes = raw_tiff({preview, page, mask, plain(2)});
  PictureFile file(bytes, "s.tif");
  EXPECT_EQ(greys_of(file), (std::vector<int>{1, 2}));
  EXPECT_EQ(file.contents().previews, 2u);
  const std::string raw = raw_tiff({preview});
  expect_error(ErrorCode::bad_data, [&] { PictureFile(raw, "a.dng"); }, {"a.dng", "preview"});
}

TEST(TiffPages, StripsThatAreMissingAreRefusedAndTheOtherPagesStay) {
  for (const std::uint32_t tag : {273u, 279u}) {
    RawPage sparse = plain(7);
    sparse.fields[tag] = 0;
    const std::string alone = raw_tiff({sparse});
    expect_error(ErrorCode::bad_data, [&] { PictureFile(alone, "a.tif").read(); }, {"a.tif"});
    const std::string bytes = raw_tiff({plain(1), sparse, plain(3)});
    PictureFile file(bytes, "s.tif");
    EXPECT_EQ(greys_of(file), (std::vector<int>{1, -1, 3})) << tag;
    expect_error(ErrorCode::bad_data, [&] { file.read(1); }, {"s.tif page 1"});
  }
}

TEST(TiffPages, ACutOffFileKeepsItsWholePages) {
  const std::string whole = raw_tiff({plain(1), plain(2), plain(3)});
  for (const std::size_t lost : {1u, 12u, 60u}) {  // in the pixels, and in the directory
    const std::string bytes = whole.substr(0, whole.size() - lost);
    PictureFile file(bytes, "cut.tif");
    EXPECT_EQ(greys_of(file), (std::vector<int>{1, 2, -1})) << lost;
    ASSERT_EQ(file.contents().damaged.size(), 1u);
    EXPECT_EQ(file.contents().damaged.begin()->first, 2u);
  }
}

TEST(TiffPages, FloatsAndLongsBecomeGreysOrAreRefusedWithTheirRange) {
  const auto page_of = [](auto value, std::uint32_t format) {
    RawPage page{.width = 2, .height = 1, .bits = 8 * sizeof value};
    const decltype(value) low = 1;
    page.pixels.resize(2 * sizeof value);
    std::memcpy(page.pixels.data(), &low, sizeof low);
    std::memcpy(page.pixels.data() + sizeof low, &value, sizeof value);
    page.fields[339] = format;
    return raw_tiff({page});
  };
  const auto read = [](const std::string& bytes, double scale) {
    return PictureFile(bytes, "f.tif", {.scale = scale}).read().at(1, 0);
  };
  EXPECT_EQ(read(page_of(60000.4F, SAMPLEFORMAT_IEEEFP), 0), 60000u);
  EXPECT_EQ(read(page_of(1234.0, SAMPLEFORMAT_IEEEFP), 0), 1234u);
  EXPECT_EQ(read(page_of(0.25F, SAMPLEFORMAT_IEEEFP), 40000), 10000u);
  EXPECT_EQ(read(page_of(std::uint32_t{65535}, SAMPLEFORMAT_UINT), 0), 65535u);
  EXPECT_EQ(read(page_of(std::int16_t{300}, SAMPLEFORMAT_INT), 0), 300u);
  const auto refused = [&](const std::string& bytes, double scale,
                           std::initializer_list<const char*> texts) {
    expect_error(
        ErrorCode::bad_data, [&] { read(bytes, scale); }, texts);
  };
  refused(page_of(0.25F, SAMPLEFORMAT_IEEEFP), 0, {"from 0.25 to 1", "scale", "65535"});
  refused(page_of(70000.0F, SAMPLEFORMAT_IEEEFP), 0, {"from 1 to 70000", "0.499992"});
  refused(page_of(-3.0F, SAMPLEFORMAT_IEEEFP), 0, {"from -3 to 1"});
  refused(page_of(2.0F, SAMPLEFORMAT_IEEEFP), 40000, {"scale=40000"});
  refused(page_of(std::numeric_limits<float>::quiet_NaN(), SAMPLEFORMAT_IEEEFP), 0, {"no numbers"});
}

TEST(StackText, ImageJTellsOfChannelsSlicesAndTimes) {
  const auto found = pictures::parse_imagej(
      "ImageJ=1.53t\nimages=12\nchannels=2\nslices=3\nframes=2\nhyperstack=true\n"
      "unit=micron\nspacing=0.5\n");
  ASSERT_TRUE(found);
  EXPECT_EQ(found->images, 12u);
  const PictureStack& stack = found->stack;
  EXPECT_EQ(stack.spacing_um, 0.5);
  for (std::size_t time = 0; time < 2; ++time) {
    for (std::size_t slice = 0; slice < 3; ++slice) {
      for (std::size_t channel = 0; channel < 2; ++channel)
        EXPECT_EQ(stack.page_of(channel, slice, time), (time * 3 + slice) * 2 + channel);
    }
  }
  EXPECT_FALSE(pictures::parse_imagej("made by hand"));
  // Numbers that contradict each other, or would take the memory, say nothing.
  EXPECT_TRUE(pictures::parse_imagej("ImageJ=1\nimages=5\nslices=2\n")->stack.pages.empty());
  EXPECT_TRUE(pictures::parse_imagej("ImageJ=1\nimages=99999999999\n")->stack.pages.empty());
  EXPECT_TRUE(pictures::parse_imagej("ImageJ=1\nimages=0\nframes=0\n")->stack.pages.empty());
}

TEST(StackText, TifffileTellsOfTheAxesOfAnArray) {
  const auto found = pictures::parse_shaped("{\"shape\": [3, 4, 2, 9, 9], \"axes\": \"TZCYX\"}");
  ASSERT_TRUE(found);
  EXPECT_EQ(found->images, 24u);
  EXPECT_EQ(found->stack.page_of(1, 2, 1), 1u * 8 + 2 * 2 + 1);
  EXPECT_TRUE(pictures::parse_shaped("{\"axes\": \"ZYX\", \"shape\": [3, 9, 9]}"));
  for (const char* other :
       {"{\"shape\": [3, 9, 9]}", "{\"shape\": [3, 9, 9], \"axes\": \"QYX\"}", "{\"shape\": [",
        "{\"shape\": [3, 9], \"axes\": \"ZYX\"}", "{\"shape\": [2, 2, 9, 9], \"axes\": \"ZZYX\"}",
        "{\"shape\": [99999999999, 9, 9], \"axes\": \"ZYX\"}",
        "{\"shape\": [9, 9, 3], \"axes\": \"YXZ\"}"})
    EXPECT_FALSE(pictures::parse_shaped(other)) << other;
}

TEST(StackText, UnitsBecomeMicrometres) {
  EXPECT_EQ(pictures::micrometres(2, "\\u00B5m"), 2);
  EXPECT_EQ(pictures::micrometres(2, "\xc2\xb5m"), 2);
  EXPECT_EQ(pictures::micrometres(250, "nm"), 0.25);
  EXPECT_EQ(pictures::micrometres(0.5, "mm"), 500);
  EXPECT_FALSE(pictures::micrometres(2, "pixel"));
  EXPECT_FALSE(pictures::micrometres(-2, "um"));
}

std::optional<std::vector<PictureStack>> parsed(const std::string& pixels,
                                                std::string_view own_name = "a.tif") {
  std::vector<std::size_t> pages(24);
  for (std::size_t i = 0; i < pages.size(); ++i) pages[i] = i;
  return pictures::parse_ome(
      "<?xml version=\"1.0\"?><OME xmlns=\"x\"><Image ID=\"0\">" + pixels + "</Image></OME>",
      own_name, pages);
}

std::vector<PictureStack> ome(const std::string& pixels) { return parsed(pixels).value(); }

TEST(StackText, OmeTellsOfItsOrderSpacingAndNames) {
  const auto stacks =
      ome("<Pixels DimensionOrder=\"XYZCT\" SizeZ=\"4\" SizeC=\"2\" SizeT=\"3\" "
          "PhysicalSizeZ=\"300\" PhysicalSizeZUnit=\"nm\"><Channel Name=\"DAPI\"/>"
          "<Channel Name=\"GFP\"/><TiffData/></Pixels>");
  ASSERT_EQ(stacks.size(), 1u);
  EXPECT_EQ(stacks[0].channel_names, (std::vector<std::string>{"DAPI", "GFP"}));
  EXPECT_DOUBLE_EQ(stacks[0].spacing_um.value(), 0.3);
  EXPECT_EQ(stacks[0].page_of(1, 2, 0), 6u);
  EXPECT_EQ(stacks[0].page_of(0, 1, 2), 17u);
  const auto other =
      ome("<Pixels DimensionOrder=\"XYCTZ\" SizeZ=\"4\" SizeC=\"2\" SizeT=\"3\"></Pixels>");
  EXPECT_EQ(other.at(0).page_of(1, 3, 2), 23u);
  EXPECT_EQ(other.at(0).page_of(0, 1, 0), 6u);
}

TEST(StackText, OmePlacesRunsOfPlanesAndLeavesOtherFilesOut) {
  const auto stacks = ome(
      "<Pixels SizeZ=\"2\" SizeC=\"1\" SizeT=\"2\">"
      "<TiffData IFD=\"5\" FirstZ=\"1\" FirstT=\"0\"/>"
      "<TiffData IFD=\"3\" FirstZ=\"0\" FirstT=\"0\"><UUID FileName=\"a.tif\">u</UUID></TiffData>"
      "<TiffData IFD=\"0\" FirstT=\"1\" PlaneCount=\"2\"><UUID FileName=\"b.tif\">u</UUID>"
      "</TiffData></Pixels>");
  ASSERT_EQ(stacks.size(), 1u);
  EXPECT_EQ(stacks[0].pages, (std::vector<std::size_t>{3, 5, kMissing, kMissing}));
}

TEST(StackText, OmeCountsColoursOfAPixelOnce) {
  const auto stacks =
      ome("<Pixels SizeZ=\"5\" SizeC=\"3\" SizeT=\"1\"><Channel SamplesPerPixel=\"3\"/></Pixels>");
  EXPECT_EQ(stacks.at(0).channels, 1u);
}

TEST(StackText, DamagedOrHostileOmeSaysNothing) {
  EXPECT_FALSE(parsed("<Pixels SizeZ=\"5\">"));
  EXPECT_FALSE(parsed("<Pixels SizeZ=\"0\"/>"));
  EXPECT_FALSE(parsed("<Pixels SizeZ=\"99999999999\" SizeT=\"99999999999\"/>"));
  EXPECT_FALSE(
      pictures::parse_ome("<!DOCTYPE OME [<!ENTITY a \"b\">]><OME><Image><Pixels/>"
                          "</Image></OME>",
                          "a.tif", {}));
  EXPECT_TRUE(ome("<Description>of something else</Description>").empty());
}

}  // namespace
}  // namespace fathom::test
