// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Estimate/Coupling.h"

#include "Engine/Signal/Fft.h"

#include <complex>

namespace excursion {

namespace {

std::complex<double> inverseAt(const Record& record, const Section& section, std::size_t line, double corner)
{
    return {1.0, -corner / record.frequency(section, line)};
}

}  // namespace

void takeOffHighPass(Record& record, std::size_t channel, double corner)
{
    if (corner == 0.0 || !hasPeriods(record))
        return;
    for (auto& section : record.sections) {
        auto& measured = section.measured[channel];
        for (std::size_t k = 1; k < measured.size(); ++k) {
            const auto inverse = inverseAt(record, section, k, corner);
            measured[k] *= inverse;
            for (auto* deviation : {&section.deviation, &section.deviationWithoutDrift})
                if (!deviation->empty())
                    (*deviation)[channel][k] *= std::abs(inverse);
            if (!section.inputNoise.empty())
                section.inputNoise[channel][k] *= inverse;
        }
    }
}

void uncouple(Record& record, double corner)
{
    if (corner == 0.0 || !hasPeriods(record))
        return;
    for (auto& section : record.sections) {
        auto input = fft(section.input);
        for (std::size_t k = 1; k < input.size(); ++k)
            input[k] *= inverseAt(record, section, k, corner);
        section.input = inverseFft(input, section.window);
        for (std::size_t k = 1; k < section.inputVariance.size(); ++k)
            section.inputVariance[k] *= std::norm(inverseAt(record, section, k, corner));
    }
    for (std::size_t c = 0; c < record.channels.size(); ++c)
        takeOffHighPass(record, c, corner);
}

}  // namespace excursion
