// SPDX-License-Identifier: Apache-2.0
// What a client of fathom serve says: heads, queries and bodies.
#include "fuzz.hpp"
#include "serve/admission.hpp"
#include "serve/bodies.hpp"

namespace {

using namespace fathom;
using namespace fathom::serve;

void read_bodies(std::string_view text) {
  fuzz::accepted([&] {
    for (const Window& window : windows_from(text))
      fuzz::require(std::abs(window.x) <= 1'000'000'000, "a window's place is a number");
  });
  fuzz::accepted([&] {
    const LensWish wish = lens_wish_from(text);
    fuzz::require(wish.position.has_value() != wish.by.has_value(), "a lens has one wish");
  });
  fuzz::accepted([&] { method_wish_from(text); });
  fuzz::accepted(
      [&] { fuzz::require(*next_step_from(text).distance_mm > 0, "a distance is above 0"); });
  fuzz::accepted([&] { action_from(text); });
  fuzz::accepted([&] { nothing_from(text); });
  for (const Activity kind : {Activity::focus, Activity::sweep, Activity::range,
                              Activity::calibrate, Activity::depth, Activity::capture})
    fuzz::accepted([&] { order_from(kind, text); });
  fuzz::accepted([&] {
    const double value = number_from("fps", text, 1, 0, 100);
    fuzz::require(value >= 0 && value <= 100, "a number of a query is within its limits");
  });
}

void read_head(const std::string& text) {
  const House house{.token = "0123456789abcdef", .cookie_name = "fathom_token_1"};
  for (const char* method : {"GET", "POST"}) {
    Visitor visitor;
    visitor.method = method;
    visitor.path = "/";
    visitor.hosts = {text};
    visitor.origins = {text};
    visitor.cookie = visitor.authorization = visitor.content_type = visitor.query_token = text;
    visitor.lengths = {text};
    const Refusal refusal = admit(visitor, house);
    fuzz::require(refusal != Refusal::none, "no text is a host and a token at once");
    is_client_name(text);
  }
  if (is_our_host(text, {}))
    fuzz::require(text.find_first_of("/\\ @") == std::string::npos, "a host is a host alone");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = fuzz::text_of(data, size);
  read_bodies(text);
  read_head(std::string(text));
  return 0;
}
