// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/FedLaws.h"

#include "Engine/Loudspeaker/SensorResponse.h"
#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

bool isLaw(const Component& component) { return !component.effect->linear(); }

MemoryStart atRest(const Component& law)
{
    const auto size = static_cast<Eigen::Index>(law.effect->memorySize(law.operatingRange));
    return {Eigen::VectorXd::Zero(size), Eigen::MatrixXd::Zero(size, static_cast<Eigen::Index>(law.parameters.size()))};
}

/// Where the memory of a law that is not slow stands a quarter of a period before the window.
MemoryStart startOf(const Component& law, const Section& section, const ShownMotion& motion, double sampleRate)
{
    if (law.effect->memorySize(law.operatingRange) == 0 || forgetsInAQuarter(law, motion, sampleRate))
        return atRest(law);
    return settledMemory(law, everySample(motion), section.window - section.window / 4, sampleRate);
}

/// Where the slow memory of a law stands a quarter of a period before the window of each section.
std::vector<MemoryStart> startsOf(const Component& law, const Record& record, const std::vector<std::size_t>& sections,
                                  const std::vector<ShownMotion>& motions, bool withGradient)
{
    std::vector<MemoryStart> starts(sections.size());
    // Sections that are not asked for have heated the coil all the same: as much as those of the same level, or of the
    // nearest.
    const auto current = record.channelIndex(Quantity::current);
    std::vector<PeriodicMotion> all;
    std::vector<double> run;
    for (const auto& section : record.sections) {
        const auto nearest = std::min_element(sections.begin(), sections.end(), [&](std::size_t a, std::size_t b) {
            const auto distance = [&](std::size_t n) {
                const auto& other = record.sections[n];
                return std::pair(&other == &section ? 0 : 1, std::abs(other.level - section.level));
            };
            return distance(a) < distance(b);
        });
        all.push_back(everySample(motions[static_cast<std::size_t>(nearest - sections.begin())]));
        if (current && std::find(sections.begin(), sections.end(), all.size() - 1) == sections.end())
            all.back().i = inverseFft(section.measured[*current], section.window);
        run.push_back(0.75 * static_cast<double>(section.window) / record.sampleRate);
    }
    const auto histories = historyOf(law, record, all, run, withGradient);
    for (std::size_t s = 0; s < sections.size(); ++s)
        starts[s] = histories[sections[s]];
    return starts;
}

/// Lines from the first to the last, all of them until they are denser than a two-hundredth of an octave.
std::vector<std::size_t> sparseLines(std::size_t first, std::size_t last)
{
    constexpr double step = 1.00347;
    std::vector<std::size_t> lines;
    for (std::size_t k = first; k < last; k = std::max(k + 1, static_cast<std::size_t>(step * static_cast<double>(k))))
        lines.push_back(k);
    lines.push_back(last);
    return lines;
}

/// A value a line, on straight lines between those that are known.
Spectrum between(const Eigen::VectorXcd& known, const std::vector<std::size_t>& lines)
{
    Spectrum all;
    all.reserve(lines.back() - lines.front() + 1);
    for (std::size_t n = 0; n + 1 < lines.size(); ++n) {
        const auto here = known[static_cast<Eigen::Index>(n)], next = known[static_cast<Eigen::Index>(n) + 1];
        const auto count = lines[n + 1] - lines[n];
        const auto step = (next - here) / static_cast<double>(count);
        for (std::size_t k = 0; k < count; ++k)
            all.push_back(here + step * static_cast<double>(k));
    }
    all.push_back(known[known.size() - 1]);
    return all;
}

/// Whether steps along slopes that were taken elsewhere lead as well as along new ones. Slopes by shapes are as large
/// as the law is strong.
/// @param wanted  parameters to differentiate by
bool stillLead(const Component& law, const LawSlopes& slopes, const std::vector<bool>& wanted)
{
    for (std::size_t k = 0; k < wanted.size(); ++k)
        if (wanted[k] && !slopes.wanted[k])
            return false;
    constexpr double hardly = 0.03;
    const auto here = valuesOf(law);
    double strength = 0.0;
    for (std::size_t k = 0; k < law.parameters.size(); ++k)
        if (law.parameters[k].strength)
            strength = std::max(strength, std::abs(slopes.at[k]));
    for (std::size_t k = 0; k < here.size(); ++k) {
        const double was = std::abs(slopes.at[k]);
        double unit = was;
        if (k < law.parameters.size()) {  // else one of its host's
            const auto& p = law.parameters[k];
            if (p.strength)
                unit = strength;
            else if (std::isfinite(p.prior))
                unit = std::min(p.prior, std::max(was, 1.0));
        }
        if (!(std::abs(here[k] - slopes.at[k]) <= hardly * unit))
            return hasConstantSlopes(law);
    }
    return true;
}

}  // namespace

