// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include "bench/peers/peer.hpp"
#ifdef FATHOM_HAS_OPENCL_PEERS
#include "bench/opencl/peer.hpp"
#endif

namespace fathom::bench {

std::span<const Peer> all_peers() {
  static const std::vector<Peer> peers = [] {
    std::vector<Peer> all = {
        {"peer-fftw", Transform::fft, prepare_fftw},
        {"peer-fftw-walsh", Transform::walsh_sequency, prepare_fftw_walsh},
        {"peer-radix2-walsh", Transform::walsh_sequency, prepare_radix2_walsh},
        {"peer-radix2-int-walsh", Transform::walsh_sequency, prepare_radix2_int_walsh},
    };
#ifdef FATHOM_HAS_OPENCL_PEERS
    if (has_opencl_device()) {
      all.push_back({"peer-vkfft-opencl", Transform::fft, prepare_vkfft, true});
#ifdef FATHOM_HAS_CLFFT
      all.push_back({"peer-clfft", Transform::fft, prepare_clfft, true});
#endif
    }
#endif
    return all;
  }();
  return peers;
}

}  // namespace fathom::bench
