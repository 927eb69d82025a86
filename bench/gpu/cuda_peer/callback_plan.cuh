// SPDX-License-Identifier: Apache-2.0
// A plan of cuFFT with a load and a store callback linked into its kernels.
#pragma once

#include <cufftXt.h>

#include <fstream>
#include <iterator>

#include "check.cuh"
#include "metric.cuh"

namespace fathom::peer {

/// cuFFT makes no such plan here; that is no error of the peer's.
struct PlanRefused : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// What nvcc made of load_callbacks.cu and store_callbacks.cu.
struct CallbackCode {
  explicit CallbackCode(const std::string& folder)
      : load(read(folder + "/load.fatbin")), store(read(folder + "/store.fatbin")) {}

  std::string load, store;

 private:
  static std::string read(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    if (bytes.empty()) throw std::runtime_error("no callbacks in " + path);
    return bytes;
  }
};

class CallbackPlan {
 public:
  /// info: a CallbackInfo on the device. It and the code must outlive the plan.
  CallbackPlan(const Metric& metric, std::size_t windows, const CallbackCode& code, void* info,
               cudaStream_t stream)
      : load_name_("fathom_load_" + std::to_string(metric.n) + "_" + std::to_string(metric.depth)),
        store_name_("fathom_store_" + std::to_string(metric.n) +
                    (metric.is_power ? "_power" : "_magnitude")),
        info_(info) {
    PEER_CHECK(cufftCreate(&plan_));
    try {
      make(metric.n, windows, code);
      PEER_CHECK(cufftSetStream(plan_, stream));
    } catch (...) {
      cufftDestroy(plan_);  // no destructor runs after this
      throw;
    }
  }
  CallbackPlan(const CallbackPlan&) = delete;
  CallbackPlan& operator=(const CallbackPlan&) = delete;
  ~CallbackPlan() { cufftDestroy(plan_); }

  /// The callbacks read the frame and write the sums. spectrum: as large as if it were written,
  /// for cuFFT may keep there what is between its kernels.
  void run(const unsigned char* frame, cufftComplex* spectrum) const {
    auto* const unread = reinterpret_cast<float*>(const_cast<unsigned char*>(frame));
    PEER_CHECK(cufftExecR2C(plan_, unread, spectrum));
  }

 private:
  /// Callbacks are set before the plan is made, and linked when it is.
  void make(int n, std::size_t windows, const CallbackCode& code) {
#if CUFFT_VERSION >= 11300
    accept(cufftXtSetJITCallback(plan_, load_name_.c_str(), code.load.data(), code.load.size(),
                                 CUFFT_CB_LD_REAL, &info_),
           "a load callback");
    accept(cufftXtSetJITCallback(plan_, store_name_.c_str(), code.store.data(), code.store.size(),
                                 CUFFT_CB_ST_COMPLEX, &info_),
           "a store callback");
    int sides[2] = {n, n};
    std::size_t bytes = 0;
    accept(cufftMakePlanMany(plan_, 2, sides, nullptr, 1, 0, nullptr, 1, 0, CUFFT_R2C,
                             static_cast<int>(windows), &bytes),
           "a plan with callbacks");
#else
    throw PlanRefused("cuFFT links callbacks from CUDA 12.6 Update 2 on");
#endif
  }

  static void accept(cufftResult result, const char* what) {
    if (result == CUFFT_SUCCESS) return;
    throw PlanRefused(std::string("cuFFT refused ") + what + ": " + text(result));
  }

  // cuFFT keeps pointers to these.
  std::string load_name_, store_name_;
  void* info_;
  cufftHandle plan_ = 0;
};

}  // namespace fathom::peer
