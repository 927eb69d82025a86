// SPDX-License-Identifier: Apache-2.0
#include "mapping/writing.hpp"

#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include "mapping/colour_map.hpp"
#include "mapping/mesh.hpp"
#include "mapping/view.hpp"
#include "pictures/raster.hpp"

namespace fathom::mapping {
namespace {

/// One file: its name and what makes its bytes.
struct Task {
  std::string name;
  std::function<std::string()> bytes;
};

std::string xml_escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
    }
  }
  return result;
}

/// OME-XML of one plane where the stack's spacing is known; else a line that says the unit.
std::string description_of(const DepthResult& result, const char* what, const char* type,
                           const std::string& unit) {
  if (!result.spacing_um) return fmt::format("{} ({}) by fathom depth", what, unit);
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>"
      "<OME xmlns=\"http://www.openmicroscopy.org/Schemas/OME/2016-06\">"
      "<Image ID=\"Image:0\" Name=\"{0}\"><Pixels ID=\"Pixels:0\" DimensionOrder=\"XYZCT\" "
      "Type=\"{1}\" SizeX=\"{2}\" SizeY=\"{3}\" SizeZ=\"1\" SizeC=\"1\" SizeT=\"1\" "
      "PhysicalSizeZ=\"{4:.9g}\" PhysicalSizeZUnit=\"&#181;m\">"
      "<Channel ID=\"Channel:0:0\" Name=\"{0} ({5})\" SamplesPerPixel=\"1\"/>"
      "<TiffData IFD=\"0\" PlaneCount=\"1\"/></Pixels></Image></OME>",
      what, type, result.maps.width_px, result.maps.height_px, *result.spacing_um,
      xml_escaped(unit));
}

std::string float_tiff(const DepthResult& result, const std::vector<float>& values,
                       const char* what, const std::string& unit) {
  Raster raster = raster_of(values.data(), result.maps.width_px, result.maps.height_px);
  raster.description = description_of(result, what, "float", unit);
  return encode_tiff(raster);
}

std::string index_tiff(const DepthResult& result) {
  Raster raster = raster_of(result.sharp.frame.data(), result.maps.width_px, result.maps.height_px);
  raster.description = description_of(result, "frame", "uint16", "number from 0");
  return encode_tiff(raster);
}

Raster sharp_raster(const Sharp& sharp) {
  return sharp.colours.empty()
             ? raster_of(sharp.grey)
             : raster_of(sharp.colours, sharp.grey.width_px(), sharp.grey.height_px());
}

std::string png_of(const PalettePicture& picture) {
  Raster raster = raster_of(picture.values.data(), picture.width_px, picture.height_px);
  raster.palette = picture.palette;
  return encode_png(raster, PngEffort::fast);
}

/// The slow ones first, so that two threads end at about the same time.
std::vector<Task> tasks_for(const DepthResult& result, const DepthSummary& summary,
                            const ExtraFiles& extra) {
  const DepthMaps& maps = result.maps;
  std::vector<Task> tasks;
  if (extra.obj) tasks.push_back({"depth.obj", [&] { return obj_of(result, mesh_scale(result)); }});
  if (extra.sharp_tiff) {
    tasks.push_back({"sharp.tif", [&] { return encode_tiff(sharp_raster(result.sharp)); }});
  } else {
    tasks.push_back(
        {"sharp.png", [&] { return encode_png(sharp_raster(result.sharp), PngEffort::fast); }});
  }
  tasks.push_back({"hill.png", [&] {
                     const auto relief = shaded(maps, !result.is_metric());
                     return encode_png(raster_of(relief.data(), maps.width_px, maps.height_px),
                                       PngEffort::fast);
                   }});
  tasks.push_back({"depth.png",
                   [&] { return png_of(coloured(maps, summary.low, summary.high, result.unit)); }});
  tasks.push_back(
      {"depth.tif", [&] { return float_tiff(result, maps.position, "depth", result.unit); }});
  tasks.push_back(
      {"sigma.tif", [&] { return float_tiff(result, maps.sigma, "sigma", result.unit); }});
  tasks.push_back({"confidence.tif",
                   [&] { return float_tiff(result, maps.confidence, "confidence", "0 to 1"); }});
  tasks.push_back({"index.tif", [&] { return index_tiff(result); }});
  tasks.push_back({"class.png", [&] { return png_of(classes_of(maps)); }});
  if (extra.ply) tasks.push_back({"depth.ply", [&] { return ply_of(result, mesh_scale(result)); }});
  tasks.push_back({"view.html", [&] { return view_page(result, summary); }});
  return tasks;
}

/// Runs the tasks on this thread and another one; the first failure ends both.
class TwoThreads {
 public:
  TwoThreads(const std::vector<Task>& tasks, const OutputFolder& folder)
      : tasks_(tasks), folder_(folder) {}

  void run() {
    std::thread other([this] { work(); });
    work();
    other.join();
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  void work() noexcept {
    for (std::size_t i = next_++; i < tasks_.size(); i = next_++) {
      try {
        folder_.write(tasks_[i].name, tasks_[i].bytes());
      } catch (...) {
        const std::lock_guard lock(mutex_);
        if (!failure_) failure_ = std::current_exception();
        next_ = tasks_.size();
      }
    }
  }

  const std::vector<Task>& tasks_;
  const OutputFolder& folder_;
  std::atomic<std::size_t> next_ = 0;
  std::mutex mutex_;
  std::exception_ptr failure_;
};

}  // namespace

std::vector<std::string> write_files(const DepthResult& result, const DepthSummary& summary,
                                     const ExtraFiles& extra, const OutputFolder& folder) {
  const std::vector<Task> tasks = tasks_for(result, summary, extra);
  TwoThreads(tasks, folder).run();
  std::vector<std::string> names;
  for (const Task& task : tasks) names.push_back(task.name);
  return names;
}

void write_map(const DepthResult& result, const DepthSummary& summary, const ExtraFiles& extra,
               ReportFacts& facts, const OutputFolder& folder) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  facts.files = write_files(result, summary, extra, folder);
  facts.files.push_back("report.json");
  facts.write_seconds = std::chrono::duration<double>(Clock::now() - start).count();
  folder.write("report.json", report_json(result, summary, facts));
}

}  // namespace fathom::mapping
