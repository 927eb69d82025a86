// SPDX-License-Identifier: Apache-2.0
#include "python/depth.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <utility>

#include "backends/backends.hpp"
#include "depth/interruption.hpp"
#include "mapping/colour_map.hpp"
#include "mapping/depth_maker.hpp"
#include "mapping/growth_law.hpp"
#include "mapping/writing.hpp"
#include "pictures/raster.hpp"
#include "python/arrays.hpp"
#include "python/colours.hpp"
#include "python/depth_values.hpp"
#include "python/errors.hpp"
#include "python/given.hpp"
#include "python/scoring.hpp"
#include "python/stop.hpp"
#include "python/warning_values.hpp"

namespace fathom::python {
namespace {

using Clock = std::chrono::steady_clock;
using mapping::ColourPicture;
using mapping::DepthMaker;
using mapping::DepthResult;
using mapping::ReportFacts;

/// How a map is made, as the package says it.
struct Wishes {
  DepthOptions options;
  Alignment align = Alignment::similarity;
  std::string backend;
  int threads = 0;
  bool is_filled = false;
  std::optional<Calibration> calibration;
  ReportFacts facts;
};

Alignment alignment_of(py::handle value) {
  constexpr Alignment kAll[] = {Alignment::none, Alignment::scale, Alignment::similarity};
  std::vector<std::string> names;
  for (const Alignment alignment : kAll) names.emplace_back(to_string(alignment));
  return kAll[given_choice(value, "align", names)];
}

Wishes wishes_of(const py::dict& given) {
  Wishes wishes;
  const auto side = wished_count(given["window"], "window");
  const auto stride = wished_count(given["stride"], "stride");
  if (side) wishes.options.sides = {*side};
  if (stride && *stride < 1) refuse(fmt::format("stride is {}; it is 1 px or more", *stride));
  wishes.options.stride = stride.value_or(0);
  wishes.facts.window = side ? std::to_string(*side) : "auto";
  wishes.facts.stride = stride;
  wishes.align = alignment_of(given["align"]);
  wishes.facts.align = to_string(wishes.align);
  wishes.backend = wished_text(given["backend"], "backend").value_or("");
  wishes.threads = thread_count(wished_count(given["threads"], "threads"));
  wishes.facts.is_filled = wishes.is_filled = given["fill"].cast<bool>();
  if (given["calibration"].is_none()) return wishes;
  wishes.calibration = given["calibration"].cast<const Calibration&>();
  wishes.options.blur = wishes.calibration->conditions().blur;
  wishes.facts.calibration = given["calibration_name"].cast<std::string>();
  return wishes;
}

void refuse_other_unit(const Wishes& wishes, const std::string& unit) {
  if (!wishes.calibration) return;
  const CalibrationConditions& made = wishes.calibration->conditions();
  if (!made.has_other_unit(unit)) return;
  refuse(
      fmt::format("calibration has positions in {}, this stack in {}; give positions and unit= "
                  "as they were when it was made",
                  made.unit, unit));
}

/// index.tif and Sharp count in 16 bits.
void require_countable(std::size_t positions) {
  constexpr std::size_t kMost = 65536;
  if (positions > kMost)
    refuse(fmt::format("{} positions are more than the {} that a map can count", positions, kMost));
}

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Where a map comes from, whoever brings its pictures. Needs no lock of Python's.
class Making {
 public:
  Making(Wishes wishes, std::string unit, std::string rig)
      : wishes_(std::move(wishes)), unit_(std::move(unit)), rig_(std::move(rig)) {
    refuse_other_unit(wishes_, unit_);
  }

  DepthMaker& begin(const PictureShape& shape, bool has_colours, std::vector<double> positions) {
    require_countable(positions.size());
    wishes_.facts.frames_expected = positions.size();
    const OpenDevice open = [this](const MetricSpec& spec, std::size_t windows) {
      const DeviceOptions device = {.threads = wishes_.threads};
      Selection selection = select_device(all_backends(), wishes_.backend, spec, windows, device);
      wishes_.facts.backend = selection.backend;
      return selection;
    };
    maker_.emplace(open, shape, has_colours, std::move(positions), wishes_.options);
    start_ = Clock::now();
    return *maker_;
  }

