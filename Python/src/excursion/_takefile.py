# SPDX-License-Identifier: GPL-3.0-or-later
"""Takes as folders: measurement.json and a WAV; see Docs/Formats.md."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path
from typing import Any

import numpy as np
import soundfile

from ._document import VERSION, read_json, require_format, write_json
from ._errors import Error
from ._take import QUANTITIES, Driver, Excitation, Samples, Take, unit_of

_FORMAT = "excursion-measurement"
_AUDIO = "take.wav"
_LARGEST_RIFF = 4_000_000_000  # bytes; beyond that a WAV must be an RF64


def full_scale(values: Samples) -> float:
    """A power of two, so that nothing is lost by the division, of which no sample reaches the double."""
    peak = float(np.max(np.abs(values)))
    return float(2.0 ** np.ceil(np.log2(peak))) if peak > 1e-300 else 1.0


def _excitation_json(e: Excitation) -> dict[str, Any]:
    document: dict[str, Any] = {
        "kind": "multisine",
        "period": e.period,
        "settlePeriods": e.settle_periods,
        "periods": e.periods,
        "realizations": e.realizations,
        "levels": list(e.levels),
        "grid": e.grid,
        "shape": e.shape,
    }
    if e.band is not None:
        document["band"] = [float(edge) for edge in e.band]
    if e.lines is not None:
        document["lines"] = list(e.lines)
    return document


def _driver_json(driver: Driver) -> dict[str, Any]:
    named = {
        "name": driver.name or None,
        "coneArea": driver.cone_area,
        "microphoneDistance": driver.microphone_distance,
    }
    return {key: value for key, value in named.items() if value is not None}


def write_take(take: Take, folder: str | os.PathLike[str]) -> None:
    """Writes the WAV first, so that a measurement.json always has one."""
    take.require()
    folder = Path(folder)
    scales = {quantity: full_scale(values) for quantity, values in take.samples.items()}
    document: dict[str, Any] = {
        "format": _FORMAT,
        "version": VERSION,
        "sampleRate": take.rate,
        "audio": _AUDIO,
        "channels": [
            {"quantity": quantity, "unit": take.units[quantity], "fullScale": scales[quantity]}
            for quantity in take.samples
        ],
    }
    if take.excitation is not None:
        document["excitation"] = _excitation_json(take.excitation)
    if described := _driver_json(take.driver):
        document["driver"] = described
    if take.coupling > 0:
        document["coupling"] = take.coupling
    if take.remarks:
        document["remarks"] = list(take.remarks)
    columns = np.stack([values / scales[quantity] for quantity, values in take.samples.items()], axis=1)
    draft = folder / (_AUDIO + ".tmp")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        soundfile.write(
            draft,
            columns,
            max(1, round(take.rate)),
            subtype="DOUBLE",
            format="RF64" if columns.nbytes > _LARGEST_RIFF else "WAV",
        )
        draft.replace(folder / _AUDIO)
    except (OSError, soundfile.LibsndfileError) as trouble:
        with contextlib.suppress(OSError):
            draft.unlink()
        raise Error(f"The take '{folder}' cannot be written ({trouble}).", "input") from trouble
    write_json(document, folder / "measurement.json")


def _read_excitation(found: dict[str, Any] | None) -> Excitation | None:
    if found is None or found["kind"] != "multisine":
        return None
    band, lines = found.get("band"), found.get("lines")
    return Excitation(
        period=found["period"],
        settle_periods=found["settlePeriods"],
        periods=found["periods"],
        realizations=found["realizations"],
        levels=tuple(found["levels"]),
        grid=found.get("grid") or "full",
        shape=found.get("shape") or "white",
        band=(float(band[0]), float(band[1])) if band else None,
        lines=tuple(lines) if lines else None,
    )


def _place(path: Path) -> Path:
    """The JSON of a take that is given by its folder or by that file."""
    if not path.is_dir():
        return path
    for name in ("measurement.json", "plan.json"):
        if (path / name).is_file():
            return path / name
    raise Error(f"The folder '{path}' has no measurement.json.", "input")


def _read_header(document: dict[str, Any], folder: Path) -> tuple[Path, list[tuple[str, str, float]], dict[str, Any]]:
    """The WAV, quantity, unit and factor of each of its channels, and what else a Take is made with."""
    try:
        audio = document["audio"]
        if Path(audio).name != audio:
            raise Error(f"audio is {audio!r}, expected the name of a WAV in the same folder.", "input")
        channels = []
        for channel in document["channels"]:
            quantity = channel["quantity"]
            if quantity not in QUANTITIES:
                raise Error(f"There is no quantity {quantity!r}; the known ones are {', '.join(QUANTITIES)}.", "input")
            unit, factor = unit_of(quantity, channel["unit"])
            channels.append((quantity, unit, factor * float(channel["fullScale"])))
        if len({quantity for quantity, _, _ in channels}) != len(channels):
            raise Error("A quantity is there twice.", "input")
        told = document.get("driver") or {}
        return (
            folder / audio,
            channels,
            {
                "rate": float(document["sampleRate"]),
                "excitation": _read_excitation(document.get("excitation")),
                "driver": Driver(told.get("name") or "", told.get("coneArea"), told.get("microphoneDistance")),
                "coupling": float(document.get("coupling") or 0.0),
                "remarks": tuple(str(remark) for remark in document.get("remarks") or ()),
            },
        )
    except (KeyError, TypeError, ValueError, IndexError, AttributeError) as trouble:
        raise Error(f"It is not a measurement.json: {type(trouble).__name__} at {trouble}.", "input") from trouble


def read_take(path: str | os.PathLike[str]) -> Take:
    place = _place(Path(path))
    document = read_json(place)
    require_format(document, _FORMAT, f"'{place}'")
    try:
        audio, channels, told = _read_header(document, place.parent)
        columns, _ = soundfile.read(audio, dtype="float64", always_2d=True)
        if columns.shape[1] != len(channels):
            raise Error(f"The WAV has {columns.shape[1]} channels, but {len(channels)} are named.", "input")
        samples = {quantity: column * scale for column, (quantity, _, scale) in zip(columns.T, channels)}
        return Take(units={quantity: unit for quantity, unit, _ in channels}, **told, **samples)
    except Error as trouble:
        raise Error(f"'{place}': {trouble}", "input") from trouble
    except (OSError, soundfile.LibsndfileError) as trouble:
        raise Error(f"'{audio}' cannot be read ({trouble}).", "input") from trouble
