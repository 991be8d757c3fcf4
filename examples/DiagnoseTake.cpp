// SPDX-License-Identifier: GPL-3.0-or-later
// A loudspeaker is measured, a linear model is fitted, and what it lacks is named. The loudspeaker is a virtual one, in
// which a force factor that falls with excursion is hidden; a take of a real one comes from readMeasurement(folder).
#include "Bench/Draw.h"
#include "Engine/Check/PreparedTake.h"
#include "Engine/Diagnosis/Diagnose.h"
#include "Engine/Diagnosis/FitEffects.h"
#include "Engine/Error.h"
#include "Engine/Loudspeaker/Fit.h"

#include <iostream>

using namespace excursion;

int main()
{
    try {
        bench::DrawOptions options;
        options.driver = "seed";  // the woofer of Brunet (2014)
        options.hidden = {{"force-factor", 0.3}};
        options.noiseDb = -70.0;
        options.sampleRate = 44100.0;
        options.seconds = 2.0;
        options.channels = {Quantity::voltage, Quantity::current, Quantity::displacement};
        const auto drawn = bench::draw(7, options);
        const PreparedTake take(bench::measure(drawn.speaker, drawn.setup));

        std::cout << take.report().verdict() << "\n";
        if (!take.report().fitForUse())
            return 1;

        auto record = take.record();
        const Model linear = fitEffects(record, {}, {});
        const auto diagnosis = diagnose(linear, record, compare(linear, record));
        for (const auto& [quantity, error] : diagnosis.error)
            std::cout << name(quantity) << ": error " << error.db << " dB, noise " << error.noiseFloorDb.value_or(0.0)
                      << " dB\n";
        for (const auto& ranked : diagnosis.ranking)
            if (ranked.confidence > 0.01)
                std::cout << 100.0 * ranked.confidence << " % " << ranked.effect << "\n";
        std::cout << name(diagnosis.verdict) << ": " << diagnosis.sentence << "\n";
        return diagnosis.verdict == Verdict::missingEffect && diagnosis.ranking.front().effect == "force-factor" ? 0
                                                                                                                 : 1;
    } catch (const Error& error) {
        std::cerr << error.what() << "\n";
        return error.exitCode();
    }
}
