"""Which changes are more than drift: innovations of a random walk, and a multivariate control chart of them.

A machine's errors theta wander, theta_k = theta_(k-1) + w_k with the covariance Q dt, and a campaign states
y_k = theta_k + v_k with the covariance R_k: that of the identification plus what varies from campaign to campaign. The
innovations of the Kalman filter, divided by the factor of their covariance, are independent and standard normal as long
as nothing else happens (Mehra and Peschon, Automatica 7 (1971) 637). They go into a multivariate exponentially weighted
moving average (Lowry et al., Technometrics 34 (1992) 46), whose length is a Markov chain (Runger and Prabhu, JASA 91
(1996) 1701). So the probability of a false alarm in a year is computed, not guessed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

CELLS = 240  # of the length of the average


def innovations(y: np.ndarray, covariances: np.ndarray, q_per_day: np.ndarray, days: np.ndarray) -> np.ndarray:
    """Standardised innovations [n - 1, p] of campaigns y [n, p]; the first campaign is the start."""
    state, variance = y[0], covariances[0]
    found = []
    for k in range(1, len(y)):
        variance = variance + q_per_day * (days[k] - days[k - 1])
        factor = np.linalg.cholesky(variance + covariances[k])
        z = np.linalg.solve(factor, y[k] - state)
        gain = np.linalg.solve(factor, variance).T  # variance times the inverse of the factor, transposed
        state = state + gain @ z
        variance = variance - gain @ gain.T
        variance = 0.5 * (variance + variance.T)
        found.append(z)
    return np.array(found).reshape(-1, y.shape[1])


def averages(z: np.ndarray, weight: float) -> np.ndarray:
    """Length of w_k = weight z_k + (1 - weight) w_(k-1) in its own standard deviations once it has settled."""
    w = np.zeros(z.shape[1])
    lengths = []
    for each in z:
        w = weight * each + (1 - weight) * w
        lengths.append(math.sqrt(w @ w * (2 - weight) / weight))
    return np.array(lengths)


def chi_square_below(x: np.ndarray, p: int, shift: np.ndarray) -> np.ndarray:
    """Probability [n, m] that a noncentral chi-square of p degrees of freedom and noncentrality shift[n] is below x[m].

    A mixture of central ones with Poisson weights. Those are sums of positive terms, x^a e^-x / Gamma(a + 1)."""
    half, mean = np.asarray(x) / 2, np.asarray(shift) / 2
    most = int(mean.max() + 12 * math.sqrt(mean.max() + 1) + 30)
    terms = int(most + half.max() + 12 * math.sqrt(half.max() + 1) + 60)
    a = p / 2 + np.arange(terms)
    log_gamma = np.array([math.lgamma(each + 1) for each in a])
    with np.errstate(divide="ignore"):
        parts = np.exp(a[:, None] * np.log(half)[None] - half[None] - log_gamma[:, None])
    central = np.cumsum(parts[::-1], axis=0)[::-1][:most]  # of p + 2 k degrees of freedom
    k = np.arange(most)
    log_factorial = np.array([math.lgamma(each + 1) for each in k])
    with np.errstate(divide="ignore", invalid="ignore"):
        log_mean = np.where(mean > 0, np.log(mean), -np.inf)[:, None]
        log_weight = np.where(k[None] > 0, k[None] * log_mean, 0) - mean[:, None] - log_factorial[None]
    return np.exp(log_weight) @ central


@lru_cache(maxsize=None)
def false_alarm(p: int, campaigns: int, weight: float, limit: float) -> float:
    """Probability that the chart exceeds its limit at least once in so many innovations, if nothing happens."""
    largest = limit * math.sqrt(weight / (2 - weight))  # of the average itself
    edges = np.linspace(0, largest, CELLS + 1)
    centres = np.concatenate(([0.0], (edges[1:] + edges[:-1]) / 2))
    below = chi_square_below((edges / weight) ** 2, p, ((1 - weight) * centres / weight) ** 2)
    steps = np.diff(below, axis=1)
    inside = np.vstack([steps[0], steps[1:]])  # from zero, and from each cell, to each cell
    at = inside[0]
    for _ in range(1, campaigns):
        at = at @ inside[1:]
    return float(1 - at.sum())


@lru_cache(maxsize=None)
def limit_for(p: int, campaigns: int, weight: float, probability: float) -> float:
    """The limit whose false alarm probability over so many innovations is the stated one."""
    low, high = 1.0, 4.0 + 3 * math.sqrt(p)
    for _ in range(40):
        middle = (low + high) / 2
        if false_alarm(p, campaigns, weight, middle) > probability:
            low = middle
        else:
            high = middle
    return high


@dataclass(frozen=True)
class Alarm:
    """The first campaign above the limit, and the last one before what raised it."""

    campaign: int
    before: int


def first_alarm(lengths: np.ndarray, limit: float, p: int) -> Alarm | None:
    """`lengths` are those of innovations 1, 2, ...: campaign k is lengths[k - 1]. What raised the alarm began after
    the last campaign at which the average was no longer than it is on average, sqrt(p), as in a cumulative sum."""
    above = np.flatnonzero(lengths > limit)
    if len(above) == 0:
        return None
    first = int(above[0])
    quiet = np.flatnonzero(lengths[:first] <= math.sqrt(p))
    return Alarm(first + 1, int(quiet[-1]) + 1 if len(quiet) else 0)


def binomial_interval(found: int, of: int, level: float = 0.95) -> tuple[float, float]:
    """Interval of Clopper and Pearson (Biometrika 26 (1934) 404) for a share."""
    if of == 0:
        return 0.0, 1.0

    def at_most(k: int, share: float) -> float:
        if share <= 0 or share >= 1:
            return 1.0 if share <= 0 or k >= of else 0.0
        return sum(math.exp(math.lgamma(of + 1) - math.lgamma(i + 1) - math.lgamma(of - i + 1)
                            + i * math.log(share) + (of - i) * math.log1p(-share)) for i in range(k + 1))

    def solve(k: int, target: float) -> float:
        low, high = 0.0, 1.0
        for _ in range(60):
            middle = (low + high) / 2
            low, high = (middle, high) if at_most(k, middle) > target else (low, middle)
        return (low + high) / 2

    tail = (1 - level) / 2
    return (0.0 if found == 0 else solve(found - 1, 1 - tail)), (1.0 if found == of else solve(found, tail))