  DepthMaker& maker() { return *maker_; }
  /// For pictures that come at these positions.
  StackAligner aligner(std::vector<double> positions) {
    law_ = mapping::growth_law(wishes_.align, {.calibration = wishes_.calibration},
                               std::move(positions));
    return StackAligner(wishes_.align, law_);
  }
  const ReportFacts& facts() const { return wishes_.facts; }

  DepthResult finish(const StackAligner& aligner) {
    ReportFacts& facts = wishes_.facts;
    facts.read_seconds = seconds_since(start_);
    facts.moved_px = maker_->moved_px();
    if (law_) facts.growth = {.told = law_->per_unit, .fitted = *aligner.growth_per_unit()};
    const auto start = Clock::now();
    DepthResult result = maker_->finish(wishes_.is_filled);
    maker_.reset();
    result.rig = rig_;
    result.lens_unit = result.unit = unit_;
    if (wishes_.calibration) {
      mapping::make_metric(result.maps, *wishes_.calibration);
      result.unit = "mm";
    }
    facts.map_seconds = seconds_since(start);
    return result;
  }

 private:
  Wishes wishes_;
  std::string unit_, rig_;
  std::optional<DepthMaker> maker_;
  Clock::time_point start_;
  std::optional<GrowthLaw> law_;
};

/// One picture of Python's, looked at or copied.
struct Taken {
  std::optional<Pictures> array;  ///< Held for the frame.
  ColourPicture picture;
  bool is_coloured = false;

  PictureShape shape() const {
    return {picture.grey.width_px(), picture.grey.height_px(), picture.grey.depth()};
  }
};

Taken taken(py::handle image, const std::string& name) {
  Taken one;
  one.is_coloured = is_coloured(image);
  if (one.is_coloured) {
    one.picture = colour_picture(py::reinterpret_borrow<py::array>(image), name);
    return one;
  }
  one.array.emplace(image, name.c_str());
  if (one.array->is_stack()) refuse(fmt::format("{} has 3 axes; a stack has one more", name));
  one.picture.grey = one.array->frame(0);
  return one;
}

/// Takes the pictures of a stack one by one, in the order of its positions.
class DepthTaker {
 public:
  /// counts: how many pictures there are of each position.
  DepthTaker(const py::dict& wishes, std::vector<double> positions, std::vector<std::size_t> counts,
             std::string unit)
      : making_(wishes_of(wishes), std::move(unit), wishes["rig"].cast<std::string>()),
        positions_(std::move(positions)),
        counts_(std::move(counts)),
        aligner_(making_.aligner(positions_)) {}

  void take(py::handle image, const std::string& name) {
    Taken one = taken(image, name);
    if (index_ == counts_.size())
      refuse(fmt::format("{} is one more picture than there are positions", name));
    const py::gil_scoped_release unlocked;
    SignalWatch watch;
    const Interruptible interruptible([&watch] { watch.look(); });
    if (!shape_) begin(one, name);
    require_alike(one, name);
    if (which_ == 0) place_ = aligner_.add(one.picture.grey);
    one.picture.place = place_;
    counts_[index_] == 1 ? making_.maker().add(index_, one.picture) : add_to_mean(one.picture);
    if (++which_ < counts_[index_]) return;
    which_ = 0;
    ++index_;
  }

  py::dict finish() {
    if (counts_.empty()) refuse("stack holds no picture");
    if (index_ < counts_.size()) {
      refuse(fmt::format("stack ended after {} pictures, before the position {}", taken_,
                         positions_[index_]));
    }
    std::optional<DepthResult> result;
    {
      const py::gil_scoped_release unlocked;
      SignalWatch watch;
      const Interruptible interruptible([&watch] { watch.look(); });
      result = making_.finish(aligner_);
    }
    return dict_of(std::move(*result), making_.facts());
  }

 private:
  void begin(const Taken& first, const std::string& name) {
    making_.begin(first.shape(), first.is_coloured, positions_);
    shape_ = first.shape();
    is_coloured_ = first.is_coloured;
    first_name_ = name;
  }

  void require_alike(const Taken& one, const std::string& name) {
    ++taken_;
    if (one.shape() == *shape_ && one.is_coloured == is_coloured_) return;
    const auto words = [](const PictureShape& shape, bool colours) {
      return to_string(shape) + (colours ? " colours" : "");
    };
    refuse(fmt::format("{} is {}, and {} {}", name, words(one.shape(), one.is_coloured),
                       first_name_, words(*shape_, is_coloured_)));
  }

