// SPDX-License-Identifier: Apache-2.0
// The parts that read what a server sends: XML, base64, FITS.
#include <fmt/format.h>

#include <regex>

#include "engine/file.hpp"
#include "hal/drivers/indi/base64.hpp"
#include "hal/drivers/indi/devices.hpp"
#include "hal/drivers/indi/fits.hpp"
#include "hal/drivers/indi/settings.hpp"
#include "hal/drivers/indi/xml_stream.hpp"
#include "hal/rig_text.hpp"
#include "support.hpp"

namespace fathom::test {
namespace {

using namespace indi;

std::string text_of(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::vector<std::byte> bytes_of(const std::string& text) {
  const auto* const first = reinterpret_cast<const std::byte*>(text.data());
  return {first, first + text.size()};
}

TEST(IndiBase64, DecodesInAnyPieces) {
  // RFC 4648, section 10.
  for (const auto& [text, wanted] : {std::pair{"", ""},
                                     {"Zg==", "f"},
                                     {"Zm8=", "fo"},
                                     {"Zm9v", "foo"},
                                     {"Zm9v\nYmFy", "foobar"}}) {
    Base64Decoder decoder;
    std::vector<std::byte> bytes;
    for (const char c : std::string_view(text)) EXPECT_TRUE(decoder.decode({&c, 1}, bytes));
    EXPECT_EQ(text_of(bytes), wanted);
    EXPECT_TRUE(decoder.is_complete());
  }
}

TEST(IndiBase64, RefusesWhatIsNone) {
  for (const char* text : {"Zm9*", "=Zm9", "Z===", "Zg==Zg==", "Zg=v", "Zm9", "Z"}) {
    Base64Decoder decoder;
    std::vector<std::byte> bytes;
    EXPECT_FALSE(decoder.decode(text, bytes) && decoder.is_complete()) << text;
  }
}

TEST(IndiXml, ElementsComeWholeHoweverTheyAreCut) {
  const std::string text =
      "<defNumberVector device=\"A &amp; B\" name='N' state=\"Ok\">\n"
      "<defNumber name='X' min='1' max='9'>\n 4.5 \n</defNumber></defNumberVector>\n"
      "<delProperty device='A &amp; B'/>";
  for (std::size_t size = 1; size <= text.size(); size += 7) {
    XmlStream stream;
    std::vector<Element> elements;
    for (std::size_t at = 0; at < text.size(); at += size) {
      for (Element& element : stream.feed(text.substr(at, size))) elements.push_back(element);
    }
    ASSERT_EQ(elements.size(), 2u);
    EXPECT_EQ(elements[0].attribute("device"), "A & B");
    ASSERT_EQ(elements[0].members.size(), 1u);
    EXPECT_EQ(elements[0].members[0].text, "4.5");
    EXPECT_EQ(elements[0].members[0].attribute("max"), "9");
    EXPECT_EQ(elements[1].tag, "delProperty");
  }
}

void expect_refused(const std::string& text, const char* why) {
  XmlStream stream;
  stream.set_blob_limit(1000);
  expect_error(ErrorCode::bad_data, [&] { stream.feed(text); }, {why});
  expect_error(ErrorCode::bad_data, [&] { stream.feed("<message/>"); });  // the stream is over
}

TEST(IndiXml, WhatIsNoneIsRefused) {
  expect_refused("<a><b></a>", "mismatched");
  expect_refused("</indi>trailing", "");
  expect_refused("<!DOCTYPE x [<!ENTITY a 'aaaa'>]>", "XML");
  expect_refused("<message device='&lol;'/>", "entity");
  expect_refused(std::string("<message device='\0'/>", 21), "XML");
  expect_refused("<a><b><c/></b></a>", "within");
}

TEST(IndiXml, WhatGrowsWithoutEndIsRefused) {
  expect_refused("<message device='" + std::string(1'000'000, 'x'), "64 KiB");
  expect_refused("<defTextVector><defText>" + std::string(100'000, 'x'), "64 KiB");
  std::string many = "<defTextVector>";
  for (int i = 0; i < 5000; ++i) many += "<defText/>";
  expect_refused(many, "members");
  std::string strange;
  for (int i = 0; i < 10'001; ++i) strange += fmt::format("<x{}/>", i);
  expect_refused(strange, "INDI");
  expect_refused("<setBLOBVector><oneBLOB size='1001'>", "1001");
  expect_refused("<setBLOBVector><oneBLOB size='4'>" + std::string(4000, 'A'), "1000");
}

TEST(IndiXml, ManySmallMembersGrowNoFartherThanOne) {
  std::string blobs = "<setBLOBVector>";
  for (int i = 0; i < 4096; ++i)
    blobs += "<oneBLOB size='300'>" + std::string(400, 'A') + "</oneBLOB>";
  expect_refused(blobs, "1000");
  std::string texts = "<setTextVector>";
  for (int i = 0; i < 4000; ++i) texts += "<oneText>" + std::string(1000, 'x') + "</oneText>";
  expect_refused(texts, "1 MiB");
  std::string names = "<defTextVector>";
  for (int i = 0; i < 4000; ++i) names += "<defText label='" + std::string(1000, 'x') + "'/>";
  expect_refused(names, "1 MiB");
}

TEST(IndiXml, UnwantedPicturesTakeNoMemory) {
  XmlStream stream;
  stream.feed("<setBLOBVector device='C' name='CCD1'><oneBLOB name='CCD1' size='9000000000'>");
  for (int i = 0; i < 100; ++i) stream.feed(std::string(60'000, 'A'));
  const auto elements = stream.feed("</oneBLOB></setBLOBVector>");
  ASSERT_EQ(elements.size(), 1u);
  EXPECT_TRUE(elements[0].members[0].bytes.empty());
}

TEST(IndiDevices, TooManyPropertiesAreRefused) {
  Devices devices;
  expect_error(
      ErrorCode::bad_data,
      [&] {
        for (int i = 0; i < 100'000; ++i) {
          devices.take({"defTextVector", {{"device", "D"}, {"name", std::to_string(i)}}, {}});
        }
      },
      {"more than"});
}

TEST(IndiDevices, DeletingADeviceTakesAllOfItsPropertiesAndNoOthers) {
  Devices devices;
  for (const char* device : {"A", "B"}) {
    for (const char* name : {"X", "Y"}) {
      devices.take({"defTextVector", {{"device", device}, {"name", name}}, {}});
    }
  }
  devices.take({"delProperty", {{"device", "A"}, {"name", "X"}}, {}});
  EXPECT_EQ(devices.find("A", "X"), nullptr);
  EXPECT_NE(devices.find("A", "Y"), nullptr);
  devices.take({"delProperty", {{"device", "A"}}, {}});
  EXPECT_EQ(devices.find("A", "Y"), nullptr);
  EXPECT_NE(devices.find("B", "Y"), nullptr);
}

TEST(IndiFits, EightAndSixteenBitsAreReadToTheLastBit) {
  const std::string deep = make_fits(USHORT_IMG, {3, 2}, {0, 1, 32767, 32768, 65534, 65535});
  const Frame frame = decode_fits(bytes_of(deep), {3, 2, Depth::bits16});
  const std::uint32_t wanted[] = {0, 1, 32767, 32768, 65534, 65535};
  for (int i = 0; i < 6; ++i) EXPECT_EQ(frame.at(i % 3, i / 3), wanted[i]);
  const std::string shallow = make_fits(BYTE_IMG, {3, 1}, {0, 7, 255});
  EXPECT_EQ(decode_fits(bytes_of(shallow), {3, 1, Depth::bits8}).at(2, 0), 255u);
  EXPECT_EQ(decode_fits(bytes_of(shallow), {3, 1, Depth::bits16}).at(2, 0), 255u);
  const std::string plain = make_fits(SHORT_IMG, {2, 1}, {5, 32767});
  EXPECT_EQ(decode_fits(bytes_of(plain), {2, 1, Depth::bits16}).at(1, 0), 32767u);
}

TEST(IndiFits, WhatIsDamagedOrOfAnotherKindIsRefused) {
  const ExpectedPicture expected{64, 48, Depth::bits16};
  const std::string good = ramp_picture();
  expect_error(ErrorCode::bad_data, [&] { decode_fits({}, expected); });
  expect_error(ErrorCode::bad_data,
               [&] { decode_fits(bytes_of(std::string(5760, 'x')), expected); });
  expect_error(ErrorCode::bad_data,
               [&] { decode_fits(bytes_of(good.substr(0, 2880 + 100)), expected); });
  expect_error(ErrorCode::bad_data,
               [&] {
                 decode_fits(bytes_of(good), {64, 47, Depth::bits16});
               },
               {"64 x 48"});
  expect_error(ErrorCode::unsupported, [&] {
    decode_fits(bytes_of(good), {64, 48, Depth::bits8});
  });
  const std::string negative = make_fits(SHORT_IMG, {2, 1}, {-5, 3});
  expect_error(ErrorCode::unsupported,
               [&] {
                 decode_fits(bytes_of(negative), {2, 1, Depth::bits16});
               },
               {"negative"});
  const std::string wide = make_fits(LONG_IMG, {2, 1}, {5, 3});
  expect_error(ErrorCode::unsupported, [&] { decode_fits(bytes_of(wide), {2, 1, Depth::bits16}); });
}

/// A picture whose header is these cards, and 100 blocks of zeros.
std::vector<std::byte> with_header(const std::vector<std::string>& cards) {
  std::string text;
  for (const std::string& card : cards) text += fmt::format("{:<80}", card);
  text.resize((text.size() + 2879) / 2880 * 2880, ' ');
  return bytes_of(text + std::string(100 * 2880, '\0'));
}

std::vector<std::string> cards_of(const std::string& naxis) {
  return {"SIMPLE  = T", "BITPIX  = 16", naxis, "NAXIS1  = 64", "NAXIS2  = 48"};
}

TEST(IndiFits, NothingOfAHeaderIsTrusted) {
  const ExpectedPicture expected{64, 48, Depth::bits16};
  std::vector<std::string> good = cards_of("NAXIS   = 2");
  good.insert(good.end(), {"BZERO   =  +3.2768D4 / unsigned", "OBSERVER= 'J\xC3\xBCrg'", "END"});
  EXPECT_EQ(decode_fits(with_header(good), expected).at(63, 47), 32768u);
  std::vector<std::string> many = cards_of("NAXIS   = 104");
  for (int i = 3; i <= 104; ++i) many.push_back(fmt::format("NAXIS{:<3}= 1", i));
  many.push_back("END");
  const auto refused = [&](const std::vector<std::string>& cards, const char* why) {
    expect_error(ErrorCode::bad_data, [&] { decode_fits(with_header(cards), expected); }, {why});
  };
  refused(many, "104 axes");
  std::vector<std::string> endless(10'000, "COMMENT");
  std::copy(good.begin(), good.begin() + 5, endless.begin());
  refused(endless, "without an end");
  refused({"XTENSION= 'IMAGE'", "END"}, "SIMPLE");
  refused({"SIMPLE  = F", "END"}, "SIMPLE");
  refused({"SIMPLE  = T", "NAXIS   = 2", "BITPIX  = 16", "END"}, "BITPIX");
  refused({"SIMPLE  = T", "BITPIX  = 17", "NAXIS   = 0", "END"}, "BITPIX");
  refused({"SIMPLE  = T", "BITPIX  = 99999999999999999999", "END"}, "BITPIX");
  refused({"SIMPLE  = T", "BITPIX  = 16", "NAXIS   = 2", "NAXIS1  = -64", "NAXIS2  = 48", "END"},
          "negative");
  std::vector<std::string> grouped = cards_of("NAXIS   = 2");
  grouped.insert(grouped.end(), {"GROUPS  = T", "END"});
  refused(grouped, "groups");
}

TEST(IndiFits, WhatFollowsThePictureIsLeftAlone) {
  const std::string picture = ramp_picture() + ramp_picture() + "and more";
  EXPECT_EQ(decode_fits(bytes_of(picture), {64, 48, Depth::bits16}).at(0, 0), 1000u);
}

/// The example, also with every key that it only mentions.
TEST(IndiSettings, TheExampleIsUnderstood) {
  const std::string path = FATHOM_EXAMPLE_RIG;
  const std::string example(read_file(path));
  const std::string full =
      std::regex_replace(example, std::regex("# ([a-z_]+ = [^,\\n]*)\n"), "$1\n");
  EXPECT_NE(full.find("\nhome = true"), std::string::npos);
  for (const std::string& text : {example, full}) {
    const RigRequest request = parse_rig_file(text, path);
    const IndiSettings settings = IndiSettings::read(request.camera.settings);
    request.camera.settings.require_all_used();
    EXPECT_EQ(settings.camera, "CCD Simulator");
    EXPECT_EQ(settings.camera_wishes.width, 256);
  }
}

TEST(IndiDriver, WhereNothingIsFoundItNamesTheServerThatWasAsked) {
  for (const RigDriver* const driver : all_rig_drivers()) {
    if (std::string(driver->name()) != "indi") continue;
    const std::string obstacle = driver->obstacle();
    EXPECT_TRUE(obstacle.empty() || obstacle.find("localhost:7624") != std::string::npos)
        << obstacle;
  }
}

TEST(IndiFits, ALastBlockThatIsNotFilledIsEnough) {
  const std::string picture = ramp_picture();
  const std::size_t pixels_end = 2880 + 64 * 48 * 2;
  const Frame frame = decode_fits(bytes_of(picture.substr(0, pixels_end)), {64, 48, Depth::bits16});
  EXPECT_EQ(frame.at(63, 47), 1000u + 13u * (64 * 48 - 1));
  expect_error(ErrorCode::bad_data,
               [&] {
                 decode_fits(bytes_of(picture.substr(0, pixels_end - 1)), {64, 48, Depth::bits16});
               },
               {"truncated"});
}

TEST(IndiFits, ALyingHeaderAllocatesNothing) {
  std::string huge = ramp_picture();
  const std::size_t side = huge.find("NAXIS1");
  huge.replace(side, 30, "NAXIS1  =           2000000000");
  expect_error(ErrorCode::bad_data, [&] {
    decode_fits(bytes_of(huge), {2'000'000'000, 48, Depth::bits16});
  });
}

}  // namespace
}  // namespace fathom::test
