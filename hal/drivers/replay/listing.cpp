// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/replay/listing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <system_error>
#include <utility>

#include "engine/error.hpp"
#include "engine/file.hpp"
#include "hal/drivers/replay/folder.hpp"
#include "hal/drivers/replay/manifest.hpp"
#include "hal/drivers/replay/names.hpp"

namespace fathom::replay {
namespace fs = std::filesystem;
namespace {

constexpr std::uintmax_t kLargestManifest = std::uintmax_t{64} << 20;

void require_file(const fs::path& path, const std::string& where = "") {
  const std::string kind = special_kind(path);
  if (kind.empty()) return;
  throw Error(ErrorCode::bad_data, fmt::format("{}{} is a {} and no picture file; it is not opened",
                                               where, path.string(), kind));
}

class Lister {
 public:
  Lister(const fs::path& root, const Wishes& wishes) : root_(root), wishes_(wishes) {
    listing_.options.scale = wishes.scale;
    if (const auto colour = colour_named(wishes.channel)) listing_.options.colour = *colour;
  }

  Listing list() {
    std::error_code ignored;
    if (!fs::is_directory(root_, ignored)) {
      require_file(root_);
      add_file(root_);
      finish_stacks();
    } else if (fs::exists(root_ / kManifestName, ignored)) {
      list_manifest();
    } else {
      list_folder();
      finish_stacks();
    }
    for (Finding& finding : gathered_) listing_.findings.push_back(std::move(finding));
    return std::move(listing_);
  }

 private:
  void list_manifest() {
    const fs::path path = root_ / kManifestName;
    require_file(path);
    const Manifest manifest = parse_manifest(read_file(path, kLargestManifest), path.string());
    listing_.unit = manifest.unit;
    listing_.coarse_spacing = manifest.coarse_spacing;
    require_no_planes("its manifest says which pages are played");
    for (const ManifestEntry& entry : manifest.entries) add_entry(path, entry);
    for (const ManifestEntry& entry : manifest.perhaps) {
      std::error_code ignored;
      if (fs::exists(root_ / entry.file, ignored)) add_entry(path, entry);
    }
    look_for_unnamed();
  }

  void look_for_unnamed() {
    std::set<fs::path> named;
    for (const ListedPicture& picture : listing_.pictures)
      named.insert(picture.file.lexically_normal());
    std::vector<std::string> pictures = read_folder(root_).pictures;
    std::erase_if(pictures, [&](const std::string& name) {
      return named.contains((root_ / name).lexically_normal());
    });
    if (pictures.empty()) return;
    listing_.findings.push_back(
        UnnamedPictures{pictures.size(), *std::min_element(pictures.begin(), pictures.end())});
  }

  void add_entry(const fs::path& manifest, const ManifestEntry& entry) {
    const fs::path file = root_ / entry.file;
    std::error_code ignored;
    const std::string where = fmt::format("{} line {}: ", manifest.string(), entry.line);
    if (!fs::exists(file, ignored)) {
      throw Error(ErrorCode::bad_data, fmt::format("{}there is no file {}", where, file.string()));
    }
    require_file(file, where);
    listing_.pictures.push_back({.file = file,
                                 .page = entry.page,
                                 .position = entry.position,
                                 .name = name_of(entry.file, entry.page),
                                 .line = entry.line});
  }

  void list_folder() {
    const Folder folder = read_folder(root_);
    SkippedFiles skipped;
    for (const auto& [kind, count] : folder.skipped) skipped.kinds.push_back({kind, count});
    if (folder.pictures.empty()) refuse_empty(skipped);
    const OrderedNames ordered = order_of(folder.pictures);
    const auto name_at = [&](std::size_t place) { return folder.pictures[ordered.order[place]]; };
    if (folder.pictures.size() > 1) {
      listing_.findings.push_back(OrderOfNames{ordered.by_numbers, folder.pictures.size(),
                                               name_at(0), name_at(folder.pictures.size() - 1)});
    }
    if (ordered.gap) listing_.findings.push_back(*ordered.gap);
    if (ordered.twice) listing_.findings.push_back(*ordered.twice);
    if (!skipped.kinds.empty()) listing_.findings.push_back(skipped);
    for (const std::size_t index : ordered.order) add_file(root_ / folder.pictures[index]);
  }

  [[noreturn]] void refuse_empty(const SkippedFiles& skipped) const {
    std::string others;
    for (const SkippedFiles::Kind& kind : skipped.kinds)
      others += fmt::format("{}{} {}", others.empty() ? "; it has " : ", ", kind.count, kind.name);
    throw Error(ErrorCode::bad_data, fmt::format("{} has no pictures in it (.png, .jpg, .tif, "
                                                 ".pgm){}",
                                                 root_.string(), others));
  }

  void add_file(const fs::path& path) {
    const PictureFile file(path, listing_.options);
    const PictureContents& contents = file.contents();
    notice(path, contents);
    if (!contents.stacks.empty()) {
      stacks_.push_back(spread_over(path, contents));
      damaged_[path] = contents.damaged;
      return;
    }
    notice_damage(path, contents);
    const std::string name = path.filename().string();
    for (std::size_t page = 0; page < contents.pages; ++page) {
      const auto position = static_cast<double>(next_++);
      const bool leave_out = contents.damaged.contains(page) && contents.pages > 1;
      if (leave_out) continue;
      listing_.pictures.push_back(
          {.file = path,
           .page = page,
           .position = position,
           .name = contents.pages > 1 ? fmt::format("{} page {}", name, page) : name});
    }
    if (contents.damaged.size() == contents.pages && contents.pages > 1)
      PictureFile(path).shape(contents.damaged.begin()->first);  // throws, and says why
  }

