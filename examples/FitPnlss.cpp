// SPDX-License-Identifier: GPL-3.0-or-later
// A polynomial state-space model, which knows no physics, learns an oscillator with a hardening spring from two
// records, and predicts a third.
#include "Engine/Linear/Identify.h"
#include "Engine/Polynomial/Pnlss/PnlssFit.h"
#include "Engine/Signal/Fft.h"
#include "Engine/Signal/Multisine.h"

#include <iostream>

using namespace excursion;

// y(t+1) = 1.6 y(t) - 0.8 y(t-1) - 0.05 y(t)^3 + 0.2 u(t), which is no more than a polynomial in two states.
InputOutputRecord play(const std::vector<double>& period)
{
    const auto length = static_cast<Eigen::Index>(period.size());
    Eigen::VectorXd u = Eigen::Map<const Eigen::VectorXd>(period.data(), length).replicate(2, 1),
                    y = Eigen::VectorXd::Zero(2 * length);
    for (Eigen::Index t = 1; t + 1 < 2 * length; ++t)
        y[t + 1] = 1.6 * y[t] - 0.8 * y[t - 1] - 0.05 * y[t] * y[t] * y[t] + 0.2 * u[t];
    return periodicRecord(u.tail(length), y.tail(length), 256);
}

int main()
{
    MultisineOptions signal;
    signal.sampleRate = 1000.0;
    signal.period = 1024;
    signal.bandLow = 1.0;
    signal.bandHigh = 400.0;
    signal.shape = Shape::white;
    signal.rms = 0.8;
    const auto lines = chooseLines(signal);
    std::vector<InputOutputRecord> records;
    for (int realization = 0; realization < 3; ++realization)
        records.push_back(play(multisine(signal, lines, realization)));

    // The best linear model of one record is where the fit begins.
    Frf response;
    const auto spectrumOf = [&](const Eigen::MatrixXd& samples) { return fft({samples.data() + 256, 1024}); };
    const auto U = spectrumOf(records[0].input), Y = spectrumOf(records[0].output);
    for (const int line : lines) {
        response.frequency.push_back(line * signal.sampleRate / signal.period);
        response.value.push_back(Y[static_cast<std::size_t>(line)] / U[static_cast<std::size_t>(line)]);
    }
    IdentifyOptions options;
    options.order = 2;
    options.sampleRate = signal.sampleRate;
    // all monomials of degree 2 and 3
    const auto start = withTerms(identify(frequencyDataOf(response), options).model, 3);

    const std::vector<InputOutputRecord> estimation(records.begin(), records.begin() + 2), validation {records[2]};
    const auto fit = fitPnlss(start, estimation, validation);
    std::cout << "linear model " << relativeErrorDb(start, validation) << " dB, with " << start.terms() << " monomials "
              << fit.validationDb << " dB, on a record that no fit saw; " << fit.iterations << " iterations\n";
    return fit.stable && fit.validationDb < -80.0 ? 0 : 1;
}
