// SPDX-License-Identifier: Apache-2.0
// What the driver "http" is made of: addresses, answers, clocks, what a service says of its rig.
#include <gtest/gtest.h>

#include "hal/drivers/http/answer.hpp"
#include "hal/drivers/http/clock_map.hpp"
#include "hal/drivers/http/facts.hpp"
#include "hal/drivers/http/place.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom::http {
namespace {

using test::expect_error;

TEST(HttpPlace, IsWhatAServicePrints) {
  const Place printed = parse_place("http://pi:8471/?token=ab-CD_12");
  EXPECT_EQ(printed.address.text(), "pi:8471");
  EXPECT_EQ(printed.token, "ab-CD_12");
  EXPECT_EQ(parse_place("//pi").address.text(), "pi:8470");
  EXPECT_EQ(parse_place("http://[::1]:9/").address.host, "::1");
}

TEST(HttpPlace, RefusesOthersAndKeepsTheTokenToItself) {
  for (const char* text :
       {"", "pi", "http://", "http://pi:0", "http://pi:70000", "http://pi/rig", "http://a@pi",
        "https://pi", "http://pi?secret", "http://pi?tok=secret", "http://pi?token=sec ret"}) {
    try {
      parse_place(text);
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::bad_argument);
      EXPECT_EQ(std::string(error.what()).find("sec"), std::string::npos) << error.what();
    }
  }
}

TEST(HttpAnswer, IsReadFromPiecesOfAnySize) {
  const std::string text =
      "HTTP/1.1 200 OK\r\nX-Fathom-Now-Ns:  17 \r\nContent-Length: 5\r\n\r\nhello";
  for (std::size_t size = 1; size <= text.size(); ++size) {
    AnswerReader reader(100);
    std::optional<Answer> answer;
    for (std::size_t at = 0; at < text.size(); at += size) {
      ASSERT_FALSE(answer);
      answer = reader.add(std::string_view(text).substr(at, size));
    }
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->status, 200);
    EXPECT_EQ(answer->header("x-fathom-now-ns"), "17");
    EXPECT_EQ(answer->body, "hello");
    EXPECT_TRUE(answer->goes_on);
  }
}

TEST(HttpAnswer, RefusesWhatIsNone) {
  for (const std::string text :
       {"SSH-2.0-OpenSSH\r\n\r\n", "HTTP/1.1 abc\r\n\r\n", "HTTP/1.1 100 x\r\n\r\n",
        "HTTP/1.1 200 OK\r\n\r\n", "HTTP/1.1 200 OK\r\nContent-Length: -1\r\n\r\n",
        "HTTP/1.1 200 OK\r\nContent-Length: 101\r\n\r\n",
        "HTTP/1.1 200 OK\r\nContent-Length: 1\r\nContent-Length: 2\r\n\r\n",
        "HTTP/1.1 200 OK\r\nContent-Length: 1\r\n\r\nab",
        "HTTP/1.1 200 OK\r\nno colon\r\nContent-Length: 1\r\n\r\na"}) {
    expect_error(ErrorCode::bad_data, [&] { AnswerReader(100).add(text); });
  }
  expect_error(ErrorCode::bad_data, [&] {
    AnswerReader reader(100);
    for (int i = 0; i < 20; ++i) reader.add(std::string(1000, 'a'));
  });
}

constexpr std::int64_t kMs = 1'000'000;

TEST(HttpClocks, TheTruthLiesBetweenEarliestAndLatest) {
  // The other clock is 1 h ahead and 100 ppm fast; trips take between 2 and 30 ms each way.
  const auto there_at = [](std::int64_t here_ns) {
    return here_ns + 3'600'000 * kMs + here_ns / 10'000;
  };
  ClockMap map;
  std::int64_t now = 0;
  std::int64_t last_earliest = 0;
  for (int i = 1; i < 2000; ++i) {
    now += 100 * kMs;
    const std::int64_t there = 2 * kMs + i * 7919 % 29 * kMs,
                       back = 2 * kMs + i * 104729 % 29 * kMs;
    map.add(
        {.asked_ns = now, .there_ns = there_at(now + there), .answered_ns = now + there + back});
    const std::int64_t moment = now + there;
    EXPECT_LE(map.earliest(there_at(moment)), moment);
    EXPECT_GE(map.latest(there_at(moment)), moment);
    EXPECT_GE(map.earliest(there_at(moment)), moment - 60 * kMs);
    EXPECT_GT(map.earliest(there_at(moment)), last_earliest) << "frames stay in their order";
    last_earliest = map.earliest(there_at(moment));
  }
}

