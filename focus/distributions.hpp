// SPDX-License-Identifier: Apache-2.0
// Student's t and Fisher's F: how far a few residuals let one trust their own scatter. Boost.Math
// is compiled here alone.
#pragma once

namespace fathom {

/// The t that a variable of Student's distribution stays within, either side of 0, with this
/// probability. freedom > 0, 0 < probability < 1; infinity for a probability too near to 1 to tell.
double student_t_within(double probability, double freedom);

/// How much larger a variance must be taken that was estimated from so few degrees of freedom: that
/// of Student's t over the Gaussian's. It has none below 3, so fewer count as 3, which still
/// flatters them.
double small_sample_factor(double freedom);

/// The probability that chance alone makes the ratio of two variances exceed `ratio`, by Fisher's
/// distribution with these degrees of freedom. ratio >= 0, both degrees > 0.
double fisher_beyond(double ratio, double above_freedom, double below_freedom);

}  // namespace fathom
