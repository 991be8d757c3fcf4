# SPDX-License-Identifier: GPL-3.0-or-later
"""The plugin's own state within that of a VST3 as JUCE's hosts keep it: an XML with bytes in an alphabet of 64."""
import json
import struct

ALPHABET = ".ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+"
BEGIN, END = b"<IComponent>", b"</IComponent>"


def _decoded(text):
    size, coded = text.split(".", 1)
    bits = sum(ALPHABET.index(letter) << (6 * k) for k, letter in enumerate(coded))
    return (bits & ((1 << (8 * int(size))) - 1)).to_bytes(int(size), "little")


def _encoded(data):
    bits, count = int.from_bytes(data, "little"), (8 * len(data) + 5) // 6
    return f"{len(data)}." + "".join(ALPHABET[(bits >> (6 * k)) & 63] for k in range(count))


def with_model(raw, model):
    """The state with another model in it."""
    begin, end = raw.index(BEGIN) + len(BEGIN), raw.index(END)
    component = _decoded(raw[begin:end].decode())
    document, length = json.JSONDecoder().raw_decode(component.decode("latin-1"))
    document["model"] = model
    xml = raw[8:begin] + _encoded(json.dumps(document).encode() + component[length:]).encode() + raw[end:]
    return raw[:4] + struct.pack("<I", len(xml.rstrip(b"\0"))) + xml


def cubic(rate=48000.0):
    """A resonance at 60 Hz whose stiffness rises with the square of the displacement, a polynomial state space."""
    import math

    h, w, cube = 1.0 / rate, 2 * math.pi * 60.0, 2e5
    bands = [1000.0 * 2 ** (k / 3) for k in range(-17, 4)]
    linear = {
        "format": "excursion-state-space", "version": 1, "name": "cubic", "sampleRate": rate, "order": 2,
        "inputs": ["voltage"], "outputs": ["displacement"],
        "A": [[1 - h * h * w * w, h * (1 - h * w)], [-h * w * w, 1 - h * w]],
        "B": [[h * h * w * w * 1e-3], [h * w * w * 1e-3]], "C": [[1.0, 0.0]], "D": [[0.0]],
    }
    return {
        "format": "excursion-pnlss", "version": 1, "name": "cubic", "linear": linear,
        "terms": [{"exponents": [3, 0, 0], "E": [-h * h * w * w * cube, -h * w * w * cube], "F": [0.0],
                   "free": [True, True, False]}],
        "stimulus": {"rms": 1.0, "peak": 4.5, "frequency": bands, "power": [1 / len(bands)] * len(bands)},
    }
