// SPDX-License-Identifier: GPL-3.0-or-later
// What models without physics are fitted to and judged by, on a resonance whose exact model is known.
#include "Engine/Polynomial/TakeRecords.h"
#include "Linear/Problem.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace excursion;
using namespace excursion::test;
using std::numbers::pi;

namespace {

/// y(t) = 2 r cos w y(t-1) - r^2 y(t-2) + u(t-1)
struct Resonance {
    double r = 0.0, w = 0.0;

    Eigen::MatrixXd play(const Eigen::MatrixXd& u) const
    {
        Eigen::MatrixXd y = Eigen::MatrixXd::Zero(u.rows(), 1);
        for (Eigen::Index t = 1; t < u.rows(); ++t)
            y(t, 0) = 2.0 * r * std::cos(w) * y(t - 1, 0) - (t > 1 ? r * r * y(t - 2, 0) : 0.0) + u(t - 1, 0);
        return y;
    }

    /// On all records, led in as they are.
    double errorDb(const InputOutputRecords& records) const
    {
        std::vector<Eigen::MatrixXd> outputs;
        for (const auto& record : records.estimation)
            outputs.push_back(play(record.input));
        return outputErrorDb(outputs, records.estimation);
    }
};

/// Two realizations of six steady periods of a multisine on odd lines, between the 5th and a fifth of the rate.
/// @param noise  of the measured voltage, over its rms
/// @param offset  of the displacement, over its rms
Measurement takeOf(const Resonance& resonance, double rate, int period, double noise, double offset)
{
    Excitation excitation;
    excitation.period = period;
    excitation.settlePeriods = 3;
    excitation.periods = 6;
    excitation.realizations = 2;
    excitation.levels = {1.0};
    for (int k = 5; k < period / 5; k += 2)
        excitation.lines.push_back(k);
    Normal normal(7);
    std::vector<double> u;
    for (int realization = 0; realization < 2; ++realization) {
        std::vector<double> one(static_cast<std::size_t>(period), 0.0);
        for (const int k : excitation.lines) {
            const double phase = 10.0 * normal();
            for (int t = 0; t < period; ++t)
                one[static_cast<std::size_t>(t)] += std::cos(2.0 * pi * k * t / period + phase);
        }
        for (int p = 0; p < excitation.periodsPerRealization(); ++p)
            u.insert(u.end(), one.begin(), one.end());
    }
    const Eigen::VectorXd input = Eigen::Map<const Eigen::VectorXd>(u.data(), static_cast<Eigen::Index>(u.size()));
    const Eigen::VectorXd output = resonance.play(input);
    const auto rms = [](const Eigen::VectorXd& v) { return v.norm() / std::sqrt(static_cast<double>(v.size())); };
    Channel voltage, displacement;
    displacement.quantity = Quantity::displacement;
    displacement.unit = "m";
    for (Eigen::Index t = 0; t < input.size(); ++t) {
        voltage.samples.push_back(input[t] + noise * rms(input) * normal());
        displacement.samples.push_back(output[t] + offset * rms(output));
    }
    Measurement take;
    take.sampleRate = rate;
    take.channels = {voltage, displacement};
    take.excitation = excitation;
    return take;
}

}  // namespace

TEST_CASE("The noise of averaged periods counts that of the input, which drives every model")
{
    const Resonance resonance {0.97, 2.0 * pi * 0.04};
    const auto take = takeOf(resonance, 1000.0, 500, 0.02, 0.0);
    const auto records = recordsOf(take, take.channels[0], take.channels[1]);
    REQUIRE(records.noiseDb);
    CHECK(*records.noiseDb == Approx(resonance.errorDb(records)).margin(1.5));  // the output has none of its own
    CHECK(*records.noiseDb > -60.0);
}

TEST_CASE("A sensor's offset changes neither the error of a model over whole periods nor their noise")
{
    const Resonance resonance {0.97, 2.0 * pi * 0.04};
    const auto take = takeOf(resonance, 1000.0, 500, 0.02, 0.0), shifted = takeOf(resonance, 1000.0, 500, 0.02, 0.5);
    const auto records = recordsOf(take, take.channels[0], take.channels[1]),
               of = recordsOf(shifted, shifted.channels[0], shifted.channels[1]);
    CHECK(resonance.errorDb(of) == Approx(resonance.errorDb(records)).margin(0.01));
    CHECK(*of.noiseDb == Approx(*records.noiseDb).margin(0.01));
}

TEST_CASE("A resonance of 20 Hz with a Q of 8 dies away before a period counts")
{
    constexpr double rate = 8000.0, frequency = 20.0, quality = 8.0;
    const Resonance resonance {std::exp(-pi * frequency / quality / rate), 2.0 * pi * frequency / rate};
    const auto take = takeOf(resonance, rate, 8000, 0.0, 0.0);
    const auto records = recordsOf(take, take.channels[0], take.channels[1]);
    CHECK(records.estimation.front().skip == 8000);
    CHECK(resonance.errorDb(records) < -60.0);
    // Of a short period, as many as 0.2 s take
    const auto brief = takeOf(resonance, rate, 800, 0.0, 0.0);
    CHECK(recordsOf(brief, brief.channels[0], brief.channels[1]).estimation.front().skip == 1600);
}
