// SPDX-License-Identifier: Apache-2.0
#include "focus/distributions.hpp"

#include <algorithm>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <limits>

namespace fathom {

double student_t_within(double probability, double freedom) {
  const double beyond = (1 - probability) / 2;
  if (!(beyond > 0)) return std::numeric_limits<double>::infinity();
  return boost::math::quantile(boost::math::complement(boost::math::students_t(freedom), beyond));
}

double small_sample_factor(double freedom) {
  const double enough = std::max(freedom, 3.0);
  return enough / (enough - 2);
}

double fisher_beyond(double ratio, double above_freedom, double below_freedom) {
  const boost::math::fisher_f chance(above_freedom, below_freedom);
  return boost::math::cdf(boost::math::complement(chance, ratio));
}

}  // namespace fathom
