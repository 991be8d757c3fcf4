// SPDX-License-Identifier: GPL-3.0-or-later
// The driver of the dissertation on the virtual bench, as several tests ask for it.
#pragma once

#include "Bench/Draw.h"

#include <utility>
#include <vector>

namespace excursion {

/// Two seconds at 44.1 kHz over a noise of -70 dB.
/// @param outputs  channels beside the voltage
inline bench::Draw drawSeedDriver(std::vector<bench::HiddenEffect> hidden, std::vector<Quantity> outputs)
{
    bench::DrawOptions options;
    options.driver = "seed";
    options.hidden = std::move(hidden);
    options.noiseDb = -70.0;
    options.sampleRate = 44100.0;
    options.seconds = 2.0;
    options.channels = std::move(outputs);
    options.channels->insert(options.channels->begin(), Quantity::voltage);
    return bench::draw(7, options);
}

inline Measurement seedTake(std::vector<bench::HiddenEffect> hidden,
                            std::vector<Quantity> outputs = {Quantity::current, Quantity::displacement})
{
    const auto drawn = drawSeedDriver(std::move(hidden), std::move(outputs));
    return bench::measure(drawn.speaker, drawn.setup);
}

}  // namespace excursion
