// SPDX-License-Identifier: GPL-3.0-or-later
// What share of one core a channel in real time takes, with every effect of the catalogue, in blocks of 64. Target at
// 48 kHz, oversampling 2: 3 % for the predistorter, which plays what it reckons with (Effect::undone), while no limit
// is at work, 4 % for the speaker, which plays all.
#include "AllEffects.h"
#include "CoreShare.h"

#include "Engine/Predistortion/Predistorter.h"
#include "Engine/Predistortion/Speaker.h"
#include "Engine/Signal/Multisine.h"

#include <algorithm>
#include <cstdio>
#include <vector>

using namespace excursion;

int main()
{
    const auto model = allEffects();
    for (const auto& [sampleRate, oversampling] : {std::pair {48000.0, 1}, {48000.0, 2}, {48000.0, 4}, {96000.0, 2}}) {
        MultisineOptions stimulus;
        stimulus.sampleRate = sampleRate;
        stimulus.period = 1 << 19;
        stimulus.bandLow = 15.0;
        stimulus.bandHigh = 8000.0;
        stimulus.rms = 3.0;
        const auto input = multisine(stimulus, chooseLines(stimulus), 0);
        const auto how = "oversampling " + std::to_string(oversampling);
        Predistorter predistorter(model, {sampleRate, oversampling});
        measureShare("predistorter", predistorter, input, sampleRate, how);
        Predistorter guarded(model, {sampleRate, oversampling}, {1.0, 20e-3, 100.0, 1000.0});
        measureShare("  with limits", guarded, input, sampleRate, how);
        Predistorter limiting(model, {sampleRate, oversampling}, {1.0, 1e-3, 3.0, 0.5});
        measureShare("  limiting", limiting, input, sampleRate, how);
        Speaker speaker(model, {sampleRate, oversampling});
        measureShare("speaker", speaker, input, sampleRate, how);
    }
}
