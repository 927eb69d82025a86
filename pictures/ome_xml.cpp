// SPDX-License-Identifier: Apache-2.0
// OME-XML by expat: of the whole schema only where the planes of an image lie, and how far apart.
#include <expat.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <memory>
#include <string>

#include "pictures/stack_text.hpp"

namespace fathom::pictures {
namespace {

/// Of all images together; a small document must not take much memory.
constexpr std::size_t kMostPlanes = std::size_t{1} << 20;

/// The attributes of one element.
class Attributes {
 public:
  explicit Attributes(const XML_Char** pairs) : pairs_(pairs) {}

  std::optional<std::string_view> text(std::string_view name) const {
    for (const XML_Char** pair = pairs_; *pair != nullptr; pair += 2) {
      if (name == pair[0]) return pair[1];
    }
    return std::nullopt;
  }

  std::optional<double> number(std::string_view name) const { return parsed<double>(name); }
  std::optional<std::size_t> count(std::string_view name) const {
    return parsed<std::size_t>(name);
  }

 private:
  template <class Number>
  std::optional<Number> parsed(std::string_view name) const {
    const auto found = text(name);
    if (!found) return std::nullopt;
    Number value{};
    const char* const end = found->data() + found->size();
    const auto [next, problem] = std::from_chars(found->data(), end, value);
    if (problem != std::errc() || next != end) return std::nullopt;
    return value;
  }

  const XML_Char** pairs_;
};

/// TiffData: a run of planes, in the image's order of dimensions.
struct PlaneRun {
  std::optional<std::size_t> directory, count;
  std::size_t channel = 0, slice = 0, time = 0;
  std::string file = {};  // empty: the one that holds the document
};

struct OmeImage {
  std::string order = "XYZCT";
  std::size_t slices = 1, samples = 1, times = 1;
  std::vector<std::size_t> samples_of_channel;
  std::vector<std::string> names;
  std::optional<double> spacing_um;
  std::vector<PlaneRun> runs;
};

/// What expat calls. No exception may pass through it: memory that runs out stops the parser.
class OmeReader {
 public:
  /// The images, or nothing for a document that is damaged.
  std::optional<std::vector<OmeImage>> read(std::string_view text) {
    parser_.reset(XML_ParserCreate(nullptr));
    if (parser_ == nullptr) throw std::bad_alloc();
    XML_SetUserData(parser_.get(), this);
    XML_SetStartElementHandler(parser_.get(), on_start);
    // OME has no document type; one would only be there to declare entities that grow.
    XML_SetStartDoctypeDeclHandler(parser_.get(), on_doctype);
    const bool is_whole = XML_Parse(parser_.get(), text.data(), static_cast<int>(text.size()),
                                    XML_TRUE) == XML_STATUS_OK;
    if (out_of_memory_) throw std::bad_alloc();
    if (!is_whole) return std::nullopt;
    return std::move(images_);
  }

 private:
  struct Free {
    void operator()(XML_Parser parser) const { XML_ParserFree(parser); }
  };

  static OmeReader& self(void* data) { return *static_cast<OmeReader*>(data); }

  template <class Body>
  void guarded(Body body) {
    try {
      body();
    } catch (const std::exception&) {
      out_of_memory_ = true;
      XML_StopParser(parser_.get(), XML_FALSE);
    }
  }

  static void on_start(void* data, const XML_Char* name, const XML_Char** attributes) {
    self(data).guarded([&] { self(data).start(local(name), Attributes(attributes)); });
  }
  static void on_doctype(void* data, const XML_Char*, const XML_Char*, const XML_Char*, int) {
    XML_StopParser(self(data).parser_.get(), XML_FALSE);
  }

  /// "OME:Pixels" and "Pixels" are one element.
  static std::string_view local(const XML_Char* name) {
    const char* const colon = std::strrchr(name, ':');
    return colon == nullptr ? name : colon + 1;
  }

  void start(std::string_view name, const Attributes& attributes) {
    if (name == "Pixels") return pixels(attributes);
    if (images_.empty()) return;
    if (name == "Channel") return channel(attributes);
    if (name == "TiffData") return tiff_data(attributes);
    if (name == "UUID" && !images_.back().runs.empty())
      images_.back().runs.back().file = attributes.text("FileName").value_or("");
  }

  void pixels(const Attributes& attributes) {
    OmeImage& image = images_.emplace_back();
    image.order = attributes.text("DimensionOrder").value_or("XYZCT");
    image.slices = attributes.count("SizeZ").value_or(1);
    image.samples = attributes.count("SizeC").value_or(1);
    image.times = attributes.count("SizeT").value_or(1);
    const std::string_view unit = attributes.text("PhysicalSizeZUnit").value_or("um");
    image.spacing_um = micrometres(attributes.number("PhysicalSizeZ").value_or(0), unit);
  }

  void channel(const Attributes& attributes) {
    OmeImage& image = images_.back();
    image.samples_of_channel.push_back(attributes.count("SamplesPerPixel").value_or(1));
    image.names.emplace_back(attributes.text("Name").value_or(""));
  }

