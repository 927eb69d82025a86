// SPDX-License-Identifier: Apache-2.0
// VkFFT through OpenCL, doing the whole work: a kernel that widens and tapers, VkFFT's real
// transform of a batch, a kernel that weighs and sums magnitudes. On every processor, or a GPU.
#pragma once

#include "bench/peers/peer.hpp"

namespace fathom::bench {

/// Whether there is an OpenCL device for them.
bool has_opencl_device();

std::unique_ptr<PreparedPeer> prepare_vkfft_opencl(int n, Planning planning);
std::unique_ptr<PreparedPeer> prepare_clfft(int n, Planning planning);

}  // namespace fathom::bench
