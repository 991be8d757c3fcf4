// SPDX-License-Identifier: GPL-3.0-or-later
// What share of one core a channel takes that is linearized by a PNLSS model of 4 states and degree 3, in blocks of 64.
// Target: 3 % with a signal at 48 kHz and a model at twice that rate.
#include "BlackBox/RandomModels.h"

#include "Engine/BlackBox/BlackBoxSpeaker.h"

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <vector>

using namespace excursion;

namespace {

double coreSeconds()
{
    timespec time {};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// The least of many stretches of a tenth of a second: others who use the machine make it larger, never smaller.
template <class Engine>
void measureShare(const char* name, Engine& engine, const std::vector<double>& input, double rate, double modelRate)
{
    constexpr std::size_t block = 64;
    const auto stretch = static_cast<std::size_t>(0.1 * rate) / block * block;
    std::vector<double> out(block), shares;
    for (std::size_t n = 0; n + stretch <= input.size(); n += stretch) {
        const double start = coreSeconds();
        for (std::size_t k = 0; k < stretch; k += block)
            engine.process(input.data() + n + k, out.data(), block);
        shares.push_back(100.0 * (coreSeconds() - start) / (static_cast<double>(stretch) / rate));
    }
    std::sort(shares.begin(), shares.end());
    std::printf("%-12s %5.1f kHz, model at %5.1f kHz: %.2f %% of a core (median %.2f %%), %.0f x real time\n", name,
                1e-3 * rate, 1e-3 * modelRate, shares.front(), shares[shares.size() / 2], 100.0 / shares.front());
}

/// Four states: the random loudspeaker, and a slow pole beside it that the nonlinearity moves, too.
Pnlss fourStates(double rate, const Stimulus& stimulus)
{
    const auto three = randomPnlss(1, rate, stimulus);
    StateSpace linear = three.linear;
    linear.A = Eigen::MatrixXd::Zero(4, 4);
    linear.A.topLeftCorner(3, 3) = three.linear.A;
    linear.A(3, 3) = std::exp(-2.0 * std::numbers::pi * 5.0 / rate);
    linear.A(3, 2) = 1.0 - linear.A(3, 3);
    linear.B = Eigen::MatrixXd::Zero(4, 1);
    linear.B.topRows(3) = three.linear.B;
    linear.C = Eigen::MatrixXd::Zero(1, 4);
    linear.C.leftCols(3) = three.linear.C;
    auto model = withTerms(linear, 3);
    for (Eigen::Index k = 0; k < model.terms(); ++k)
        for (Eigen::Index j = 0; j < three.terms(); ++j)
            if (model.exponents(k, 3) == 0 && model.exponents.row(k).head(3) == three.exponents.row(j).head(3)
                && model.exponents(k, 4) == three.exponents(j, 3))
                model.E.col(k).head(3) = three.E.col(j);
    // No row is without terms of its own, as of a fit.
    model.E.row(3) = 1e-3 * model.E.row(1);
    model.E.row(0) = 1e-4 * model.E.row(1);
    model.E(2, 0) = 1e-6 * model.E.row(1).cwiseAbs().maxCoeff();
    return model;
}

}  // namespace

int main()
{
    for (const auto& [rate, modelRate] :
         {std::pair {48000.0, 48000.0}, {48000.0, 96000.0}, {96000.0, 96000.0}, {44100.0, 48000.0}}) {
        const auto stimulus = pinkStimulus(2.0);
        const RehearsedBox box(boxOf(fourStates(modelRate, stimulus), stimulus));
        auto input = playedAs(stimulus, rate, 1 << 18, 5);
        BlackBoxPredistorter predistorter(box, rate);
        measureShare("predistorter", predistorter, input, rate, modelRate);
        predistorter.turn(false);
        measureShare("switched off", predistorter, input, rate, modelRate);
        BlackBoxSpeaker speaker(box.box, box.region, box.rest, rate);
        measureShare("speaker", speaker, input, rate, modelRate);
        std::printf("             %.1f dB gain, %d samples late, look ahead %d, %d passes\n", box.rehearsal.gainDb(),
                    predistorter.latency(), box.rehearsal.design.preview, box.rehearsal.design.passes);
    }
}
