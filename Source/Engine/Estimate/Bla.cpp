// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Estimate/Bla.h"

#include "Engine/Error.h"
#include "Engine/Estimate/Periods.h"

#include <algorithm>
#include <string>

namespace excursion {
namespace {

using Complex = std::complex<double>;

/// The excited lines of the spectra of all periods of one realization.
struct Realization {
    std::vector<std::vector<Complex>> U, Y;  ///< [period][line number]
    std::vector<Complex> meanU, meanY;
};

void keepLines(std::vector<std::vector<Complex>>& spectra, const std::vector<int>& lines, std::vector<Complex>& mean)
{
    mean.assign(lines.size(), 0.0);
    for (auto& spectrum : spectra) {
        std::vector<Complex> kept;
        for (const int k : lines)
            kept.push_back(spectrum[static_cast<std::size_t>(k)]);
        spectrum = std::move(kept);
        for (std::size_t i = 0; i < lines.size(); ++i)
            mean[i] += spectrum[i] / static_cast<double>(spectra.size());
    }
}

}  // namespace

BlaResult bla(const Measurement& take, Quantity outputQuantity, int level, std::optional<Quantity> inputQuantity)
{
    const Excitation& e = periodicExcitation(take);
    const auto& lines = excitedLines(take);
    if (level < 0 || level >= static_cast<int>(e.levels.size()))
        throw Error(Error::Kind::usage, "The take has levels 0 to " + std::to_string(e.levels.size() - 1) + ", not "
                                            + std::to_string(level) + ".");
    const Channel& input = inputQuantity ? take.channel(*inputQuantity) : take.input();
    const Channel& output = take.channel(outputQuantity);
    const int M = e.realizations, P = e.periods;
    const std::size_t F = lines.size();

    BlaResult result;
    result.output = output.quantity;
    result.input = input.quantity;
    result.level = level;
    result.realizations = M;
    result.periods = P;
    for (const int k : lines)
        result.frf.frequency.push_back(k * take.sampleRate / e.period);

    std::vector<std::vector<Complex>> G;
    std::vector<double> noise(F, 0.0), powerU(F, 0.0), powerY(F, 0.0);
    std::vector<Complex> cross(F, 0.0);
    for (int m = 0; m < M; ++m) {
        Realization r;
        r.U = periodSpectra(take, input, level, m);
        r.Y = periodSpectra(take, output, level, m);
        keepLines(r.U, lines, r.meanU);
        keepLines(r.Y, lines, r.meanY);
        auto& Gm = G.emplace_back(F);
        for (std::size_t i = 0; i < F; ++i) {
            if (std::norm(r.meanU[i]) == 0.0)
                throw Error(Error::Kind::data, "The " + std::string(name(input.quantity))
                                                   + " channel has nothing on line " + std::to_string(lines[i])
                                                   + ", which the excitation says is excited.");
            Gm[i] = r.meanY[i] / r.meanU[i];
            for (int p = 0; p < P; ++p) {
                const Complex U = r.U[static_cast<std::size_t>(p)][i], Y = r.Y[static_cast<std::size_t>(p)][i];
                if (P > 1)
                    noise[i] += std::norm(Y - Gm[i] * U) / (P * (P - 1.0)) / std::norm(r.meanU[i]);
                powerU[i] += std::norm(U);
                powerY[i] += std::norm(Y);
                cross[i] += Y * std::conj(U);
            }
        }
    }

    result.frf.value.assign(F, 0.0);
    for (const auto& Gm : G)
        for (std::size_t i = 0; i < F; ++i)
            result.frf.value[i] += Gm[i] / static_cast<double>(M);
    if (P > 1)
        for (std::size_t i = 0; i < F; ++i)
            result.frf.noiseVariance.push_back(noise[i] / (static_cast<double>(M) * M));
    if (M > 1) {
        result.frf.totalVariance.assign(F, 0.0);
        for (const auto& Gm : G)
            for (std::size_t i = 0; i < F; ++i)
                result.frf.totalVariance[i] += std::norm(Gm[i] - result.frf.value[i]) / (M * (M - 1.0));
    }
    if (P > 1 && M > 1)
        for (std::size_t i = 0; i < F; ++i) {
            result.nonlinearVariance.push_back(
                std::max(result.frf.totalVariance[i] - result.frf.noiseVariance[i], 0.0));
            result.stochasticNonlinear.push_back(M * result.nonlinearVariance.back());
        }
    if (M * P > 1)
        for (std::size_t i = 0; i < F; ++i)
            result.coherence.push_back(powerY[i] > 0.0 ? std::norm(cross[i]) / (powerU[i] * powerY[i]) : 0.0);
    return result;
}

}  // namespace excursion
