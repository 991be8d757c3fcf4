// SPDX-License-Identifier: GPL-3.0-or-later
// What share of one core a channel takes that is linearized by a PNLSS model of 4 states and degree 3, in blocks of 64.
// Target: 3 % with a signal at 48 kHz and a model at twice that rate.
#include "BlackBox/RandomModels.h"
#include "CoreShare.h"

#include "Engine/BlackBox/BlackBoxSpeaker.h"

#include <algorithm>
#include <cstdio>
#include <vector>

using namespace excursion;

namespace {

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
        const auto how = "model at " + std::to_string(static_cast<int>(modelRate)) + " Hz";
        BlackBoxPredistorter predistorter(box, rate);
        measureShare("predistorter", predistorter, input, rate, how);
        predistorter.turn(false);
        measureShare("switched off", predistorter, input, rate, how);
        BlackBoxSpeaker speaker(box.box, box.region, box.rest, rate);
        measureShare("speaker", speaker, input, rate, how);
        std::printf("             %.1f dB gain, %d samples late, look ahead %d, %d passes\n", box.rehearsal.gainDb(),
                    predistorter.latency(), box.rehearsal.design.preview, box.rehearsal.design.passes);
    }
}
