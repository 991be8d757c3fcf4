# SPDX-License-Identifier: GPL-3.0-or-later
"""kept_model.py SETTINGS EFFECT: the model that the app has kept must have that effect and no other, and the stiffness
at rest that was hidden."""
import json
import sys
import xml.etree.ElementTree as ElementTree


def decode(text):
    """JUCE's own base 64: "size.characters", six bits a character, the lowest first."""
    size, characters = text.split(".", 1)
    alphabet = ".ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+"
    bits = 0
    for place, character in enumerate(characters):
        bits |= alphabet.index(character) << (6 * place)
    return bits.to_bytes((6 * len(characters) + 7) // 8, "little")[: int(size)]


settings, effect = sys.argv[1:]
kept = [value.get("val") for value in ElementTree.parse(settings).getroot() if value.get("name") == "filterState"]
if not kept:
    sys.exit("the app has kept no state")
model = json.loads(decode(kept[0]))["model"]
effects = [one["id"] for one in model["effects"]]
stiffness = next(p["value"] for p in model["base"]["parameters"] if p["name"] == "K")
print(f"kept: effects {effects}, K = {stiffness:.1f} N/m (1852 was hidden)")
if effects != [effect] or abs(stiffness / 1852 - 1) > 0.03:
    sys.exit("that is not what was hidden")
