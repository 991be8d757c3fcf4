# SPDX-License-Identifier: GPL-3.0-or-later
"""faded.py HEARD: what a loudspeaker was played last, 32-bit floats at 48 kHz, must have been faded out, not cut
off."""
import array
import sys

heard = array.array("f")
with open(sys.argv[1], "rb") as file:
    heard.frombytes(file.read())
end = len(heard)
while end > 0 and heard[end - 1] == 0.0:
    end -= 1
if end < 10000:
    sys.exit("the loudspeaker has heard nothing")
fade = int(0.03 * 48000)
before = max(abs(x) for x in heard[end - 4 * fade : end - fade])
last = max(abs(x) for x in heard[end - fade // 8 : end])
print(f"it ended at {last / before:.4f} of its level")
if last > 0.05 * before:
    sys.exit("the sound was cut off")
