# SPDX-License-Identifier: GPL-3.0-or-later
"""A take reduced to what all rivals see: per equation the part of target and columns that the
base columns cannot explain, rotated by a QR decomposition to a few dozen rows. Least squares,
ridges and their sums of squares are the same as on all lines of all sections."""

from dataclasses import dataclass

import numpy as np

from columns import equations
from motion import level_power, measure
from operators import resonators
from poles import QUALITIES, Grid, tune_all

FLOOR_DB = -60.0  # of the level's power: what a model's form may miss
TOP = 1.25  # of the band's upper edge: the highest line
SHOWN = 1e-7  # of its columns' size: a group's smallest direction


@dataclass
class Part:
    """One equation: target and orthonormal columns by effect, without the base's part."""

    name: str
    target: np.ndarray
    groups: dict
    rows: int  # real rows before the reduction


@dataclass
class Problem:
    parts: list

    def effects(self):
        return sorted({e for part in self.parts for e in part.groups})


def weights(equation, take, floor_db):
    """By the sensors' noise and by the level's rms, on the lines that count, and these."""
    used = (take.frequency > 0) & (take.frequency <= min(TOP * take.band[1], 0.42 * take.rate))
    inside = (take.frequency >= take.band[0]) & (take.frequency <= take.band[1])
    floor = level_power(take, equation.target, inside) * 10.0 ** (floor_db / 10.0)
    return 1.0 / np.sqrt(equation.noise + floor)[:, used], used


def triangle(stack, weight, used):
    rows = [(c[:, used] * weight).ravel() for c in stack]
    matrix = np.array([np.r_[r.real, r.imag] for r in rows]).T
    return np.linalg.qr(matrix, mode="r"), len(matrix)


def orthonormal(columns):
    sizes = np.linalg.norm(columns, axis=0)
    directions, sizes, _ = np.linalg.svd(columns / np.where(sizes > 0.0, sizes, 1.0),
                                         full_matrices=False)
    return directions[:, sizes > SHOWN]


def reduce(equation, take, floor_db=FLOOR_DB):
    weight, used = weights(equation, take, floor_db)
    s = 2j * np.pi * take.frequency
    blocks = dict(equation.groups)
    for effect, (signal, frequencies, _) in equation.resonances.items():
        blocks[effect] = [h * signal for h in resonators(s, frequencies, QUALITIES)]
    stack = [*equation.base, *(c for block in blocks.values() for c in block), equation.target]
    full, rows = triangle(stack, weight, used)
    left, target = full[len(equation.base):], full[len(equation.base):, -1]
    place, groups, grids = len(equation.base), {}, {}
    for effect, block in blocks.items():
        mine = left[:, place:place + len(block)]
        place += len(block)
        if effect not in equation.resonances:
            groups[effect] = orthonormal(mine)
            continue
        signal, frequencies, _ = equation.resonances[effect]
        size = np.sqrt((np.abs(signal[:, used] * weight) ** 2).sum(axis=0))
        grids[effect] = Grid(mine, s[used], size, frequencies)
    if grids:
        poles = {effect: resonance[2] for effect, resonance in equation.resonances.items()}
        others = np.hstack(list(groups.values()))
        tuned = tune_all(grids, target, others, poles)
        groups.update((effect, orthonormal(columns)) for effect, columns in tuned.items())
    return Part(equation.name, target, {e: c for e, c in groups.items() if c.shape[1]}, rows)


def make_problem(take, floor_db=FLOOR_DB):
    """None if the take shows no motion."""
    states = measure(take)
    if states is None:
        return None
    return Problem([reduce(e, take, floor_db) for e in equations(states)])
