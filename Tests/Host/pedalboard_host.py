# SPDX-License-Identifier: GPL-3.0-or-later
"""The plugin in pedalboard: rates, blocks of 1 to 8192, mono and stereo, parameters, models without physics, state."""
import sys

import numpy as np
import pedalboard
from state import cubic, with_model


def tone(rate, channels):
    t = np.arange(int(0.4 * rate)) / rate
    one = (0.4 * np.sin(2 * np.pi * 60 * t) * np.minimum(1.0, 20 * t)).astype(np.float32)
    return np.tile(one, (channels, 1))


def load(path):
    return pedalboard.load_plugin(path)


def main(path):
    plugin = load(path)
    names = set(plugin.parameters)
    for expected in ("mode", "volts_at_0_dbfs", "amount", "excursion_limit", "voltage_limit", "output_trim"):
        assert any(name.startswith(expected) for name in names), f"{expected} is not among {sorted(names)}"

    for rate in (44100, 48000, 96000):
        for channels in (1, 2):
            for mode in ("Bypass", "Speaker", "Distortion alone", "Linearize", "Audition"):
                expected = None
                for block in (1, 64, 8192) if mode == "Audition" and rate == 48000 else (512, 8192):
                    one = load(path)
                    one.mode = mode
                    u = tone(rate, channels)
                    y = one.process(u, rate, buffer_size=block)
                    what = f"{mode} at {rate} Hz, {channels} channels, blocks of {block}"
                    assert y.shape == u.shape, what
                    assert np.all(np.isfinite(y)), what
                    if mode == "Bypass":
                        assert np.max(np.abs(y - u)) < 1e-6, what   # the host takes the reported latency out
                    else:
                        assert np.max(np.abs(y)) > 1e-4, what
                    if expected is not None:
                        assert np.max(np.abs(y - expected)) < 1e-6, what
                    expected = y

    # Where the engine cannot run, the signal goes through.
    for rate in (100, 7999, 1000000):
        one = load(path)
        one.mode = "Audition"
        u = tone(48000, 2)
        assert np.max(np.abs(one.process(u, rate) - u)) < 1e-6, f"{rate} Hz"

    # What is linearized and then played by the modelled speaker has less distortion than the speaker.
    rate = 48000
    u = np.tile((0.4 * np.sin(2 * np.pi * 60 * np.arange(rate) / rate)).astype(np.float32), (2, 1))

    def harmonics(mode):
        one = load(path)
        one.mode = mode
        spectrum = np.abs(np.fft.rfft(one.process(u, rate)[0][rate // 2:].astype(float)))   # 2 Hz a line
        return 20 * np.log10(np.linalg.norm(spectrum[[60, 90, 120, 150]]) / spectrum[30])

    before, after = harmonics("Speaker"), harmonics("Audition")
    print(f"harmonics of 60 Hz: speaker {before:.1f} dB, linearized {after:.1f} dB")
    assert before > -50 and after < before - 40, "linearization is not heard"

    # A model without physics, which arrives with a session: later than a driver, and the host takes that out as well.
    def polynomial(mode, volts=4.0):
        one = load(path)
        one.mode = mode
        one.raw_state = with_model(one.raw_state, cubic())
        one.volts_at_0_dbfs = volts
        one.excursion_limit = 400.0   # %: by itself it goes no farther than its stimulus did
        # Its latency depends on the rate, and this host takes out what it was told before it prepares: at 44100 Hz.
        one.process(np.zeros((2, 4800), np.float32), rate)
        assert str(one.mode) == mode
        return one

    noise = np.random.default_rng(5).uniform(-0.5, 0.5, (2, rate)).astype(np.float32)
    bypassed = polynomial("Bypass")
    for block in (64, 8192):
        y = bypassed.process(noise, rate, buffer_size=block)
        assert y.shape == noise.shape and np.array_equal(y, noise), "a model without physics bypassed"

    def third(mode):
        one = polynomial(mode)
        spectrum = np.abs(np.fft.rfft(one.process(u, rate)[0][rate // 2:].astype(float)))
        return 20 * np.log10(np.linalg.norm(spectrum[[60, 90, 120, 150]]) / spectrum[30])

    before, after = third("Speaker"), third("Audition")
    print(f"the same of a polynomial model: speaker {before:.1f} dB, linearized {after:.1f} dB")
    assert before > -50 and after < before - 25, "linearization of a polynomial model is not heard"
    session = polynomial("Audition")
    again = load(path)
    again.raw_state = session.raw_state
    assert again.raw_state == session.raw_state

    # State: the same bytes twice, and again after it has been restored.
    plugin.mode = "Audition"
    state = plugin.raw_state
    assert plugin.raw_state == state
    other = load(path)
    other.raw_state = state
    assert other.raw_state == state
    assert str(other.mode) == "Audition"

    # Whatever numbers were sent, the host shows the same ones when their state has been restored.
    draw = np.random.default_rng(0x444)

    def sent():
        for one in plugin.parameters.values():
            one.raw_value = draw.random()

    for _ in range(20):
        sent()
        plugin.process(np.zeros((2, 480), np.float32), rate, reset=False)
        state, shown = plugin.raw_state, [one.raw_value for one in plugin.parameters.values()]
        sent()
        plugin.raw_state = state
        again = [one.raw_value for one in plugin.parameters.values()]
        moved = np.abs(np.subtract(again, shown)[:-1])   # the last is the wrapper's bypass
        assert np.max(moved) < 3e-3, list(zip(plugin.parameters, shown, again))
        assert plugin.raw_state == state
    print("pedalboard: passed")


main(sys.argv[1])
