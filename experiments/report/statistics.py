"""Statistics of shares, histograms, repeats and Pareto fronts. Nothing here takes a mean of errors."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

ZERO_BIN = -100000  # the store's bin of values that are exactly 0
INFINITE_BIN = 100000  # the store's bin of infinite values: a hit was missed
BINS_PER_OCTAVE = 4  # the store's bin of a finite value is floor(4 log2 value)
Z_95 = 1.959963984540054  # normal quantile of a two-sided 95 % interval


def wilson(count: int, total: int, z: float = Z_95) -> tuple[float, float]:
    """Wilson score interval of a share (Wilson 1927), clipped to [0, 1]; (0, 1) when nothing was asked."""
    if total <= 0:
        return (0.0, 1.0)
    share = count / total
    centre = share + z * z / (2 * total)
    spread = z * math.sqrt(share * (1 - share) / total + z * z / (4 * total * total))
    scale = 1 + z * z / total
    low = 0.0 if count == 0 else max(0.0, (centre - spread) / scale)
    high = 1.0 if count == total else min(1.0, (centre + spread) / scale)
    return (low, high)


def rule_of_three(total: int) -> float:
    """Upper 95 % bound of a share when none of `total` was seen: 1 - 0.05^(1/n) <= 3/n."""
    return min(1.0, 3 / total) if total > 0 else 1.0


def upper_edge(bin_: int) -> float:
    """The upper edge of a histogram bin; values of the bin lie strictly below it."""
    if bin_ == ZERO_BIN:
        return 0.0
    exponent = (bin_ + 1) / BINS_PER_OCTAVE
    return math.inf if bin_ == INFINITE_BIN or exponent >= 1024 else 2.0**exponent


def histogram_quantile(bins: Iterable[tuple[int, int]], share: float) -> float | None:
    """Quantile of a histogram of (bin, count), read at the upper edge of its bin; None when empty.

    Infinite values stay in the denominator, so the answer can be infinite. A share of 1 is the worst value.
    """
    ordered = sorted((b, n) for b, n in bins if n > 0)
    total = sum(n for _, n in ordered)
    if total == 0:
        return None
    wanted = max(1, math.ceil(share * total - 1e-9))  # 1e-9: share * total of an exact count rounds up otherwise
    seen = 0
    for bin_, count in ordered:
        seen += count
        if seen >= wanted:
            return upper_edge(bin_)
    return upper_edge(ordered[-1][0])


def weighted_quantile(values: Sequence[float], weights: Sequence[float], share: float) -> float | None:
    """Smallest value that at least `share` of the weight does not exceed; None when there is no weight."""
    pairs = sorted((v, w) for v, w in zip(values, weights) if w > 0 and not math.isnan(v))
    total = math.fsum(w for _, w in pairs)
    if not pairs:
        return None
    seen = 0.0
    for value, weight in pairs:
        seen += weight
        if seen >= share * total * (1 - 1e-12):  # sums of weights carry rounding errors
            return value
    return pairs[-1][0]


def nearest_rank(values: Sequence[float], share: float) -> float:
    """Quantile by the nearest-rank rule: always one of the measured values."""
    ordered = sorted(values)
    return ordered[max(0, math.ceil(share * len(ordered) - 1e-9) - 1)]


def median(values: Sequence[float]) -> float:
    """Median; of an even count, the middle of the two middle values."""
    ordered = sorted(values)
    half = len(ordered) // 2
    return ordered[half] if len(ordered) % 2 else 0.5 * (ordered[half - 1] + ordered[half])


def pareto_front(points: Sequence[tuple[float, float]]) -> list[int]:
    """Indices of the points no other point beats in both coordinates (smaller is better), by rising first one.

    Points that are equal in both coordinates are kept together; points with a NaN never belong.
    """
    usable = [i for i, p in enumerate(points) if not any(math.isnan(c) for c in p)]
    usable.sort(key=lambda i: points[i])
    front: list[int] = []
    for i in usable:
        if not front or points[i][1] < points[front[-1]][1] or points[i] == points[front[-1]]:
            front.append(i)
    return front


def bins_per_decade(decades: float) -> int:
    """Width of difficulty bins: whole decades on long scales, finer on short ones, so that curves have >= 4 points."""
    return 1 if decades > 6 else 2 if decades > 2 else 4


def strata_weights(total: int, kept: int, sampled: int) -> float | None:
    """Weight of a sampled record when `kept` of `total` rays have a record of their own and the rest was sampled.

    1 when no ray is without a record; None when rays have no record and no sample stands for them.
    """
    if kept + sampled >= total:
        return 1.0
    return (total - kept) / sampled if sampled > 0 else None
