// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Estimate/Coupling.h"

#include "Engine/Signal/Fft.h"

#include <complex>

namespace excursion {

void uncouple(Record& record, double corner)
{
    if (corner == 0.0 || !hasPeriods(record))
        return;
    for (auto& section : record.sections) {
        const auto inverse = [&](std::size_t k) {
            return std::complex<double>(1.0, -corner / record.frequency(section, k));
        };
        auto input = fft(section.input);
        for (std::size_t k = 1; k < input.size(); ++k)
            input[k] *= inverse(k);
        section.input = inverseFft(input, section.window);
        for (std::size_t k = 1; k < section.inputVariance.size(); ++k)
            section.inputVariance[k] *= std::norm(inverse(k));
        for (auto& channel : section.measured)
            for (std::size_t k = 1; k < channel.size(); ++k)
                channel[k] *= inverse(k);
        for (auto* deviations : {&section.deviation, &section.silentDeviation})
            for (auto& deviation : *deviations)
                for (std::size_t k = 1; k < deviation.size(); ++k)
                    deviation[k] *= std::abs(inverse(k));
    }
}

}  // namespace excursion
