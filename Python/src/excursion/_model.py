# SPDX-License-Identifier: GPL-3.0-or-later
"""The physical model of a loudspeaker."""

from __future__ import annotations

import os
from typing import Any

import pandas as pd

from ._document import number, numbers, read_json, require_format, table, write_json
from ._errors import Error
from ._take import Samples

FORMAT = "excursion-model"

_BASE = {"Re": "ohm", "Le": "H", "Bl": "N/A", "m": "kg", "Rms": "N s/m", "K": "N/m"}


class Law:
    """A parameter of the base that an effect bends, such as Bl(x), over the range that the take visited."""

    def __init__(self, found: dict[str, Any]) -> None:
        self.effect: str = found["effect"]  #: id of the effect
        self.name: str = found["name"]  #: such as "K(x)"
        self.unit: str = found["unit"]  #: of ``value``
        self.argument: str = found["argument"]  #: x, v or i
        self.argument_unit: str = found["argumentUnit"]  #: of ``at``
        self.at: Samples = numbers(found["at"])
        self.value: Samples = numbers(found["value"])
        #: Hz at which the law is told, beside what relaxes; 0 where it holds at any
        self.frequency: float = found.get("frequency", 0.0)
        self.half_width: Samples = numbers(found.get("halfWidth95"))  #: of the 95 % band; NaN where it is not known

    def __repr__(self) -> str:
        return f"<excursion.Law: {self.name} in {self.unit}>"

    def table(self) -> pd.DataFrame:
        """``value`` and ``half_width`` over the argument, in SI units."""
        return pd.DataFrame(
            {"value": self.value, "half_width": self.half_width}, index=pd.Index(self.at, name=self.argument)
        )


class Model:
    """A loudspeaker: the linear base, the effects that were put in, and the path to the microphone.

    ``model["Bl"]`` is the value of a parameter in its SI unit: of the base, of the path (Sd, tau), or of an effect as
    ``model["stiffness", "c1"]``. ``document`` is the model.json, as Docs/Formats.md describes it.
    """

    def __init__(self, document: dict[str, Any]) -> None:
        require_format(document, FORMAT, "The model")
        self.document = document

    @staticmethod
    def read(path: str | os.PathLike[str]) -> Model:
        """A model.json that was kept."""
        document = read_json(os.fspath(path))
        require_format(document, FORMAT, f"'{os.fspath(path)}'")
        return Model(document)

    @staticmethod
    def linear(
        *,
        m: float,
        Rms: float,
        K: float,
        Re: float | None = None,
        Le: float | None = None,
        Bl: float | None = None,
        Sd: float = 0.01,
        microphone_distance: float = 1.0,
        name: str = "",
    ) -> Model:
        """A linear loudspeaker of known parameters; without a coil where Re, Le and Bl are left out.

        :param m: moving mass, kg
        :param Rms: mechanical damping, N s/m
        :param K: stiffness, N/m
        :param Re: resistance of the coil, ohm
        :param Le: its inductance, H
        :param Bl: force factor, N/A
        :param Sd: area of the cone, m²; only the pressure depends on it
        :param microphone_distance: m; the pressure is that of a half space, told without its time of flight
        """
        given = {"Re": Re, "Le": Le, "Bl": Bl, "m": m, "Rms": Rms, "K": K}
        coil = [given[key] is not None for key in ("Re", "Le", "Bl")]
        if any(coil) and not all(coil):
            raise Error("Give all of Re, Le and Bl, or none of them.", "usage")
        parameters = [
            {"name": key, "value": float(value), "unit": _BASE[key], "standardError": None, "free": True}
            for key, value in given.items()
            if value is not None
        ]
        path = [("Sd", float(Sd), "m^2"), ("tau", 0.0, "s")]
        return Model(
            {
                "format": FORMAT,
                "version": 1,
                "name": name,
                "base": {"id": "electrodynamic" if all(coil) else "mechanical", "parameters": parameters},
                "effects": [],
                "path": {
                    "parameters": [
                        {"name": key, "value": value, "unit": unit, "standardError": None, "free": False}
                        for key, value, unit in path
                    ],
                    "microphoneDistance": float(microphone_distance),
                },
                "covariance": None,
                "laws": [],
            }
        )

    def write(self, path: str | os.PathLike[str]) -> None:
        """Keeps the model as a JSON file."""
        write_json(self.document, os.fspath(path))

    @property
    def name(self) -> str:
        """Of the driver; may be empty."""
        return str(self.document.get("name", ""))

    @property
    def effects(self) -> list[str]:
        """Ids of the effects, in the order in which they were added."""
        return [effect["id"] for effect in self.document["effects"]]

    def _components(self) -> list[dict[str, Any]]:
        path = {"id": "path", **self.document["path"]}
        return [self.document["base"], *self.document["effects"], path]

    @property
    def parameters(self) -> pd.DataFrame:
        """One row a parameter, over its component (the base, an effect, "path") and its name.

        ``value`` and ``standardError`` are in ``unit``, an SI unit; the standard error is NaN where the take does not
        determine the parameter.
        """
        rows = [
            {"of": component["id"], **parameter}
            for component in self._components()
            for parameter in component["parameters"]
        ]
        return table(rows, ["of", "name"])

    def table(self) -> pd.DataFrame:
        """The parameters."""
        return self.parameters

    def __getitem__(self, name: str | tuple[str, str]) -> float:
        of, key = name if isinstance(name, tuple) else (None, name)
        for component in self._components():
            if of == component["id"] or (of is None and component["id"] not in self.effects):
                for parameter in component["parameters"]:
                    if parameter["name"] == key:
                        return number(parameter["value"])
        raise KeyError(name)

    @property
    def laws(self) -> dict[str, Law]:
        """By their names, such as "Bl(x)"."""
        return {law["name"]: Law(law) for law in self.document.get("laws") or []}

    def __repr__(self) -> str:
        return f"<excursion.Model: {' + '.join([self.document['base']['id'], *self.effects])}>"

    def plot(self, figure: Any = None) -> Any:
        """The laws with their 95 % bands, one axis a law; the matplotlib axes."""
        from ._plots import draw_laws

        return draw_laws(self, figure=figure)
