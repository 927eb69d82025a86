// SPDX-License-Identifier: Apache-2.0
#include "bench/opencl/peer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "bench/opencl/batched_fft.hpp"
#include "bench/peers/device_batch.hpp"
#include "bench/peers/tables.hpp"
#include "engine/error.hpp"

namespace fathom::bench {
namespace {

constexpr const char* kKernels = R"(
#define COLUMNS (N / 2 + 1)
// Rows of N floats in the place of N/2 + 1 complex numbers. One work-item a row.
__kernel void widen(__global const uchar* frame, uint stride, __global const uint* windows,
                    __global const float* taper, __global float* to) {
  const uint window = get_global_id(0) / N, y = get_global_id(0) % N;
  __global const uchar* const from = frame + windows[window] + y * stride;
  __global float* const row = to + (window * N + y) * 2 * COLUMNS;
  for (int x = 0; x < N; ++x) row[x] = from[x] * (taper[y] * taper[x]);
}
// One work-item a row, then one a window.
__kernel void sum_rows(__global const float2* from, __global const float* weights,
                       __global float* sums) {
  const uint row = get_global_id(0);
  __global const float2* const z = from + row * COLUMNS;
  __global const float* const weight = weights + row % N * COLUMNS;
  float sum = 0;
  for (int x = 0; x < COLUMNS; ++x) sum += weight[x] * sqrt(z[x].x * z[x].x + z[x].y * z[x].y);
  sums[row] = sum;
}
__kernel void sum_windows(__global const float* sums, __global float* scores) {
  float sum = 0;
  for (int y = 0; y < N; ++y) sum += sums[get_global_id(0) * N + y];
  scores[get_global_id(0)] = sum;
}
)";

using opencl::cl;

void require(cl_int result, const char* doing) {
  if (result != CL_SUCCESS) {
    throw std::runtime_error(fmt::format("OpenCL peer: {} failed ({})", doing, result));
  }
}

opencl::PhysicalDevice first_device() {
  const auto devices = opencl::list_devices();
  if (devices.empty()) throw std::runtime_error("OpenCL peer: no OpenCL device");
  return devices[0];
}

class OpenclPeer final : public PreparedPeer {
 public:
  OpenclPeer(int n, std::size_t batch, const opencl::PhysicalDevice& device,
             std::unique_ptr<BatchedFft> fft)
      : n_(n), batch_(batch), device_(device), fft_(std::move(fft)) {
    compile();
    const std::vector<float> taper = hann_taper(n), weights = half_plane_weights(n);
    taper_ = constant(taper);
    weights_ = constant(weights);
    windows_ = buffer(4 * batch_);
    sums_ = buffer(4 * batch_ * n);
    scores_ = buffer(4 * batch_);
    factor_ = score_factor(n);
  }

  void score(const Frame& frame, std::span<const Window> windows,
             std::span<double> scores) override {
    upload(frame);
    for (std::size_t first = 0; first < windows.size(); first += batch_) {
      const std::size_t count = std::min(batch_, windows.size() - first);
      score_batch(frame, windows.subspan(first, count), scores.subspan(first, count));
    }
  }

 private:
  void compile() {
    cl_int result = CL_SUCCESS;
    const char* text = kKernels;
    program_ = opencl::Handle<cl_program>(
        cl().CreateProgramWithSource(fft_->context(), 1, &text, nullptr, &result));
    require(result, "a program");
    const std::string options = fmt::format("-cl-fast-relaxed-math -DN={}", n_);
    require(cl().BuildProgram(program_.get(), 1, &device_.id, options.c_str(), nullptr, nullptr),
            "compiling");
    for (const auto& [kernel, name] :
         {std::pair(&widen_, "widen"), std::pair(&sum_rows_, "sum_rows"),
          std::pair(&sum_windows_, "sum_windows")}) {
      *kernel = opencl::Handle<cl_kernel>(cl().CreateKernel(program_.get(), name, &result));
      require(result, name);
    }
  }