  void tiff_data(const Attributes& attributes) {
    PlaneRun run;
    run.directory = attributes.count("IFD");
    run.count = attributes.count("PlaneCount");
    run.channel = attributes.count("FirstC").value_or(0);
    run.slice = attributes.count("FirstZ").value_or(0);
    run.time = attributes.count("FirstT").value_or(0);
    images_.back().runs.push_back(std::move(run));
  }

  std::unique_ptr<std::remove_pointer_t<XML_Parser>, Free> parser_;
  std::vector<OmeImage> images_;
  bool out_of_memory_ = false;
};

/// Colours of one pixel are samples of one plane.
std::size_t channels_of(const OmeImage& image) {
  std::size_t samples = 0;
  for (const std::size_t one : image.samples_of_channel) samples += one;
  const bool is_told = !image.samples_of_channel.empty() && samples == image.samples;
  return is_told ? image.samples_of_channel.size() : image.samples;
}

/// The planes of an image, one after the other in its order of dimensions.
class PlaneCounter {
 public:
  PlaneCounter(const OmeImage& image, const PictureStack& stack) : stack_(stack) {
    const std::string_view axes =
        std::string_view(image.order).substr(std::min<std::size_t>(2, image.order.size()));
    std::size_t step = 1;
    for (const char axis : axes) {
      if (axis == 'C') channel_step_ = step, step *= stack.channels;
      if (axis == 'Z') slice_step_ = step, step *= stack.slices;
      if (axis == 'T') time_step_ = step, step *= stack.times;
    }
  }

  std::size_t number_of(const PlaneRun& run) const {
    return run.channel * channel_step_ + run.slice * slice_step_ + run.time * time_step_;
  }

  std::size_t& page(PictureStack& stack, std::size_t number) const {
    const std::size_t channel = number / channel_step_ % stack_.channels;
    const std::size_t slice = number / slice_step_ % stack_.slices;
    const std::size_t time = number / time_step_ % stack_.times;
    return stack.pages[(time * stack_.channels + channel) * stack_.slices + slice];
  }

 private:
  const PictureStack& stack_;
  std::size_t channel_step_ = 1, slice_step_ = 1, time_step_ = 1;
};

bool is_sound(const PictureStack& stack) {
  std::size_t product = 1;
  for (const std::size_t size : {stack.channels, stack.slices, stack.times}) {
    if (size == 0 || size > kMostPlanes || (product *= size) > kMostPlanes) return false;
  }
  return true;
}

/// Puts the planes of a run, whose directories follow each other, in their places.
void place(const PlaneRun& run, const OmeImage& image, std::span<const std::size_t> pages,
           PictureStack& stack) {
  const PlaneCounter counter(image, stack);
  if (run.channel >= stack.channels || run.slice >= stack.slices || run.time >= stack.times) return;
  const std::size_t first = counter.number_of(run);
  if (first >= stack.pages.size()) return;  // an order of dimensions that is none
  const std::size_t directory = run.directory.value_or(0);
  const std::size_t told = run.count.value_or(run.directory ? 1 : stack.pages.size());
  const std::size_t count = std::min(told, stack.pages.size() - first);
  for (std::size_t i = 0; i < count && i + directory < pages.size(); ++i)
    counter.page(stack, first + i) = pages[directory + i];
}

/// first_directory: where an image without TiffData begins; the next such begins behind it.
PictureStack stack_of(const OmeImage& image, std::string_view own_name,
                      std::span<const std::size_t> pages, std::size_t& first_directory) {
  PictureStack stack{.channels = channels_of(image),
                     .slices = image.slices,
                     .times = image.times,
                     .channel_names = image.names,
                     .spacing_um = image.spacing_um};
  if (!is_sound(stack)) return {};
  if (stack.channel_names.size() != stack.channels) stack.channel_names.clear();
  stack.pages.assign(stack.channels * stack.slices * stack.times, PictureStack::kMissing);
  std::vector<PlaneRun> runs = image.runs;
  if (runs.empty()) {
    runs.push_back({.directory = first_directory, .count = stack.pages.size()});
    first_directory += stack.pages.size();
  }
  for (const PlaneRun& run : runs) {
    if (run.file.empty() || run.file == own_name) place(run, image, pages, stack);
  }
  return stack;
}

}  // namespace

bool is_ome(std::string_view description) {
  return description.find("<OME") != std::string_view::npos ||
         description.find("<ome:OME") != std::string_view::npos ||
         description.find("<OME:OME") != std::string_view::npos;
}

std::optional<std::vector<PictureStack>> parse_ome(std::string_view description,
                                                   std::string_view own_name,
                                                   std::span<const std::size_t> page_of_directory) {
  constexpr std::size_t kLongest = std::size_t{1} << 30;  // expat counts in int
  if (description.size() > kLongest) return std::nullopt;
  const auto images = OmeReader().read(description);
  if (!images) return std::nullopt;
  std::vector<PictureStack> stacks;
  std::size_t first_directory = 0;
  std::size_t planes = 0;
  for (const OmeImage& image : *images) {
    PictureStack stack = stack_of(image, own_name, page_of_directory, first_directory);
    planes += stack.pages.size();
    if (stack.pages.empty() || planes > kMostPlanes) return std::nullopt;
    stacks.push_back(std::move(stack));
  }
  return stacks;
}

}  // namespace fathom::pictures
