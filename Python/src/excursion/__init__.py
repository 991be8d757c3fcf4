# SPDX-License-Identifier: GPL-3.0-or-later
"""Excursion finds out what a loudspeaker model is missing, and linearizes the loudspeaker.

>>> import excursion
>>> take = excursion.Take(48000, voltage=u, current=i, displacement=x)
>>> ladder = excursion.improve(take)
>>> ladder.table()

Each function runs the verb of the same name of the ``excursion`` program and returns an object with arrays and pandas
tables; its ``document`` is the program's JSON document. All numbers are in SI units unless a name says dB or percent.
Trouble is an ``excursion.Error`` with one sentence.
"""

from ._adapt import Adapted, adapt
from ._blackbox import Pnlss, Ranking, pnlss, rank
from ._check import Check, check
from ._comparison import Comparison, ResidualCurve, compare
from ._diagnosis import Diagnosis, diagnose
from ._errors import Error, ExcursionWarning
from ._fit import Added, Fit, add, effects, fit
from ._ladder import Ladder, Rung, improve
from ._linear import (
    Identification,
    MixedImpedance,
    MotorCone,
    Reduction,
    Stabilization,
    identify,
    reduce,
    stabilize,
)
from ._measurement import Plan, Virtual, excite, import_take, virtual
from ._model import Law, Model
from ._program import program, version
from ._response import DetectionLines, Response, bla
from ._simulation import Predistortion, Simulation, predistort, simulate
from ._statespace import StateSpace
from ._take import QUANTITIES, Driver, Excitation, Take
from ._whatif import WhatIf, whatif

__version__ = "0.1.0"

__all__ = [
    "QUANTITIES",
    "Adapted",
    "Added",
    "Check",
    "Comparison",
    "DetectionLines",
    "Diagnosis",
    "Driver",
    "Error",
    "Excitation",
    "ExcursionWarning",
    "Fit",
    "Identification",
    "Ladder",
    "Law",
    "MixedImpedance",
    "Model",
    "MotorCone",
    "Plan",
    "Pnlss",
    "Predistortion",
    "Ranking",
    "Reduction",
    "ResidualCurve",
    "Response",
    "Rung",
    "Simulation",
    "Stabilization",
    "StateSpace",
    "Take",
    "Virtual",
    "WhatIf",
    "adapt",
    "add",
    "bla",
    "check",
    "compare",
    "diagnose",
    "effects",
    "excite",
    "fit",
    "identify",
    "import_take",
    "improve",
    "pnlss",
    "predistort",
    "program",
    "rank",
    "reduce",
    "simulate",
    "stabilize",
    "version",
    "virtual",
    "whatif",
]
