// SPDX-License-Identifier: Apache-2.0
// Every return code of CUDA and cuFFT becomes an exception; memory and streams free themselves.
#pragma once

#include <cuda_runtime.h>
#include <cufft.h>

#include <cstddef>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>

namespace fathom::peer {

inline void check(cudaError_t result, const char* call, int line) {
  if (result == cudaSuccess) return;
  throw std::runtime_error(std::string(call) + " in line " + std::to_string(line) + ": " +
                           cudaGetErrorName(result) + ", " + cudaGetErrorString(result));
}

/// cuFFT has no such function. Numbers, for older headers lack the last names.
inline std::string text(cufftResult result) {
  const int number = result;
  const char* const name = number == 2    ? ", CUFFT_ALLOC_FAILED"
                           : number == 5  ? ", CUFFT_INTERNAL_ERROR"
                           : number == 16 ? ", CUFFT_NOT_SUPPORTED"
                           : number == 17 ? ", CUFFT_MISSING_DEPENDENCY"
                           : number == 18 ? ", CUFFT_NVRTC_FAILURE"
                           : number == 19 ? ", CUFFT_NVJITLINK_FAILURE"
                                          : "";
  return "cufftResult " + std::to_string(number) + name;
}

inline void check(cufftResult result, const char* call, int line) {
  if (result == CUFFT_SUCCESS) return;
  throw std::runtime_error(std::string(call) + " in line " + std::to_string(line) + ": " +
                           text(result));
}

#define PEER_CHECK(call) ::fathom::peer::check((call), #call, __LINE__)

struct FreeDevice {
  void operator()(void* memory) const { cudaFree(memory); }
};
struct FreePinned {
  void operator()(void* memory) const { cudaFreeHost(memory); }
};

template <class T>
using DeviceArray = std::unique_ptr<T[], FreeDevice>;
template <class T>
using PinnedArray = std::unique_ptr<T[], FreePinned>;

template <class T>
DeviceArray<T> device_array(std::size_t count) {
  void* memory = nullptr;
  PEER_CHECK(cudaMalloc(&memory, count * sizeof(T)));
  return DeviceArray<T>(static_cast<T*>(memory));
}

template <class T>
PinnedArray<T> pinned_array(std::size_t count) {
  void* memory = nullptr;
  PEER_CHECK(cudaHostAlloc(&memory, count * sizeof(T), cudaHostAllocDefault));
  return PinnedArray<T>(static_cast<T*>(memory));
}

/// A copy on the device of what a container holds. cudaMemcpy from pageable memory may return
/// before the last bytes are there, and streams that do not block would not wait for them.
template <class Container>
auto on_device(const Container& values) {
  using T = typename Container::value_type;
  DeviceArray<T> copy = device_array<T>(values.size());
  PEER_CHECK(
      cudaMemcpy(copy.get(), values.data(), values.size() * sizeof(T), cudaMemcpyHostToDevice));
  PEER_CHECK(cudaDeviceSynchronize());
  return copy;
}

class Stream {
 public:
  Stream() { PEER_CHECK(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking)); }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
  ~Stream() {
    cudaStreamSynchronize(stream_);
    cudaStreamDestroy(stream_);
  }
  cudaStream_t get() const { return stream_; }

 private:
  cudaStream_t stream_ = nullptr;
};

}  // namespace fathom::peer
