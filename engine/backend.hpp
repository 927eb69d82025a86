// SPDX-License-Identifier: Apache-2.0
// Where scores are computed: a Backend lists devices, a Device makes plans, a Plan scores windows.
//
//   Backend  -- open(device) -->  Device  -- plan(spec, capacity) -->  Plan  -- score(...) -->
//   numbers
//
// A backend is a way to compute (plain C++, SIMD, Vulkan); listing its devices is cheap and never
// fails, opening one may. A device says which metrics it takes and why not the others. A plan holds
// everything that one metric needs, so that scoring allocates nothing. A Device outlives its plans.
//
// To add a backend, derive the three classes in a folder under backends/ and add one CMake line;
// the conformance suite finds it there (docs/adding-a-backend.md).
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "frame.hpp"
#include "metric.hpp"
#include "one_thread.hpp"
#include "window.hpp"

namespace fathom {

/// Scores and spectra of one metric. One plan serves one thread at a time: where a second one comes
/// meanwhile, every function throws Error(bad_argument) there. After a fork a GPU's plan serves the
/// parent only, and throws Error(device_lost) in the child; a plan of the CPU goes on there, on one
/// thread.
///
/// The public functions check their arguments once; the do_ functions of a backend may trust them.
class Plan {
 public:
  virtual ~Plan() = default;
  Plan(const Plan&) = delete;
  Plan& operator=(const Plan&) = delete;

  const MetricSpec& spec() const { return spec_; }
  /// Most windows that one call takes.
  std::size_t capacity() const { return capacity_; }

  /// A batch that was submitted and not yet waited for.
  struct Ticket {
    std::uint64_t number = 0;
  };

  /// Numbers of every window of a frame, K = spec().outputs() of each, window by window: those of
  /// windows[i] are values[i K] .. values[i K + K - 1]. A moment (eqs. 5-1 and 5-2) is one number,
  /// the focus quality, and so is an entropy; rings are K. Throws Error(bad_argument) for an empty frame, more windows
  /// than capacity(), a window whose side is not spec().n or values of another length;
  /// Error(out_of_bounds) for a window over the edge.
  void score(const Frame& frame, std::span<const Window> windows, std::span<double> values);

  /// Focus quality of one window. Throws Error(bad_argument), too, where a window has more numbers.
  double score(const Frame& frame, const Window& window);

  /// Starts the same work and returns; the frame, the windows and the values must stay until
  /// wait(). A backend may block here when its batches in flight are full. A plan that
  /// is destroyed waits for its batches first. Throws as score() does.
  Ticket submit(const Frame& frame, std::span<const Window> windows, std::span<double> values);

  /// Returns when the batch's values are written; at once if they are. Throws Error(device_lost).
  void wait(Ticket ticket);

  /// The transform's N * N coefficients, [row][col], with 1/N^2 in front (eq. 3-10), taper applied.
  /// fft: row v + N/2, column u + N/2, so that zero frequency stands at (N/2, N/2) (thesis T4).
  /// Walsh, dct: row i and column j of the spec's order, imaginary parts zero. `power`,
  /// `band` and the measure concern the score only. Throws as score() does; coefficients must have N *
  /// N elements.
  void spectrum(const Frame& frame, const Window& window,
                std::span<std::complex<double>> coefficients);

 protected:
  Plan(const MetricSpec& spec, std::size_t capacity)
      : spec_(spec), capacity_(capacity), outputs_(spec.outputs()) {}

 private:
  virtual void do_submit(std::uint64_t ticket, const Frame& frame, std::span<const Window> windows,
                         std::span<double> values) = 0;
  virtual void do_wait(std::uint64_t ticket) = 0;
  virtual void do_spectrum(const Frame& frame, const Window& window,
                           std::span<std::complex<double>> coefficients) = 0;

  void require_window(const Frame& frame, const Window& window) const;
  std::uint64_t submit_checked(const Frame& frame, std::span<const Window> windows,
                               std::span<double> values);

  MetricSpec spec_;
  std::size_t capacity_;
  std::size_t outputs_;
  std::uint64_t last_ticket_ = 0;
  OneThread door_;
};

/// What kind of processor a device is; `auto` never picks a software rasteriser.
enum class DeviceKind { cpu, gpu, software };

/// "cpu", "gpu" or "software".
const char* to_string(DeviceKind kind) noexcept;

/// One device as its backend lists it.
struct DeviceInfo {
  std::string name;  ///< As the driver calls it.
  DeviceKind kind = DeviceKind::cpu;
  std::string details;  ///< Driver, limits that matter; one line.
};

/// An opened device.
class Device {
 public:
  virtual ~Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  const DeviceInfo& info() const { return info_; }

  /// Processors that one call keeps busy at most. A GPU answers 1: the caller's.
  virtual int threads() const { return 1; }

  /// Why this device cannot compute the metric to the tolerance of the project; empty if it can. A
  /// metric that is not fused is computed if spec.plain() is, from its spectra.
  std::string unsupported(const MetricSpec& spec) const;

  /// Whether a kernel goes from pixels to the metric's numbers without writing a spectrum out. The
  /// others are computed from the device's spectra: as right, but slower by far.
  virtual bool fuses(const MetricSpec& spec) const = 0;

  /// Makes a plan for up to `capacity` windows a call. Throws Error(unsupported) with the reason,
  /// Error(bad_argument) for a capacity of 0 or an invalid spec, Error(out_of_memory) with how
  /// much.
  std::unique_ptr<Plan> plan(const MetricSpec& spec, std::size_t capacity);

 protected:
  explicit Device(DeviceInfo info) : info_(std::move(info)) {}

 private:
  /// Both are asked for metrics that the device fuses, and for plain ones of every transform.
  virtual std::string do_unsupported(const MetricSpec& spec) const = 0;
  virtual std::unique_ptr<Plan> do_plan(const MetricSpec& spec, std::size_t capacity) = 0;

  DeviceInfo info_;
};

/// What may take long while a device is chosen and opened.
enum class Work {
  listing,  ///< Asking a backend's drivers for their devices.
  opening,  ///< Opening a device, compiling what shows whether it takes the metric.
  timing,   ///< Timing devices against each other.
  done,     ///< The device is chosen, or none could be; the subject is empty.
};

/// Told before such work begins: what, and on which backend or devices. It must not throw.
using OnWork = std::function<void(Work work, const std::string& subject)>;

/// How a device is to be used; every backend takes what concerns it and ignores the rest.
struct DeviceOptions {
  /// Processors that one call may keep busy; 0: what FATHOM_THREADS says, else all there are.
  int threads = 0;
  /// May be empty.
  OnWork on_work = {};
};

/// A way to compute.
class Backend {
 public:
  virtual ~Backend() = default;

  /// The name that --backend takes: lower case, no colon.
  virtual const char* name() const noexcept = 0;

  /// Whether its devices are GPUs, or pretend to be: listing them connects to a driver, which takes
  /// milliseconds.
  virtual bool is_for_gpus() const noexcept { return false; }

  /// What devices() depends on, as a text that changes with it: the files of the drivers, and the
  /// kernels. Asked without connecting to a driver. Empty where the list is not worth keeping.
  virtual std::string drivers() const { return {}; }

  /// Its devices now, cheap; empty where there are none or the driver is missing: then open(0) says
  /// which.
  virtual std::vector<DeviceInfo> devices() const = 0;

  /// Opens devices()[index]. Throws Error(unavailable) saying what is missing, Error(bad_argument)
  /// for options that have no meaning.
  virtual std::unique_ptr<Device> open(std::size_t index, const DeviceOptions& options) const = 0;
};

}  // namespace fathom
