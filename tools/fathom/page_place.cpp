// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/page_place.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "engine/printable.hpp"

namespace fathom::cli {
namespace {

std::optional<std::size_t> one_of(std::size_t number, std::size_t count) {
  return count > 1 ? std::optional(number) : std::nullopt;
}

/// place: in PictureStack::pages.
PagePlace place_in(const PictureStack& stack, std::size_t place) {
  const std::size_t channel = place / stack.slices % stack.channels;
  return {.image = std::nullopt,
          .channel = one_of(channel, stack.channels),
          .slice = one_of(place % stack.slices, stack.slices),
          .time = one_of(place / stack.slices / stack.channels, stack.times),
          .channel_name = stack.channel_names.empty() ? "" : stack.channel_names[channel]};
}

}  // namespace

PagePlace place_of(const PictureContents& contents, std::size_t page) {
  for (std::size_t image = 0; image < contents.stacks.size(); ++image) {
    const PictureStack& stack = contents.stacks[image];
    const auto found = std::find(stack.pages.begin(), stack.pages.end(), page);
    if (found == stack.pages.end()) continue;
    PagePlace place = place_in(stack, static_cast<std::size_t>(found - stack.pages.begin()));
    place.image = one_of(image, contents.stacks.size());
    return place;
  }
  return {};
}

std::string text_of(const PagePlace& place) {
  std::string text;
  const auto add = [&](const char* what, const std::optional<std::size_t>& number,
                       const std::string& name) {
    if (!number) return;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", what, *number);
    if (!name.empty()) text += " " + printable(name);
  };
  add("image", place.image, "");
  add("channel", place.channel, place.channel_name);
  add("z", place.slice, "");
  add("time", place.time, "");
  return text.empty() ? text : " (" + text + ")";
}

}  // namespace fathom::cli