Paths pathsOf(const Model& model, const std::vector<Quantity>& quantities, std::size_t first, std::size_t last,
              double resolution, bool withGradient, unsigned threads)
{
    constexpr double nearlyRest = 1e-3;
    const auto frequencyOf = [&](std::size_t line) {
        return resolution * (line > 0 ? static_cast<double>(line) : nearlyRest);
    };
    const std::vector<Drives> drives {Drives::terminals, Drives::cone};
    std::vector<double> frequency, sparse;
    for (std::size_t k = first; k <= last; ++k)
        frequency.push_back(frequencyOf(k));
    Paths paths {{}, {}, first, smallSignal(model).lateness};
    auto responses = respondToEach(model, quantities, frequency, drives, false, threads);
    const std::vector made {&paths.fromVoltage, &paths.fromForce};  // as the drives
    for (std::size_t d = 0; d < drives.size(); ++d)
        for (auto& response : responses[d])
            made[d]->push_back({std::move(response.value), {}});
    if (!withGradient)
        return paths;
    const auto lines = sparseLines(first, last);  // slopes are dear, and smooth from line to line at high frequencies
    for (const auto k : lines)
        sparse.push_back(frequencyOf(k));
    const auto known = respondToEach(model, quantities, sparse, drives, true, threads);
    for (std::size_t d = 0; d < drives.size(); ++d)
        for (std::size_t q = 0; q < quantities.size(); ++q)
            for (const auto slope : known[d][q].gradient.colwise())
                (*made[d])[q].slopes.push_back(slope.isZero(0.0) ? Spectrum {} : between(slope, lines));
    return paths;
}

namespace {

PathsByWindow pathsByWindow(const Model& model, const Record& record, const std::vector<std::size_t>& sections,
                            const std::vector<Quantity>& quantities, bool fromZero, bool withGradient, unsigned threads)
{
    PathsByWindow paths;
    for (const auto s : sections)
        if (const auto& section = record.sections[s]; !paths.contains(section.window)) {
            const auto [first, last] = record.lineRange(section);
            paths[section.window] = pathsOf(model, quantities, fromZero ? 0 : first, last,
                                            record.sampleRate / static_cast<double>(section.window), withGradient,
                                            threads);
        }
    return paths;
}

}  // namespace

PathsByWindow pathsToChannels(const Model& model, const Record& record, const std::vector<std::size_t>& sections,
                              bool withGradient, unsigned threads)
{
    return pathsByWindow(model, record, sections, record.channels, false, withGradient, threads);
}

PathsByWindow pathsToMotion(const Model& model, const Record& record, const std::vector<std::size_t>& sections,
                            unsigned threads)
{
    return pathsByWindow(withoutSensors(model), record, sections, {Quantity::current, Quantity::displacement}, true,
                         false, threads);
}

LawHistories lawHistories(const Model& model, const Record& record, const std::vector<std::size_t>& sections,
                          const std::vector<ShownMotion>& motions, bool withGradient)
{
    LawHistories histories;
    for (const auto& component : model.components)
        histories.push_back(isLaw(component) && component.effect->slow()
                                ? startsOf(component, record, sections, motions, withGradient)
                                : std::vector<MemoryStart> {});
    return histories;
}

Fed feed(const Model& model, const Record& record, const Section& section, const ShownMotion& motion,
         const LawHistories& histories, std::size_t place, const std::vector<std::vector<bool>>& wanted,
         KnownSlopes* known)
{
    const std::size_t lines = record.lineRange(section).second + 1;
    if (known)
        known->resize(model.components.size());
    Fed fed;
    fed.voltage = fft(section.input);
    fed.force.assign(fed.voltage.size(), 0.0);
    for (std::size_t k = 1; k < model.components.size(); ++k) {
        const auto& law = model.components[k];
        if (!isLaw(law))
            continue;
        const auto start = law.effect->slow() ? histories[k][place] : startOf(law, section, motion, record.sampleRate);
        const bool isKnown = known && (*known)[k] && !wanted.empty() && stillLead(law, *(*known)[k], wanted[k]);
        auto drive = driveOf(law, motion, start, record.sampleRate,
                             wanted.empty() || isKnown ? std::vector<bool> {} : wanted[k], lines);
        if (isKnown)
            drive.slopes = (*known)[k];
        else if (known && drive.slopes)
            (*known)[k] = drive.slopes;
        for (std::size_t n = 0; n < fed.voltage.size(); ++n) {
            if (model.electrical())
                fed.voltage[n] -= drive.voltage[n];
            fed.force[n] += drive.force[n];
        }
        fed.component.push_back(k);
        fed.laws.push_back(std::move(drive));
    }
    return fed;
}

}  // namespace excursion