  opencl::Handle<cl_mem> buffer(std::size_t bytes) const {
    cl_int result = CL_SUCCESS;
    opencl::Handle<cl_mem> made(
        cl().CreateBuffer(fft_->context(), CL_MEM_READ_WRITE, bytes, nullptr, &result));
    require(result, "a buffer");
    return made;
  }

  void write(const opencl::Handle<cl_mem>& to, const void* from, std::size_t bytes) const {
    require(cl().EnqueueWriteBuffer(fft_->queue(), to.get(), CL_TRUE, 0, bytes, from, 0, nullptr,
                                    nullptr),
            "writing");
  }

  opencl::Handle<cl_mem> constant(const std::vector<float>& numbers) const {
    opencl::Handle<cl_mem> made = buffer(4 * numbers.size());
    write(made, numbers.data(), 4 * numbers.size());
    return made;
  }

  void upload(const Frame& frame) {
    const std::size_t bytes = frame.stride_bytes() * static_cast<std::size_t>(frame.height_px());
    if (bytes > frame_bytes_) frame_ = buffer(bytes);
    frame_bytes_ = std::max(frame_bytes_, bytes);
    write(frame_, frame.row(0), bytes);
  }

  template <class... Arguments>
  void enqueue(const opencl::Handle<cl_kernel>& kernel, std::size_t items,
               const Arguments&... arguments) const {
    cl_uint index = 0;
    (require(cl().SetKernelArg(kernel.get(), index++, sizeof arguments, &arguments), "an argument"),
     ...);
    require(cl().EnqueueNDRangeKernel(fft_->queue(), kernel.get(), 1, nullptr, &items, nullptr, 0,
                                      nullptr, nullptr),
            "a kernel");
  }

  void score_batch(const Frame& frame, std::span<const Window> windows, std::span<double> scores) {
    const auto origins = window_origins(frame, windows);
    write(windows_, origins.data(), 4 * origins.size());
    const std::size_t rows = windows.size() * static_cast<std::size_t>(n_);
    enqueue(widen_, rows, frame_.get(), static_cast<cl_uint>(frame.stride_bytes()), windows_.get(),
            taper_.get(), fft_->buffer());
    fft_->start();
    enqueue(sum_rows_, rows, fft_->buffer(), weights_.get(), sums_.get());
    enqueue(sum_windows_, windows.size(), sums_.get(), scores_.get());
    std::vector<float> sums(windows.size());
    require(cl().EnqueueReadBuffer(fft_->queue(), scores_.get(), CL_TRUE, 0, 4 * sums.size(),
                                   sums.data(), 0, nullptr, nullptr),
            "reading");
    std::transform(sums.begin(), sums.end(), scores.begin(),
                   [this](float sum) { return factor_ * double{sum}; });
  }

  int n_;
  std::size_t batch_;
  opencl::PhysicalDevice device_;
  std::unique_ptr<BatchedFft> fft_;
  opencl::Handle<cl_program> program_;
  opencl::Handle<cl_kernel> widen_, sum_rows_, sum_windows_;
  opencl::Handle<cl_mem> frame_, windows_, taper_, weights_, sums_, scores_;
  std::size_t frame_bytes_ = 0;
  double factor_ = 0;
};

}  // namespace

bool has_opencl_device() {
  try {
    return !opencl::list_devices().empty();
  } catch (const Error&) {
    return false;
  }
}

std::unique_ptr<PreparedPeer> prepare_vkfft_opencl(int n, Planning) {
  const auto device = first_device();
  const std::size_t batch = device_batch(n);
  return std::make_unique<OpenclPeer>(n, batch, device, make_vkfft(device, n, batch, true));
}

#ifdef FATHOM_HAS_CLFFT
std::unique_ptr<PreparedPeer> prepare_clfft(int n, Planning) {
  const auto device = first_device();
  const std::size_t batch = device_batch(n);
  return std::make_unique<OpenclPeer>(n, batch, device, make_clfft(device, n, batch));
}
#endif

}  // namespace fathom::bench
