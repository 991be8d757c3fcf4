# SPDX-License-Identifier: GPL-3.0-or-later
"""The plugin in dawdreamer: rendered, automated, saved and restored."""
import os
import sys
import tempfile

import dawdreamer
import numpy as np


def main(path):
    for rate in (44100, 48000, 96000):
        for block in (1, 128, 8192):
            engine = dawdreamer.RenderEngine(rate, block)
            t = np.arange(rate) / rate
            u = np.tile((0.4 * np.sin(2 * np.pi * 60 * t)).astype(np.float32), (2, 1))
            playback = engine.make_playback_processor("in", u)
            plugin = engine.make_plugin_processor("excursion", path)
            titles = [p["name"] for p in plugin.get_parameters_description()]
            mode, trim = titles.index("Mode"), titles.index("Output trim")
            plugin.set_parameter(mode, 1.0)   # audition, the last
            if block > 1:
                assert plugin.set_automation(trim, np.linspace(0.2, 0.8, rate).astype(np.float32), ppqn=0)
            engine.load_graph([(playback, []), (plugin, ["in"])])
            engine.render(0.5)
            y = engine.get_audio()
            what = f"{rate} Hz, blocks of {block}"
            assert np.all(np.isfinite(y)), what
            assert np.max(np.abs(y)) > 1e-5, what
            if block == 128 and rate == 48000:
                quiet, loud = np.std(y[0][2000:6000]), np.std(y[0][-4000:])
                assert loud > 2 * quiet, f"the automated trim is not heard: {quiet} to {loud}"
                with tempfile.TemporaryDirectory() as folder:
                    saved = [os.path.join(folder, name) for name in ("a", "b")]
                    plugin.save_state(saved[0])
                    fresh = engine.make_plugin_processor("other", path)
                    fresh.load_state(saved[0])
                    fresh.save_state(saved[1])
                    assert open(saved[0], "rb").read() == open(saved[1], "rb").read()
    print("dawdreamer: passed")


main(sys.argv[1])
