// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/StartState.h"

#include "Engine/Loudspeaker/ArrowResolvent.h"
#include "Engine/Loudspeaker/LawMemory.h"
#include "Engine/Loudspeaker/SmallSignal.h"
#include "Engine/Numerics/Parallel.h"
#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

namespace excursion {
namespace {

using Complex = std::complex<double>;

/// What a line of a section's input has to do with it.
struct Share {
    std::size_t section;  ///< of the record
    Complex weight;       ///< with which the line's response enters the start state
    Complex input;
    std::size_t line;
};

/// The lines of sections in Hz, and what each section has of them. Lines a ten-thousandth of the largest are left out.
std::map<double, std::vector<Share>> linesOf(const Record& record, const std::vector<std::size_t>& sections,
                                             std::size_t leadIn)
{
    std::map<double, std::vector<Share>> lines;
    for (const auto s : sections) {
        const auto& section = record.sections[s];
        if (!section.periodic)
            continue;
        const auto U = fft(section.input);
        const std::size_t N = section.input.size(), begin = record.driveBegin(section, leadIn);
        double largest = 0.0;
        for (const auto& line : U)
            largest = std::max(largest, std::abs(line));
        for (std::size_t k = 0; k < U.size(); ++k) {
            if (std::abs(U[k]) <= 1e-4 * largest)
                continue;
            const double sides = k == 0 || 2 * k == N ? 1.0 : 2.0;
            const double turn = static_cast<double>(k * begin % N) / static_cast<double>(N);
            lines[record.frequency(section, k)].push_back(
                {s, U[k] * std::polar(sides / static_cast<double>(N), 2.0 * std::numbers::pi * turn), U[k], k});
        }
    }
    return lines;
}

/// Puts the memories of the laws where the sections have brought them.
/// @param spectra  [section of the record][i, x or v], of the linear part; empty where that is not known
void startMemories(const Model& model, const Record& record, const std::vector<std::size_t>& sections,
                   std::size_t leadIn, bool withGradient, unsigned threads,
                   const std::vector<std::array<std::vector<Complex>, 3>>& spectra, std::vector<StartState>& states)
{
    // What was measured is nearer to the truth than what the linear part would do.
    const auto current = record.channelIndex(Quantity::current);
    std::vector<PeriodicMotion> motions(record.sections.size());
    inParallel(motions.size(), threads, {}, [&](std::size_t s) {
        const auto& section = record.sections[s];
        const auto played = [&](const std::vector<Complex>& lines) {
            return lines.empty() ? std::vector<double>(section.window, 0.0) : inverseFft(lines, section.window);
        };
        motions[s] = {
            played(current && *current < section.measured.size() ? section.measured[*current] : spectra[s][0]),
            played(spectra[s][1]), played(spectra[s][2])};
        return true;
    });
    std::vector<double> run;  // s, to the middle of the window from where what is slow begins to move
    for (const auto& section : record.sections)
        run.push_back((static_cast<double>(section.periodic ? 0 : section.input.size() - section.window)
                       + 0.5 * static_cast<double>(section.window))
                      / record.sampleRate);
    Eigen::Index place = 3, parameter = 0;
    for (const auto& component : model.components) {
        const Eigen::Index size = component.effect->memorySize(component.operatingRange);
        const auto count = static_cast<Eigen::Index>(component.parameters.size());
        if (size > 0 && !component.effect->linear()) {
            std::vector<MemoryStart> histories;
            if (component.effect->slow())
                histories = historyOf(component, record, motions, run, withGradient);
            inParallel(sections.size(), threads, {}, [&](std::size_t s) {
                const auto& section = record.sections[sections[s]];
                auto& state = states[s];
                if (state.value.size() == 0)
                    return true;
                const auto start = component.effect->slow() ? histories[sections[s]]
                                   : section.periodic
                                       ? settledMemory(component, motions[sections[s]],
                                                       record.driveBegin(section, leadIn), record.sampleRate)
                                       : MemoryStart {Eigen::VectorXd::Zero(size), Eigen::MatrixXd::Zero(size, count)};
                state.value.segment(place, size) = start.value;
                if (withGradient)
                    state.gradient.block(place, parameter, size, count) = start.gradient;
                return true;
            });
        }
        place += size;
        parameter += count;
    }
}

}  // namespace

std::vector<StartState> startStates(const Model& model, const Record& record, const std::vector<std::size_t>& sections,
                                    std::size_t leadIn, bool withGradient, unsigned threads)
{
    std::vector<StartState> states(sections.size());
    bool remembers = false, slow = false;  // a law
    for (const auto& component : model.components)
        if (!component.effect->linear() && component.effect->memorySize(component.operatingRange) > 0) {
            remembers = true;
            slow = slow || component.effect->slow();
        }
    // What a slow memory knows of the sections before is their current; where that is not measured, the linear part's.
    std::vector<std::size_t> heard = sections;
    if (slow && !record.channelIndex(Quantity::current)) {
        heard.resize(record.sections.size());
        std::iota(heard.begin(), heard.end(), std::size_t {0});
    }
    std::vector<std::size_t> places(record.sections.size(), states.size());
    for (std::size_t s = 0; s < sections.size(); ++s)
        places[sections[s]] = s;
    auto linear = smallSignal(model, withGradient);
    const auto n = linear.A.rows();
    // Nothing drives the current of a driver without a coil, nor here the memory of a law: at 0 Hz nothing should
    // divide by them.
    for (Eigen::Index k = 0; k < n; ++k)
        if (linear.A.row(k).isZero(0.0))
            linear.A(k, k) = -1.0;
    const auto P = static_cast<Eigen::Index>(linear.dA.size());
    for (std::size_t s = 0; s < sections.size(); ++s)
        if (record.sections[sections[s]].periodic || slow) {
            states[s].value = Eigen::VectorXd::Zero(n);
            if (withGradient)
                states[s].gradient = Eigen::MatrixXd::Zero(n, P);
        }
    std::vector<std::array<std::vector<Complex>, 3>> spectra(remembers ? record.sections.size() : 0);
    if (remembers)
        for (const auto s : heard)
            if (const auto& section = record.sections[s]; section.periodic)
                spectra[s].fill(std::vector<Complex>(section.window / 2 + 1, 0.0));
    ArrowResolvent resolvent(linear.A);
    const Eigen::VectorXcd B = resolvent.turnedRight(linear.B.cast<Complex>());
    Eigen::MatrixXcd gradient(n, P);
    for (const auto& [frequency, shares] : linesOf(record, heard, leadIn)) {
        resolvent.moveTo(Complex(0.0, 2.0 * std::numbers::pi * frequency));
        const Eigen::VectorXcd z = resolvent.column(B);
        for (Eigen::Index p = 0; p < P; ++p)
            gradient.col(p) = resolvent.column(resolvent.turnedRight(linear.dA[static_cast<std::size_t>(p)] * z
                                                                     + linear.dB[static_cast<std::size_t>(p)]));
        for (const auto& share : shares) {
            if (remembers)
                for (std::size_t q = 0; q < 3; ++q)
                    spectra[share.section][q][share.line] = share.input * z[static_cast<Eigen::Index>(q)];
            const auto s = places[share.section];
            if (s == states.size())
                continue;
            states[s].value += (share.weight * z).real();
            if (withGradient)
                states[s].gradient += (share.weight * gradient).real();
        }
    }
    if (remembers)
        startMemories(model, record, sections, leadIn, withGradient, threads, spectra, states);
    return states;
}

}  // namespace excursion
