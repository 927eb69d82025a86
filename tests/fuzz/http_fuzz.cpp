// SPDX-License-Identifier: Apache-2.0
// What the service of a rig elsewhere may send: answers in pieces, JSON and pictures; and what a rig
// text says of where it is.
#include <algorithm>
#include <cmath>
#include <optional>

#include "fuzz.hpp"
#include "hal/drivers/http/answer.hpp"
#include "hal/drivers/http/facts.hpp"
#include "hal/drivers/http/place.hpp"

namespace {

using namespace fathom;

void read_body(std::string_view text) {
  fuzz::accepted([&] {
    const http::Facts facts = http::facts_from(text);
    fuzz::require(facts.lens.lowest < facts.lens.highest, "a lens has a travel");
    fuzz::require(std::isfinite(nearest_position(facts.lens, facts.lens.lowest)),
                  "a lens has positions");
    fuzz::require(facts.camera.settings.width_px > 0, "a camera has pictures");
  });
  fuzz::accepted([&] { http::moved_from(text); });
  fuzz::accepted([&] { http::number_from(text, "position"); });
  http::refusal_from(text);
  fuzz::accepted([&] {
    const Frame frame = http::frame_from(
        text, {.width_px = 4, .height_px = 2, .depth = Depth::bits16, .exposure_ms = 0});
    fuzz::require(frame.width_px() == 4, "a frame has the shape of its camera");
  });
}

void read_answer(std::string_view text) {
  constexpr std::size_t kMostBytes = 4096;
  const std::size_t piece = 1 + static_cast<unsigned char>(text[0]);
  http::AnswerReader reader(kMostBytes);
  fuzz::accepted([&] {
    std::optional<http::Answer> answer;
    for (std::size_t at = 1; at < text.size() && !answer; at += piece)
      answer = reader.add(text.substr(at, piece));
    if (answer) fuzz::require(answer->body.size() <= kMostBytes, "a body is within its limit");
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = fuzz::text_of(data, size);
  fuzz::accepted([&] { http::parse_place(text); });
  read_body(text);
  if (!text.empty()) read_answer(text);
  return 0;
}
