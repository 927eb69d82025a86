// SPDX-License-Identifier: Apache-2.0
// VkFFT through Vulkan, doing the whole work: a kernel that widens and tapers, VkFFT's real
// transform of a batch, a kernel that weighs and sums magnitudes.
#pragma once

#include "bench/peers/peer.hpp"

namespace fathom::bench {

/// Whether there is a Vulkan device for it.
bool has_vulkan_device();

/// On the first device that can be opened.
std::unique_ptr<PreparedPeer> prepare_vkfft_vulkan(int n, Planning planning);

}  // namespace fathom::bench
