// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Driver/ShownMotions.h"

#include "Engine/Driver/FedLaws.h"
#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <array>
#include <map>

namespace excursion {

bool hasPeriods(const Record& record)
{
    return std::all_of(record.sections.begin(), record.sections.end(), [](const Section& s) { return s.periodic && s.window == s.input.size(); });
}

ShownMotions shownMotions(const Model& model, const Record& record, const std::vector<std::size_t>& sections, const ShownMotions& before)
{
    const std::vector motion {Quantity::current, Quantity::displacement};
    const auto starts = before.empty() ? LawStarts {} : lawStarts(model, record, sections, before, false);
    std::map<std::size_t, Paths> paths;   // by window
    ShownMotions motions;
    for (std::size_t s = 0; s < sections.size(); ++s) {
        const auto& section = record.sections[sections[s]];
        const auto last = record.lineRange(section).second;
        if (!paths.contains(section.window))
            paths[section.window] = pathsOf(model, motion, 0, last, record.sampleRate / static_cast<double>(section.window), false);
        const auto fed = before.empty() ? Fed {{}, {}, fft(section.input), Spectrum(section.window / 2 + 1, 0.0)}
                                        : feed(model, record, section, before[s], starts, s, {});
        std::array<Spectrum, 2> expected;
        for (std::size_t q = 0; q < 2; ++q) {
            expected[q].assign(fed.voltage.size(), 0.0);
            for (std::size_t k = 0; k <= last; ++k)
                expected[q][k] = paths[section.window].fromVoltage[q].value[k] * fed.voltage[k] + paths[section.window].fromForce[q].value[k] * fed.force[k];
            expected[q][0] = expected[q][0].real();
        }
        motions.push_back(shownMotion(record, section, expected[0], expected[1]));
    }
    return motions;
}

ShownMotions settledMotions(const Model& model, const Record& record, const std::vector<std::size_t>& sections)
{
    return shownMotions(model, record, sections, shownMotions(model, record, sections));
}

} // namespace excursion
