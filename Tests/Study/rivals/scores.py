# SPDX-License-Identifier: GPL-3.0-or-later
"""Right and wrong: the effects that stand 6 dB over the noise count, as in the study itself.
Those that are there and do not show are neither right nor wrong when named."""

from collections import Counter
from dataclasses import dataclass, field

SHOWS_DB = 6.0
KIN = {"contact": "stiffness", "hysteresis": "friction"}  # naming it is no mistake


@dataclass
class Score:
    shown: int = 0
    found: int = 0
    false: int = 0
    controls: int = 0
    untouched: int = 0
    shown_of: Counter = field(default_factory=Counter)
    found_of: Counter = field(default_factory=Counter)
    false_of: Counter = field(default_factory=Counter)

    def add(self, truth, named):
        hidden = truth["hidden"]
        there = set(hidden) | {KIN.get(truth.get("oddity"))}
        shows = [e for e, db in zip(hidden, truth["showDb"]) if db >= SHOWS_DB]
        wrong = [e for e in named if e not in there]
        right = [e for e in shows if e in named]
        self.shown_of.update(shows)
        self.found_of.update(right)
        self.false_of.update(wrong)
        self.shown += len(shows)
        self.found += len(right)
        self.false += len(wrong)
        if not hidden and not truth.get("oddity"):
            self.controls += 1
            self.untouched += not named
        return self

    def precision(self):
        return self.found / max(1, self.found + self.false)

    def recall(self):
        return self.found / max(1, self.shown)

    def f1(self):
        parts = self.shown + self.found + self.false
        return 2.0 * self.found / parts if parts else 1.0


def score(truths, named):
    total = Score()
    for truth, names in zip(truths, named):
        total.add(truth, names)
    return total


def best(truths, answers, count):
    """The threshold's place in the grid with the highest F1; the middle one of several."""
    f1 = [score(truths, [a.named[n] for a in answers]).f1() for n in range(count)]
    places = [n for n, value in enumerate(f1) if value >= max(f1) - 1e-12]
    return places[len(places) // 2]


def halves(truths, answers, count):
    """The threshold is chosen on every second take and judged on the others, both ways."""
    total, chosen = Score(), []
    for mine in (0, 1):
        place = best(truths[mine::2], answers[mine::2], count)
        chosen.append(place)
        for truth, answer in zip(truths[1 - mine::2], answers[1 - mine::2]):
            total.add(truth, answer.named[place])
    return total, chosen
