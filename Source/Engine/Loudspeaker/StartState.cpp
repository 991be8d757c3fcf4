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

/// A parameter that moves the linear part: dA and dB by it, in the form that ArrowResolvent::columns() needs.
struct Mover {
    Eigen::Index parameter;
    struct Entry {
        Eigen::Index row, from;  ///< `from` in the order of the states
        double value;
    };
    std::vector<Entry> byState;
    Eigen::VectorXcd byInput;
};

std::vector<Mover> moversOf(const SmallSignal& linear, const ArrowResolvent& resolvent)
{
    std::vector<Mover> movers;
    for (std::size_t p = 0; p < linear.dA.size(); ++p) {
        if (linear.dA[p].isZero(0.0) && linear.dB[p].isZero(0.0))
            continue;
        Mover mover {static_cast<Eigen::Index>(p), {}, resolvent.turnedRight(linear.dB[p].cast<Complex>())};
        for (Eigen::Index from = 0; from < linear.dA[p].cols(); ++from) {
            const auto column = resolvent.turnedRight(linear.dA[p].col(from).cast<Complex>());
            for (Eigen::Index row = 0; row < column.size(); ++row)
                if (column[row] != 0.0)
                    mover.byState.push_back({row, from, column[row].real()});
        }
        movers.push_back(std::move(mover));
    }
    return movers;
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
    const ArrowResolvent atRest(linear.A);
    const Eigen::VectorXcd B = atRest.turnedRight(linear.B.cast<Complex>());
    const auto movers = moversOf(linear, atRest);
    // Sums of as many parts as there are never more threads, so that the result does not depend on their number.
    constexpr std::size_t parts = 8;
    const auto lines = linesOf(record, heard, leadIn);
    std::vector<const std::pair<const double, std::vector<Share>>*> inOrder;
    for (const auto& line : lines)
        inOrder.push_back(&line);
    std::vector<std::vector<StartState>> sums(parts, std::vector<StartState>(states.size()));
    inParallel(parts, threads, {}, [&](std::size_t part) {
        auto& own = sums[part];
        for (std::size_t s = 0; s < own.size(); ++s)
            if (states[s].value.size() > 0) {
                own[s].value = Eigen::VectorXd::Zero(n);
                if (withGradient)
                    own[s].gradient = Eigen::MatrixXd::Zero(n, static_cast<Eigen::Index>(movers.size()));
            }
        auto resolvent = atRest;
        Eigen::MatrixXcd right(n, static_cast<Eigen::Index>(movers.size())), gradient;
        for (std::size_t k = inOrder.size() * part / parts; k < inOrder.size() * (part + 1) / parts; ++k) {
            const auto& [frequency, shares] = *inOrder[k];
            resolvent.moveTo(Complex(0.0, 2.0 * std::numbers::pi * frequency));
            const Eigen::VectorXcd z = resolvent.column(B);
            if (withGradient) {
                for (std::size_t p = 0; p < movers.size(); ++p) {
                    auto column = right.col(static_cast<Eigen::Index>(p));
                    column = movers[p].byInput;
                    for (const auto& [row, from, value] : movers[p].byState)
                        column[row] += value * z[from];
                }
                gradient = resolvent.columns(right);
            }
            for (const auto& share : shares) {
                if (remembers)
                    for (std::size_t q = 0; q < 3; ++q)
                        spectra[share.section][q][share.line] = share.input * z[static_cast<Eigen::Index>(q)];
                const auto s = places[share.section];
                if (s == own.size())
                    continue;
                own[s].value += (share.weight * z).real();
                if (withGradient)
                    own[s].gradient += share.weight.real() * gradient.real() - share.weight.imag() * gradient.imag();
            }
        }
        return true;
    });
    for (const auto& own : sums)
        for (std::size_t s = 0; s < own.size(); ++s)
            if (own[s].value.size() > 0) {
                states[s].value += own[s].value;
                if (withGradient)
                    for (std::size_t p = 0; p < movers.size(); ++p)
                        states[s].gradient.col(movers[p].parameter) += own[s].gradient.col(
                            static_cast<Eigen::Index>(p));
            }
    if (remembers)
        startMemories(model, record, sections, leadIn, withGradient, threads, spectra, states);
    return states;
}

}  // namespace excursion