TEST(HttpClocks, OneOffsetKeepsTheOrderOfFramesAndArrivals) {
  ClockMap map;
  map.add({.asked_ns = 0, .there_ns = 500 * kMs, .answered_ns = 8 * kMs});
  map.freeze();
  const std::int64_t settled = map.latest(900 * kMs);
  map.add({.asked_ns = 90 * kMs, .there_ns = 591 * kMs, .answered_ns = 92 * kMs});
  EXPECT_EQ(map.earliest(900 * kMs), settled);
  EXPECT_EQ(map.earliest(900 * kMs - 1), settled - 1) << "a nanosecond early is early still";
}

TEST(HttpClocks, AJumpIsSeen) {
  ClockMap map;
  map.add({.asked_ns = 0, .there_ns = 500 * kMs, .answered_ns = 8 * kMs});
  expect_error(ErrorCode::device_lost, [&] {
    map.add({.asked_ns = 90 * kMs, .there_ns = 400 * kMs, .answered_ns = 92 * kMs});
  });
}

const std::string kRig =
    R"({"camera":{"description":"c","width":4,"height":2,"bits":16,"exposure_ms":20,"live":true,)"
    R"("streams":true,"recorded_here":1,"patience_ms":5000},"lens":{"description":"l","unit":"steps",)"
    R"("min":0,"max":100,"step":1,"coarse":8,"stops":[],"stop_names":[],"optics":null,)"
    R"("blur_px_per_unit":null},"stage":false})";

TEST(HttpFacts, AreARig) {
  const Facts facts = facts_from(kRig);
  EXPECT_EQ(facts.camera.settings.depth, Depth::bits16);
  EXPECT_EQ(facts.lens.highest, 100);
  EXPECT_FALSE(facts.lens.optics);
}

TEST(HttpFacts, OfNoRigAreRefused) {
  const std::pair<const char*, const char*> changes[] = {
      {"\"width\":4", "\"width\":0"},
      {"\"width\":4", "\"width\":4.5"},
      {"\"width\":4", "\"width\":1e300"},
      {"\"width\":4", "\"width\":1000000000"},
      {"\"height\":2", "\"height\":\"2\""},
      {"\"max\":100", "\"max\":0"},
      {"\"max\":100", "\"max\":null"},
      {"\"step\":1", "\"step\":0"},
      {"\"stops\":[]", "\"stops\":[0,0,100]"},
      {"\"stops\":[]", "\"stops\":[1,2]"},
      {"\"stop_names\":[]", "\"stop_names\":[\"a\"]"},
      {"\"coarse\":8", "\"coarse\":-1"},
      {"\"exposure_ms\":20", "\"exposure_ms\":1e300"},
      {"\"optics\":null", "\"optics\":{\"focal_mm\":0,\"f_number\":2,\"circle_mm\":1}"},
      {"\"stage\":false", "\"state\":false"},
      {"{\"camera\"", "[\"camera\""}};
  for (const auto& [from, to] : changes) {
    std::string rig = kRig;
    rig.replace(rig.find(from), std::string_view(from).size(), to);
    expect_error(ErrorCode::bad_data, [&] { facts_from(rig); });
  }
}

TEST(HttpFacts, AFrameHasTheShapeOfItsCameraAndEveryBit) {
  const CameraSettings shape{.width_px = 2, .height_px = 1, .depth = Depth::bits16};
  const Frame frame = frame_from(std::string("P5\n2 1\n65535\n\xff\xfe\x00\x01", 17), shape);
  EXPECT_EQ(frame.at(0, 0), 0xfffe);
  EXPECT_EQ(frame.at(1, 0), 1);
  for (const std::string_view pgm : {"P5\n2 1\n65535\nabc", "P5\n2 1\n255\nab",
                                     "P5\n1 2\n65535\nabcd", "P5\n2 1\n65535\nabcde", ""})
    expect_error(ErrorCode::bad_data, [&] { frame_from(pgm, shape); });
}

TEST(HttpFacts, AMoveThatFailedSaysWhy) {
  const Moved moved = moved_from(
      R"({"id":3,"done":true,"arrival":null,"error":{"code":"device_lost","message":"jammed"}})");
  ASSERT_TRUE(moved.failure);
  EXPECT_EQ(moved.failure->code(), ErrorCode::device_lost);
  EXPECT_STREQ(moved.failure->what(), "jammed");
  expect_error(ErrorCode::bad_data,
               [] { moved_from(R"({"id":3,"done":true,"arrival":null,"error":null})"); });
}

}  // namespace
}  // namespace fathom::http
