// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/replay/planes.hpp"

#include <fmt/format.h>

#include <charconv>
#include <tuple>
#include <utility>

#include "engine/error.hpp"

namespace fathom::replay {
namespace {

std::optional<std::size_t> number_in(const std::string& text) {
  std::size_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [next, problem] = std::from_chars(text.data(), end, value);
  if (problem != std::errc() || next != end) return std::nullopt;
  return value;
}

/// "0 (DAPI), 1 (GFP)" or "0 to 6".
std::string channel_list(const PictureStack& stack) {
  if (stack.channel_names.empty()) return fmt::format("0 to {}", stack.channels - 1);
  std::string list;
  for (std::size_t i = 0; i < stack.channels; ++i) {
    const std::string& name = stack.channel_names[i];
    list +=
        fmt::format("{}{}{}", i > 0 ? ", " : "", i, name.empty() ? "" : fmt::format(" ({})", name));
  }
  return list;
}

std::optional<std::size_t> channel_named(const PictureStack& stack, const std::string& text) {
  const auto number = number_in(text);
  if (number && *number < stack.channels) return number;
  for (std::size_t i = 0; i < stack.channel_names.size(); ++i) {
    if (stack.channel_names[i] == text) return i;
  }
  return std::nullopt;
}

/// Asks for what must be chosen, all at once, or refuses a choice that there is not.
class Chooser {
 public:
  Chooser(const SpreadStack& stack, const Wishes& wishes, const std::filesystem::path& played)
      : stack_(stack), wishes_(wishes), played_(played) {}

  ChosenStack choose() {
    const std::size_t image = number("image", wishes_.image, stack_.images.size(), true);
    if (!questions_.empty()) ask();
    const PictureStack& shape = stack_.images[image];
    // A stack of one slice and many times is a travel that was recorded as a film.
    const bool plays_times = shape.slices == 1 && !wishes_.time;
    const std::size_t channel = this->channel(shape);
    const std::size_t time = number("time", wishes_.time, shape.times, !plays_times);
    if (!questions_.empty()) ask();
    ChosenStack result;
    result.plays_times = plays_times && shape.times > 1;
    result.choice = {.file = stack_.file.filename().string(),
                     .image = image,
                     .images = stack_.images.size(),
                     .channel = channel,
                     .channels = shape.channels,
                     .time = time,
                     .times = plays_times ? 1 : shape.times};
    if (!shape.channel_names.empty()) result.choice.channel_name = shape.channel_names[channel];
    if (!plays_times) result.choice.spacing_um = shape.spacing_um;
    const std::size_t count = plays_times ? shape.times : shape.slices;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t slice = plays_times ? 0 : i;
      const std::size_t at = ((plays_times ? i : time) * shape.channels + channel) * shape.slices;
      const Place& place = stack_.places[image][at + slice];
      if (place.page != PictureStack::kMissing) result.planes.push_back({place, i});
    }
    result.choice.planes = result.planes.size();
    result.choice.missing = count - result.planes.size();
    if (result.planes.empty()) refuse_empty();
    return result;
  }

 private:
  std::size_t channel(const PictureStack& shape) {
    const bool is_colour = colour_named(wishes_.channel).has_value();
    if (wishes_.channel.empty() || (is_colour && shape.channels == 1)) {
      if (shape.channels > 1) {
        questions_ += fmt::format("{} channels; choose one with channel=, {}. ", shape.channels,
                                  channel_list(shape));
        example_ += ",channel=0";
      }
      return 0;
    }
    if (const auto found = channel_named(shape, wishes_.channel)) return *found;
    refuse(
        fmt::format("there is no channel \"{}\"; it has {}", wishes_.channel, channel_list(shape)));
  }

  std::size_t number(const char* what, std::optional<std::size_t> wish, std::size_t count,
                     bool must_choose) {
    if (wish && *wish >= count)
      refuse(fmt::format("there is no {} {}; it has 0 to {}", what, *wish, count - 1));
    if (!wish && count > 1 && must_choose) {
      questions_ +=
          fmt::format("{0} {1}s; choose one with {1}=, 0 to {2}. ", count, what, count - 1);
      example_ += fmt::format(",{}=0", what);
    }
    return wish.value_or(0);
  }

  [[noreturn]] void ask() {
    questions_.resize(questions_.size() - 2);
    throw Error(ErrorCode::bad_argument,
                fmt::format("{} holds {}; for example replay:{}{}", stack_.file.string(),
                            questions_, played_.string(), example_));
  }

  [[noreturn]] void refuse(const std::string& what) const {
    throw Error(ErrorCode::bad_argument, fmt::format("{}: {}", stack_.file.string(), what));
  }

  [[noreturn]] void refuse_empty() const {
    throw Error(ErrorCode::bad_data,
                fmt::format("{} describes a stack whose planes are in other files; play the folder "
                            "that holds them all",
                            stack_.file.string()));
  }

  const SpreadStack& stack_;
  const Wishes& wishes_;
  const std::filesystem::path& played_;
  std::string questions_, example_;
};

auto sizes_of(const PictureStack& stack) {
  return std::tuple(stack.channels, stack.slices, stack.times);
}

}  // namespace

std::optional<Colour> colour_named(const std::string& word) {
  if (word == "r" || word == "red") return Colour::red;
  if (word == "g" || word == "green") return Colour::green;
  if (word == "b" || word == "blue") return Colour::blue;
  return std::nullopt;
}

SpreadStack spread_over(const std::filesystem::path& file, const PictureContents& contents) {
  SpreadStack result{.file = file, .images = contents.stacks, .places = {}};
  for (const PictureStack& image : contents.stacks) {
    std::vector<Place>& places = result.places.emplace_back();
    for (const std::size_t page : image.pages) places.push_back({file, page});
  }
  return result;
}

bool belong_together(const std::vector<SpreadStack>& stacks) {
  if (stacks.size() < 2 || stacks.front().images.size() != 1) return false;
  std::vector<bool> is_taken(stacks.front().places.front().size());
  for (const SpreadStack& stack : stacks) {
    const bool is_alike =
        stack.images.size() == 1 && sizes_of(stack.images[0]) == sizes_of(stacks.front().images[0]);
    if (!is_alike) return false;
    for (std::size_t i = 0; i < is_taken.size(); ++i) {
      if (stack.places[0][i].page == PictureStack::kMissing) continue;
      if (is_taken[i]) return false;
      is_taken[i] = true;
    }
  }
  return true;
}

SpreadStack joined(std::vector<SpreadStack> stacks) {
  SpreadStack whole = std::move(stacks.front());
  for (std::size_t s = 1; s < stacks.size(); ++s) {
    for (std::size_t i = 0; i < whole.places[0].size(); ++i) {
      Place& place = stacks[s].places[0][i];
      if (place.page != PictureStack::kMissing) whole.places[0][i] = std::move(place);
    }
  }
  return whole;
}

ChosenStack choose(const SpreadStack& stack, const Wishes& wishes,
                   const std::filesystem::path& played) {
  return Chooser(stack, wishes, played).choose();
}

}  // namespace fathom::replay
