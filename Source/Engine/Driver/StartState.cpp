// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Driver/StartState.h"

#include "Engine/Driver/Linearize.h"
#include "Engine/Driver/Resolvent.h"
#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace excursion {
namespace {

using Complex = std::complex<double>;

/// Weight with which a line's response enters the start state of a section.
struct Share {
    std::size_t section;
    Complex weight;
};

/// The lines of all sections in Hz, and what each section has of them. Lines a ten-thousandth of the largest are left out.
std::map<double, std::vector<Share>> linesOf(const Record& record, const std::vector<std::size_t>& sections, std::size_t leadIn)
{
    std::map<double, std::vector<Share>> lines;
    for (std::size_t s = 0; s < sections.size(); ++s) {
        const auto& section = record.sections[sections[s]];
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
                {s, U[k] * std::polar(sides / static_cast<double>(N), 2.0 * std::numbers::pi * turn)});
        }
    }
    return lines;
}

} // namespace

std::vector<StartState> startStates(const Model& model, const Record& record, const std::vector<std::size_t>& sections,
                                    std::size_t leadIn, bool withGradient)
{
    std::vector<StartState> states(sections.size());
    const auto lines = linesOf(record, sections, leadIn);
    if (lines.empty())
        return states;
    auto linear = linearize(model, withGradient);
    if (!model.electrical())
        linear.A(0, 0) = -1.0;   // the current of a driver without a coil: nothing drives it, and at 0 Hz nothing should divide by it
    const auto n = linear.A.rows();
    const auto P = static_cast<Eigen::Index>(linear.dA.size());
    for (std::size_t s = 0; s < sections.size(); ++s)
        if (record.sections[sections[s]].periodic) {
            states[s].value = Eigen::VectorXd::Zero(n);
            if (withGradient)
                states[s].gradient = Eigen::MatrixXd::Zero(n, P);
        }
    const Eigen::VectorXcd B = linear.B.cast<Complex>();
    Eigen::MatrixXcd drives(n, P), gradient;
    Resolvent resolvent(linear.A);
    for (const auto& [frequency, shares] : lines) {
        resolvent.moveTo(Complex(0.0, 2.0 * std::numbers::pi * frequency));
        const Eigen::VectorXcd z = resolvent.times(B);
        for (Eigen::Index p = 0; p < P; ++p)
            drives.col(p).noalias() = linear.dA[static_cast<std::size_t>(p)] * z + linear.dB[static_cast<std::size_t>(p)];
        if (withGradient)
            gradient = resolvent.times(drives);
        for (const auto& share : shares) {
            states[share.section].value += (share.weight * z).real();
            if (withGradient)
                states[share.section].gradient += (share.weight * gradient).real();
        }
    }
    return states;
}

} // namespace excursion
