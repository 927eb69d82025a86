# SPDX-License-Identifier: Apache-2.0
"""How sure a median of a few repetitions is, and whether two sets of them differ."""
import functools
import math
import random
import statistics

RESAMPLES = 2000
COVERED = 0.95
SEED = 1989  # so that one set of results always gives one report
FEWEST = 5  # repetitions of each for a test: of four against four even 1 in 35 shuffles is the extreme one


def _quantiles(values):
    values = sorted(values)
    last = len(values) - 1
    return values[round((1 - COVERED) / 2 * last)], values[round((1 + COVERED) / 2 * last)]


def _medians(values, dice):
    return [statistics.median(dice.choices(values, k=len(values))) for _ in range(RESAMPLES)]


def median_interval(values):
    """(low, high), 95 % of bootstrapped medians (B. Efron, "Bootstrap Methods", Ann. Statist. 7, 1979: percentiles)."""
    return _quantiles(_medians(values, random.Random(SEED)))


def ratio_interval(over, under):
    """The same of the ratio of two medians, each resampled by itself."""
    dice = random.Random(SEED)
    return _quantiles(a / b for a, b in zip(_medians(over, dice), _medians(under, dice)))


@functools.cache
def _orders(m, n):
    """[U] in how many orders of m and n values so many pairs stand the one way round."""
    if m == 0 or n == 0:
        return (1,)
    counts = [0] * (m * n + 1)
    for u, count in enumerate(_orders(m - 1, n)):  # the largest is of the first: n pairs more
        counts[u + n] += count
    for u, count in enumerate(_orders(m, n - 1)):
        counts[u] += count
    return tuple(counts)


def p_value(first, second):
    """Of the two-sided Mann-Whitney test (H. B. Mann, D. R. Whitney, Ann. Math. Statist. 18, 1947), by all orders; of
    equal values half a pair each, rounded towards no difference."""
    u = sum(1 if a > b else 0.5 if a == b else 0 for a in first for b in second)
    pairs = len(first) * len(second)
    tail = math.ceil(min(u, pairs - u))
    counts = _orders(len(first), len(second))
    return min(1.0, 2 * sum(counts[:tail + 1]) / math.comb(len(first) + len(second), len(first)))


def discoveries(p_values, rate=0.05):
    """The names whose difference is believed, so that of all that are believed at most this part is chance
    (Y. Benjamini, Y. Hochberg, J. R. Statist. Soc. B 57, 1995). p_values: {name: p}."""
    ranked = sorted(p_values, key=p_values.get)
    count = max((i for i, name in enumerate(ranked, 1) if p_values[name] <= rate * i / len(ranked)), default=0)
    return set(ranked[:count])