  void add_to_mean(const ColourPicture& picture) {
    if (which_ == 0) average_ = {};
    average_.add(picture.grey);
    making_.maker().blend(index_, picture);
    if (which_ + 1 == counts_[index_]) making_.maker().add_mean(index_, average_.mean(), place_);
  }

  Making making_;
  std::vector<double> positions_;
  std::vector<std::size_t> counts_;
  StackAligner aligner_;
  Similarity place_;
  FrameAverage average_;
  std::optional<PictureShape> shape_;
  bool is_coloured_ = false;
  std::string first_name_;
  std::size_t index_ = 0, which_ = 0, taken_ = 0;
};

py::list list_of(const std::vector<Finding>& findings) {
  py::list list;
  for (const Finding& finding : findings) list.append(dict_of(Warning(finding)));
  return list;
}

DepthResult make_of(replay::RecordedStack& stack, Making& making) {
  SignalWatch watch;
  const Interruptible interruptible([&watch] { watch.look(); });
  DepthMaker& maker = making.begin(stack.shape(), stack.is_colour(), stack.positions());
  StackAligner aligner = making.aligner(stack.positions());
  read_stack(stack, aligner, maker, [&watch](std::size_t, std::size_t) {
    watch.look();
    return true;
  });
  DepthResult result = making.finish(aligner);
  if (stack.unit() == "um") result.spacing_um = stack.resolution();
  return result;
}

std::optional<replay::RecordedStack> open_recording(const std::string& rig) {
  const py::gil_scoped_release unlocked;
  return replay::open_recording(rig);
}

py::dict depth_of(const std::string& rig, const py::dict& given) {
  auto stack = open_recording(rig);
  if (!stack) {
    refuse(
        fmt::format("stack is the rig {}, which has no pictures yet; capture some, and give "
                    "the array of them",
                    rig));
  }
  Making making(wishes_of(given), stack->unit(), rig);
  const py::list warnings = list_of(stack->findings());
  std::optional<DepthResult> result;
  {
    const py::gil_scoped_release unlocked;
    result = make_of(*stack, making);
  }
  py::dict values = dict_of(std::move(*result), making.facts());
  values["warnings"] = warnings;
  return values;
}

/// What `fathom depth` would leave of the same map.
std::vector<std::string> save_depth(const py::dict& values, const std::string& folder,
                                    const std::string& made, const py::dict& extra) {
  const DepthResult result = depth_result_of(values);
  ReportFacts facts = facts_of(values);
  facts.made = made;
  const mapping::ExtraFiles files = {.ply = extra["ply"].cast<bool>(),
                                     .obj = extra["obj"].cast<bool>(),
                                     .sharp_tiff = extra["sharp_tiff"].cast<bool>()};
  const py::gil_scoped_release unlocked;
  mapping::OutputFolder output(folder);
  write_map(result, mapping::summary_of(result.maps), files, facts, output);
  output.move_in();
  return facts.files;
}

py::bytes png(const Raster& raster) { return encode_png(raster, PngEffort::small); }

/// The depths from low to high in colours, with a scale beside them.
py::bytes depth_png(const py::array_t<float, py::array::c_style>& depth, double low, double high,
                    const std::string& unit) {
  DepthMaps maps;
  maps.height_px = static_cast<int>(depth.shape(0));
  maps.width_px = static_cast<int>(depth.shape(1));
  maps.position.assign(depth.data(), depth.data() + depth.size());
  const mapping::PalettePicture picture = mapping::coloured(maps, low, high, unit);
  Raster raster = raster_of(picture.values.data(), picture.width_px, picture.height_px);
  raster.palette = picture.palette;
  return png(raster);
}

}  // namespace

void bind_depth(py::module_& module) {
  module.def("depth_of", &depth_of);
  module.def("save_depth", &save_depth);
  module.def("depth_png", &depth_png);
  module.attr("depth_classes") = [] {
    py::list names;
    for (const DepthClass value : mapping::kAllDepthClasses) names.append(to_string(value));
    return py::tuple(names);
  }();
  py::class_<DepthTaker>(module, "DepthTaker")
      .def(py::init<const py::dict&, std::vector<double>, std::vector<std::size_t>, std::string>())
      .def("take", &DepthTaker::take)
      .def("finish", &DepthTaker::finish);
}

}  // namespace fathom::python
