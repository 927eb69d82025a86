// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/depth/surveying.hpp"

namespace fathom::cli {

mapping::Survey survey(Taking& taking, const std::string& label, const OpenDevice& open,
                       const std::optional<BlurModel>& blur, Observer& observer) {
  DepthOptions options;
  options.blur = taking.facts().lens_blur ? taking.facts().lens_blur : blur;
  TakingBar bar(label);
  DepthMaker maker = taking.take(open, options, bar, observer);
  return mapping::survey_of(maker.finish(false), taking.facts().unit,
                            taking.facts().positions.size());
}

}  // namespace fathom::cli
