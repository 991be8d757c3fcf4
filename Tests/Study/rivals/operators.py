# SPDX-License-Identifier: GPL-3.0-or-later
"""Resonators and hysteresis, as columns on measured motion."""

import numpy as np

REACHES = np.geomspace(0.015, 0.4, 7)  # of the peak displacement, until friction has turned around


def resonators(s, frequencies, qualities=(4.0, 11.0)):
    """Two responses for each pole, so that their sum can also be a pole in between."""
    result = []
    for frequency in frequencies:
        for quality in qualities:
            w = 2.0 * np.pi * frequency
            poles = s ** 2 + s * w / quality + w ** 2
            result += [w ** 2 / poles, s * w / poles]
    return result


def hysteresis(displacement, period, points=16384):
    """Spectra of Dahl's friction force for unit limits: it follows the displacement, with
    sign(v) as its limit, and turns around within a reach that is the same for all levels."""
    count = displacement.shape[1]
    points = min(points, period)
    kept = min(count, points // 2)
    x = np.fft.irfft(displacement[:, :kept], points, axis=1) * points
    reach = REACHES[:, None] * np.abs(x).max()
    step = np.diff(x, axis=1, prepend=x[:, -1:])
    keep = np.exp(-np.abs(step)[None] / reach[..., None])
    toward = np.sign(step) * (1.0 - keep)
    force = np.zeros((len(REACHES), len(x), points))
    state = np.zeros((len(REACHES), len(x)))
    for turn in range(2):  # the first period settles
        for n in range(points):
            state = keep[:, :, n] * state + toward[:, :, n]
            force[:, :, n] = state
    columns = []
    for signals in force:
        column = np.zeros((len(x), count), complex)
        column[:, :kept] = (np.fft.rfft(signals, axis=1) / points)[:, :kept]
        columns.append(column)
    return columns
