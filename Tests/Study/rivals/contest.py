# SPDX-License-Identifier: GPL-3.0-or-later
"""The rivals, and what each names in a take for every threshold that is tried."""

import time
from dataclasses import dataclass, field

import numpy as np

import bayes
import selection
import sparse

COMMON = ("current and a sensor of the motion as states; the columns of every effect, resonances "
          "tuned; which equation is which; the truth, for the threshold")


@dataclass
class Rival:
    name: str
    unit: str  # of the threshold
    told: str  # beside COMMON
    grid: np.ndarray  # thresholds
    textbook: str = ""  # the rule that needs no threshold


RIVALS = {
    "stlsq": Rival("PySINDy STLSQ", "of noise and floor, rms",
                   "one threshold for a column's contribution", np.geomspace(0.003, 30.0, 49)),
    "sr3": Rival("PySINDy SR3", "of noise and floor, rms",
                 "one threshold for a column's contribution", np.geomspace(0.003, 30.0, 49)),
    "slab": Rival("spike and slab", "log odds", "a prior of one half, one threshold",
                  np.r_[0.0, np.geomspace(1.0, 1e5, 61)], "probability > 0.5"),
    "forward": Rival("forward selection", "dB", "one threshold for the gain",
                     np.geomspace(0.003, 30.0, 61), "BIC"),
    "leave": Rival("leave one out", "dB", "one threshold for the cost",
                   np.geomspace(0.003, 30.0, 61)),
}


@dataclass
class Answer:
    """What a rival names: for each threshold, and by the textbook's rule."""

    named: list
    textbook: object = None
    seconds: float = 0.0  # for one threshold
    scores: dict = field(default_factory=dict)


def swept(make):
    def answer(problem, grid):
        begin = time.perf_counter()
        named = [sparse.survivors(problem, make, threshold) for threshold in grid]
        return Answer(named, seconds=(time.perf_counter() - begin) / len(grid))
    return answer


def by_slab(problem, grid):
    begin = time.perf_counter()
    probability, odds = bayes.inclusion(problem)
    named = [{e for e, value in odds.items() if value > t} for t in grid]
    sure = {e for e, value in probability.items() if value > 0.5}
    return Answer(named, sure, time.perf_counter() - begin, odds)


def by_forward(problem, grid):
    begin = time.perf_counter()
    path, first = selection.forward(problem)
    named = [selection.forward_by_gain(path, t) for t in grid]
    return Answer(named, selection.forward_by_bic(path, first), time.perf_counter() - begin,
                  {e: gain for e, gain, _ in path})


def by_leaving(problem, grid):
    begin = time.perf_counter()
    cost = selection.leave_one_out(problem)
    named = [{e for e, value in cost.items() if value > t} for t in grid]
    return Answer(named, None, time.perf_counter() - begin, cost)


ASK = {"slab": by_slab, "forward": by_forward, "leave": by_leaving}
if sparse.available():
    ASK.update(stlsq=swept(sparse.stlsq), sr3=swept(sparse.sr3))


def present():
    return [key for key in RIVALS if key in ASK]


def answers(problem):
    """By rival; a take without a sensor of the motion leaves them nothing to say."""
    result = {}
    for key in present():
        grid = RIVALS[key].grid
        if problem is None:
            result[key] = Answer([set() for _ in grid], set())
        else:
            result[key] = ASK[key](problem, grid)
    return result