  /// Everything of one file that a user should know.
  void notice(const fs::path& path, const PictureContents& contents) {
    const std::string name = path.filename().string();
    if (contents.previews > 0) {
      SkippedPreviews& skipped = gathered<SkippedPreviews>(name);
      skipped.count += contents.previews;
    }
    if (contents.samples_as_pages > 0) {
      SamplesAsPictures& samples = gathered<SamplesAsPictures>(name);
      samples.samples = contents.samples_as_pages;
    }
    if (contents.is_description_damaged) gathered<DamagedDescription>(name);
    if (!contents.words.empty() && !has_word_) {
      has_word_ = true;
      for (const std::string& word : contents.words)
        listing_.findings.push_back(LibraryWord{name, word});
    }
  }

  /// Of a file that says nothing of its pages; of a stack, what is missing is said of its planes.
  void notice_damage(const fs::path& path, const PictureContents& contents) {
    const auto& damaged = contents.damaged;
    const std::size_t count = damaged.size() + contents.lost;
    if (count == 0 || damaged.size() == contents.pages) return;
    const bool is_damaged = !damaged.empty();
    listing_.findings.push_back(
        DamagedPages{.file = path.filename().string(),
                     .first = is_damaged ? damaged.begin()->first : contents.pages,
                     .count = count,
                     .whole = contents.pages - damaged.size(),
                     .why = is_damaged ? damaged.begin()->second : "the file ends before it"});
  }

  /// The one finding of this kind, which names the folder where several files give it.
  template <class Kind>
  Kind& gathered(const std::string& name) {
    for (Finding& finding : gathered_) {
      if (auto* const found = std::get_if<Kind>(&finding)) {
        found->file = root_.string();
        return *found;
      }
    }
    gathered_.push_back(Kind{.file = name});
    return std::get<Kind>(gathered_.back());
  }

  void finish_stacks() {
    if (stacks_.empty()) return require_no_planes("it has no channels, times and images");
    if (belong_together(stacks_)) stacks_ = {joined(std::move(stacks_))};
    // Distances are known along one stack; several, one behind the other, are frames.
    const bool is_one = stacks_.size() == 1 && listing_.pictures.empty();
    bool is_first = true;
    for (const SpreadStack& stack : stacks_) {
      ChosenStack chosen = choose(stack, wishes_, root_);
      leave_out_damaged(chosen);
      if (!is_one) chosen.choice.spacing_um.reset();
      if (chosen.choice.spacing_um) listing_.unit = "um";
      add_planes(chosen);
      const ChosenPlanes& choice = chosen.choice;
      const bool is_worth_saying = choice.channels > 1 || choice.times > 1 || choice.images > 1 ||
                                   choice.missing > 0 || choice.spacing_um;
      if ((is_first && is_worth_saying) || choice.missing > 0) listing_.findings.push_back(choice);
      is_first = false;
    }
    if (listing_.pictures.empty())
      PictureFile(stacks_[0].file).shape(damaged_[stacks_[0].file].begin()->first);
  }

  /// A plane that is not whole is missing, too.
  void leave_out_damaged(ChosenStack& chosen) {
    ChosenPlanes& choice = chosen.choice;
    std::erase_if(chosen.planes, [&](const ChosenStack::Plane& plane) {
      const auto& damaged = damaged_[plane.place.file];
      const auto found = damaged.find(plane.place.page);
      if (found == damaged.end()) return false;
      if (choice.why.empty()) choice.why = fmt::format("page {}: {}", found->first, found->second);
      return true;
    });
    choice.missing += choice.planes - chosen.planes.size();
    choice.planes = chosen.planes.size();
  }

  void add_planes(const ChosenStack& chosen) {
    const std::size_t first = next_;
    next_ += chosen.choice.planes + chosen.choice.missing;
    for (const ChosenStack::Plane& plane : chosen.planes) {
      const auto& [file, page] = plane.place;
      const double spacing = chosen.choice.spacing_um.value_or(1);
      // Products of decimal numbers, without the last digits that binary ones add.
      constexpr double kDigits = 1e9;
      const double position = static_cast<double>(first + plane.number) * spacing;
      listing_.pictures.push_back(
          {.file = file,
           .page = page,
           .position = std::round(position * kDigits) / kDigits,
           .name = fmt::format("{} page {} ({} {})", file.filename().string(), page,
                               chosen.plays_times ? "time" : "z", plane.number)});
    }
  }

  void require_no_planes(const char* why) const {
    const bool is_colour = colour_named(wishes_.channel).has_value();
    const char* const key = !wishes_.channel.empty() && !is_colour ? "channel"
                            : wishes_.time                         ? "time"
                            : wishes_.image                        ? "image"
                                                                   : nullptr;
    if (key == nullptr) return;
    throw Error(ErrorCode::bad_argument,
                fmt::format("replay of {}: {}, so leave {} out{}", root_.string(), why, key,
                            key == std::string_view("channel")
                                ? "; channel=r, g or b takes one colour of colour pictures"
                                : ""));
  }

  static std::string name_of(const std::string& file, std::size_t page) {
    return page == 0 ? file : fmt::format("{} page {}", file, page);
  }

  const fs::path& root_;
  const Wishes& wishes_;
  Listing listing_;
  std::vector<Finding> gathered_;
  std::vector<SpreadStack> stacks_;
  std::map<fs::path, std::map<std::size_t, std::string>> damaged_;  // of the files of stacks
  std::size_t next_ = 0;                                            // position of the next frame
  bool has_word_ = false;
};

}  // namespace

Listing list_recording(const fs::path& path, const Wishes& wishes) {
  return Lister(path, wishes).list();
}

}  // namespace fathom::replay
