// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include "bench/peers/peer.hpp"
#ifdef FATHOM_HAS_OPENCL_PEERS
#include "bench/opencl/peer.hpp"
#endif
#ifdef FATHOM_HAS_VULKAN_PEER
#include "bench/vulkan/peer.hpp"
#endif

namespace fathom::bench {

std::span<const Peer> all_peers() {
  static const std::vector<Peer> peers = [] {
    std::vector<Peer> all = {
        {"peer-fftw", Transform::fft, prepare_fftw},
        {"peer-fftw-walsh", Transform::walsh_sequency, prepare_fftw_walsh},
        {"peer-fftw-dct", Transform::dct, prepare_fftw_dct},
        {"peer-radix2-walsh", Transform::walsh_sequency, prepare_radix2_walsh},
        {"peer-radix2-int-walsh", Transform::walsh_sequency, prepare_radix2_int_walsh},
    };
#ifdef FATHOM_HAS_FFHT
    all.push_back({"peer-ffht", Transform::walsh_sequency, prepare_ffht});
#endif
#ifdef FATHOM_HAS_OPENCL_PEERS
    if (has_opencl_device()) {
      all.push_back({"peer-vkfft-opencl", Transform::fft, prepare_vkfft_opencl, true});
#ifdef FATHOM_HAS_CLFFT
      all.push_back({"peer-clfft", Transform::fft, prepare_clfft, true});
#endif
    }
#endif
#ifdef FATHOM_HAS_VULKAN_PEER
    if (has_vulkan_device()) {
      all.push_back({"peer-vkfft-vulkan", Transform::fft, prepare_vkfft_vulkan, true});
    }
#endif
    return all;
  }();
  return peers;
}

}  // namespace fathom::bench
