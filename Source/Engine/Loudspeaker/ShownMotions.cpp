// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/ShownMotions.h"

#include "Engine/Loudspeaker/FedLaws.h"
#include "Engine/Numerics/Parallel.h"
#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <array>

namespace excursion {

namespace {

/// shownMotions() by paths that are known.
ShownMotions shownBy(const PathsByWindow& paths, const Model& model, const Record& record,
                     const std::vector<std::size_t>& sections, const ShownMotions& before, unsigned threads)
{
    const auto histories = before.empty() ? LawHistories {} : lawHistories(model, record, sections, before, false);
    ShownMotions motions(sections.size());
    inParallel(sections.size(), threads, {}, [&](std::size_t s) {
        const auto& section = record.sections[sections[s]];
        const auto last = record.lineRange(section).second;
        const auto& path = paths.at(section.window);
        const auto fed = before.empty() ? Fed {{}, {}, fft(section.input), Spectrum(section.window / 2 + 1, 0.0)}
                                        : feed(model, record, section, before[s], histories, s, {});
        std::array<Spectrum, 2> expected;
        for (std::size_t q = 0; q < 2; ++q) {
            expected[q].assign(fed.voltage.size(), 0.0);
            for (std::size_t k = 0; k <= last; ++k)
                expected[q][k] = path.fromVoltage[q].value[k] * fed.voltage[k]
                                 + path.fromForce[q].value[k] * fed.force[k];
            expected[q][0] = expected[q][0].real();
        }
        motions[s] = shownMotion(model, record, section, expected[0], expected[1]);
        return true;
    });
    return motions;
}

}  // namespace

ShownMotions shownMotions(const Model& model, const Record& record, const std::vector<std::size_t>& sections,
                          const ShownMotions& before, unsigned threads)
{
    return shownBy(pathsToMotion(model, record, sections, threads), model, record, sections, before, threads);
}

ShownMotions settledMotions(const Model& model, const Record& record, const std::vector<std::size_t>& sections,
                            unsigned threads)
{
    const auto paths = pathsToMotion(model, record, sections, threads);
    return shownBy(paths, model, record, sections, shownBy(paths, model, record, sections, {}, threads), threads);
}

bool isNear(const ShownMotions& one, const ShownMotions& other)
{
    constexpr double share = 0.01;
    const auto near = [](const std::vector<double>& a, const std::vector<double>& b) {
        double apart = 0.0, size = 0.0;
        for (std::size_t n = 0; n < a.size(); ++n) {
            apart += (a[n] - b[n]) * (a[n] - b[n]);
            size += a[n] * a[n];
        }
        return apart <= share * share * size;
    };
    return std::equal(one.begin(), one.end(), other.begin(), other.end(),
                      [&](const ShownMotion& a, const ShownMotion& b) {
                          return near(a.i, b.i) && near(a.slope, b.slope) && near(a.x, b.x) && near(a.v, b.v);
                      });
}

}  // namespace excursion
