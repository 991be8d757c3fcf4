// SPDX-License-Identifier: GPL-3.0-or-later
// Identification against systems that are known, and against the figures that other programs reach on fixed problems.
#include "Engine/Linear/Bilinear.h"
#include "Engine/Linear/OrderSweep.h"
#include "Engine/Linear/Response.h"
#include "Engine/Linear/Subspace.h"
#include "Linear/Problem.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

using namespace excursion;
using namespace excursion::test;

namespace {

/// Three resonances between 2 inputs and 3 outputs, at 1 kHz.
StateSpace plant()
{
    StateSpace model;
    model.sampleRate = 1000.0;
    model.A = Eigen::MatrixXd::Zero(6, 6);
    Normal normal(5);
    for (Eigen::Index i = 0; i < 3; ++i) {
        const double r = 0.9 + 0.03 * static_cast<double>(i), w = 0.2 + 0.7 * static_cast<double>(i);
        model.A.block(2 * i, 2 * i, 2, 2) << r * std::cos(w), r * std::sin(w), -r * std::sin(w), r * std::cos(w);
    }
    model.B.resize(6, 2);
    model.C.resize(3, 6);
    model.D.resize(3, 2);
    for (auto* M : {&model.B, &model.C, &model.D})
        for (auto& x : M->reshaped())
            x = normal();
    return model;
}

FrequencyData measured(const StateSpace& model, const std::vector<double>& f)
{
    FrequencyData data;
    data.frequency = f;
    data.outputs = model.outputs();
    data.inputs = model.inputs();
    data.value.resize(static_cast<Eigen::Index>(f.size()), data.outputs * data.inputs);
    const auto responses = respond(model, f);
    for (std::size_t k = 0; k < f.size(); ++k)
        data.value.row(static_cast<Eigen::Index>(k)) = responses[k].reshaped().transpose();
    return data;
}

std::vector<double> logarithmic(double low, double high, int count)
{
    std::vector<double> f;
    for (int k = 0; k < count; ++k)
        f.push_back(low * std::pow(high / low, static_cast<double>(k) / (count - 1)));
    return f;
}

std::vector<double> uniform(int first, int last, double step)
{
    std::vector<double> f;
    for (int k = first; k <= last; ++k)
        f.push_back(k * step);
    return f;
}

}  // namespace

TEST_CASE("Subspace identification recovers several inputs and outputs on an uneven grid")
{
    const auto data = measured(plant(), logarithmic(3.0, 499.0, 90));
    const auto model = identifySubspace(data, 1000.0, 6);
    CHECK(judged(model, data).errorDb < -250.0);
    // Between the lines, and in its poles
    const auto elsewhere = measured(plant(), uniform(1, 99, 5.0));
    CHECK(judged(model, elsewhere).errorDb < -240.0);
    const auto found = poles(model), truth = poles(plant());
    for (std::size_t k = 0; k < truth.size(); ++k)
        CHECK(std::abs(found[k] - truth[k]) < 1e-11);
    IdentifyOptions options;
    options.order = 6;
    options.sampleRate = 1000.0;
    CHECK(identify(data, options).refinement.termination == Termination::severalInputs);
}

TEST_CASE("Algorithm 1 recovers the same from a uniform grid, and says when there is none")
{
    const auto data = measured(plant(), uniform(0, 256, 1000.0 / 512));
    auto model = dynamicsOf(observabilityRangeUniform(data, 1000.0, 20), 6, 2, true);
    fitInputs(model, data);
    CHECK(judged(model, data).errorDb < -230.0);
    // Without the lines at 0 and fs/2, which are then extrapolated
    const auto without = measured(plant(), uniform(1, 255, 1000.0 / 512));
    auto close = dynamicsOf(observabilityRangeUniform(without, 1000.0, 20), 6, 2, true);
    fitInputs(close, without);
    CHECK(judged(close, without).errorDb < -60.0);
    refused(Error::Kind::data, "uniform grid",
            [&] { observabilityRangeUniform(measured(plant(), logarithmic(3.0, 499.0, 90)), 1000.0, 20); });
}

TEST_CASE("Responses of one input to several outputs share their poles in the refinement")
{
    auto system = plant();
    system.B = system.B.leftCols(1).eval();
    system.D = system.D.leftCols(1).eval();
    auto data = measured(system, uniform(1, 200, 2.4));
    Normal normal(9);
    data.deviation = Eigen::MatrixXd::Constant(200, 3, 0.01);
    data.deviation.col(1) *= 5.0;
    for (Eigen::Index e = 0; e < 3; ++e)
        for (Eigen::Index k = 0; k < 200; ++k)
            data.value(k, e) += data.deviation(k, e) * std::sqrt(0.5) * std::complex<double>(normal(), normal());
    IdentifyOptions options;
    options.order = 6;
    options.sampleRate = 1000.0;
    const auto found = identify(data, options);
    CHECK(found.stable);
    // 1200 real values of unit variance less 27 parameters, one standard deviation is 2 %
    CHECK(found.chiSquared / (0.5 * (1200.0 - 27.0)) == Approx(1.0).margin(0.08));
    const auto truth = poles(system), estimate = poles(found.model);
    for (std::size_t k = 0; k < truth.size(); ++k)
        CHECK(std::abs(truth[k] - estimate[k]) < 1e-3);
    // The refinement is a minimum: what the subspace method found is no better.
    CHECK(judged(identifySubspace(data, 1000.0, 6), data).cost >= found.cost);
}

TEST_CASE("The order of a noisy response is found, in continuous time too")
{
    StateSpace truth;  // a driver's admittance: 3.3 ohm, 0.27 mH, 57 Hz
    truth.A.resize(3, 3);
    truth.A << 0, 1, 0, -1852 / 14.35e-3, -0.786 / 14.35e-3, 4.95 / 14.35e-3, 0, -4.95 / 266e-6, -3.3 / 266e-6;
    truth.B.resize(3, 1);
    truth.B << 0, 0, 1 / 266e-6;
    truth.C.resize(1, 3);
    truth.C << 0, 0, 1;
    truth.D = Eigen::MatrixXd::Zero(1, 1);
    auto data = measured(truth, logarithmic(10.0, 20000.0, 200));
    Normal normal(3);
    data.deviation = 1e-3 * data.value.cwiseAbs();
    for (Eigen::Index k = 0; k < 200; ++k)
        data.value(k, 0) += data.deviation(k, 0) * std::sqrt(0.5) * std::complex<double>(normal(), normal());
    OrderSweepOptions options;
    options.orders = {1, 2, 3, 4, 5, 6};
    const auto sweep = sweepOrders(data, options);
    CHECK(sweep.entries[sweep.chosen].order == 3);
    CHECK(sweep.sentence.find("Order 3") == 0);
    for (std::size_t k = 1; k < sweep.entries.size(); ++k)
        CHECK(sweep.entries[k].found.cost <= sweep.entries[k - 1].found.cost * (1.0 + 1e-6));
    const auto& found = sweep.entries[2].found;
    CHECK(found.stable);
    CHECK(found.chiSquared == Approx(200.0).margin(60.0));
    const auto p = poles(found.model), t = poles(truth);
    for (std::size_t k = 0; k < 3; ++k)
        CHECK(std::abs(p[k] - t[k]) < 3e-3 * std::abs(t[k]));
    // Chosen by validation as well
    auto validation = measured(truth, logarithmic(12.0, 18000.0, 150));
    CHECK(sweepOrders(data, options, &validation).entries[sweep.chosen].order == 3);
    // Where the validation data is what one of the models says, that one.
    for (const std::size_t of : {0, 1, 3, 5}) {
        validation = measured(sweep.entries[of].found.model, logarithmic(12.0, 18000.0, 150));
        const auto chosen = sweepOrders(data, options, &validation);
        CAPTURE(of, chosen.sentence);
        CHECK(*chosen.entries[of].validationDb < -150.0);
        for (std::size_t k = 0; k < 6; ++k)
            CHECK(*chosen.entries[k].validationDb >= *chosen.entries[of].validationDb);
        CHECK(chosen.chosen == of);
    }
}

namespace {

/// Resonances at 60 Hz and, of order 4, at 260 Hz, in discrete time at 2 kHz.
StateSpace resonances(int order)
{
    StateSpace model;
    model.sampleRate = 2000.0;
    model.A = Eigen::MatrixXd::Zero(order, order);
    model.B = Eigen::MatrixXd::Zero(order, 1);
    model.C = Eigen::MatrixXd::Zero(1, order);
    model.D = Eigen::MatrixXd::Constant(1, 1, 0.1);
    for (Eigen::Index i = 0; i < order / 2; ++i) {
        const double r = 0.95 + 0.01 * static_cast<double>(i);
        const double w = 2.0 * std::numbers::pi * (i == 0 ? 60.0 : 260.0) / model.sampleRate;
        model.A.block(2 * i, 2 * i, 2, 2) << r * std::cos(w), r * std::sin(w), -r * std::sin(w), r * std::cos(w);
        model.B(2 * i, 0) = 1.0;
        model.C(0, 2 * i + 1) = i == 0 ? 0.2 : 0.1;
    }
    return model;
}

/// What so many realizations tell of it: their mean, and its variance as they scatter. The noise of each falls with the
/// frequency, by 20 dB in all.
Frf scattered(const StateSpace& truth, int realizations, std::uint64_t seed)
{
    Frf frf;
    Normal normal(seed);
    constexpr int lines = 120;
    for (int k = 1; k <= lines; ++k)
        frf.frequency.push_back(8.0 * k);
    const auto exact = respond(truth, frf.frequency);
    const double M = realizations;
    for (std::size_t k = 0; k < frf.frequency.size(); ++k) {
        const double deviation = 0.03 * std::pow(10.0, -static_cast<double>(k) / lines);
        std::vector<std::complex<double>> of;
        std::complex<double> mean = 0.0;
        for (int m = 0; m < realizations; ++m) {
            const double re = normal(), im = normal();
            of.push_back(exact[k](0, 0) + deviation * std::sqrt(0.5) * std::complex<double>(re, im));
            mean += of.back() / M;
        }
        double variance = 0.0;
        for (const auto& g : of)
            variance += std::norm(g - mean) / (M * (M - 1.0));
        frf.value.push_back(mean);
        frf.totalVariance.push_back(variance);
    }
    return frf;
}

}  // namespace

TEST_CASE("The order is found from a few realizations, whose scatter tells the noise of a line only roughly")
{
    OrderSweepOptions options;
    options.orders = {1, 2, 3, 4, 5, 6, 8};
    options.identify.sampleRate = 2000.0;
    for (const int order : {2, 4})
        for (const int realizations : {2, 3, 4, 30}) {
            int right = 0;
            double chiSquared = 0.0;
            constexpr int seeds = 10;
            for (int seed = 1; seed <= seeds; ++seed) {
                const auto data = frequencyDataOf(
                    scattered(resonances(order), realizations, static_cast<std::uint64_t>(100 * realizations + seed)));
                const auto sweep = sweepOrders(data, options);
                right += sweep.entries[sweep.chosen].order == order ? 1 : 0;
                const auto found = std::find_if(sweep.entries.begin(), sweep.entries.end(),
                                                [&](const auto& entry) { return entry.order == order; });
                chiSquared += found->found.chiSquared / static_cast<double>(data.lines()) / seeds;
            }
            CAPTURE(order, realizations, right, chiSquared);
            CHECK(right >= seeds - 1);
            CHECK(chiSquared == Approx(1.0).margin(0.15));
        }
}

TEST_CASE("Orders that nobody has asked for are those that a few lines can tell")
{
    const auto truth = resonances(2);
    const auto few = measured(truth, logarithmic(20.0, 400.0, 8)), many = measured(truth, logarithmic(20.0, 400.0, 40));
    CHECK(ordersWithin({1, 2, 3, 4, 5, 6, 7, 8}, many).back() == 8);
    CHECK(ordersWithin({1, 2, 3, 4, 5, 6, 7, 8}, few) == std::vector {1, 2, 3});
    CHECK(ordersWithin({2, 3, 4}, measured(truth, logarithmic(20.0, 400.0, 3))) == std::vector {2});
    OrderSweepOptions options;
    options.orders = ordersWithin({1, 2, 3, 4, 5, 6, 7, 8}, few);
    options.identify.sampleRate = truth.sampleRate;
    const auto sweep = sweepOrders(few, options);
    REQUIRE(sweep.entries.size() == 3);
    for (const auto& entry : sweep.entries)
        CHECK(entry.found.model.order() == entry.order);
    CHECK(sweep.entries[1].found.errorDb < -150.0);
}

TEST_CASE("What is known of the noise of each line stays as it is")
{
    Frf frf;
    for (int k = 1; k <= 60; ++k) {
        frf.frequency.push_back(10.0 * k);
        frf.value.emplace_back(1.0, 0.1 * k);
        frf.noiseVariance.push_back(1e-6 * std::exp(0.2 * k));  // steep, and even
    }
    auto data = frequencyDataOf(frf);
    for (Eigen::Index k = 0; k < 60; ++k)
        CHECK(data.deviation(k, 0) == Approx(std::sqrt(frf.noiseVariance[static_cast<std::size_t>(k)])).epsilon(1e-9));
    // A line that sticks out keeps the better part of it.
    frf.noiseVariance[30] *= 1e4;
    data = frequencyDataOf(frf);
    CHECK(data.deviation(30, 0) >= 0.4 * std::sqrt(frf.noiseVariance[30]));
    // Lines without scatter, or none that can be told, have that of the others.
    frf.noiseVariance[10] = 0.0;
    frf.noiseVariance[11] = std::numeric_limits<double>::quiet_NaN();
    data = frequencyDataOf(frf);
    CHECK(data.isValid());
}

TEST_CASE("Bad input of an identification is told in a sentence")
{
    auto data = measured(plant(), uniform(1, 20, 10.0));
    IdentifyOptions options;
    options.order = -1;
    refused(Error::Kind::usage, "order", [&] { identify(data, options); });
    options.order = 50;
    refused(Error::Kind::data, "lines", [&] { identify(data, options); });
    options.order = 2;
    options.sampleRate = 100.0;
    refused(Error::Kind::usage, "half its sample rate", [&] { identify(data, options); });
    data.value(3, 1) = std::numeric_limits<double>::quiet_NaN();
    refused(Error::Kind::data, "not finite", [&] { identify(data, options); });
}

TEST_CASE("A model of order 0 is a constant, in continuous and discrete time, by every method and of fractional order")
{
    Frf frf;
    for (int k = 1; k <= 20; ++k) {
        frf.frequency.push_back(10.0 * k);
        frf.value.emplace_back(2.5, 0.01 * (k % 3 - 1));
    }
    const auto data = frequencyDataOf(frf);
    for (const double rate : {0.0, 1000.0})
        for (const bool refine : {false, true})
            for (const double alpha : {1.0, 0.5}) {
                if (alpha != 1.0 && rate != 0.0)
                    continue;
                IdentifyOptions options;
                options.order = 0;
                options.sampleRate = rate;
                options.refine = refine;
                options.alpha = alpha;
                const auto found = identify(data, options);
                CAPTURE(rate, refine, alpha);
                REQUIRE(found.model.order() == 0);
                CHECK(found.model.D(0, 0) == Approx(2.5));
                CHECK(found.stable);
            }
}

TEST_CASE("An exact response of order 3 is met to rounding at any order and any standard deviation, stable", "[slow]")
{
    const auto frf = problemResponse("P3i.csv");
    if (frf.frequency.empty())
        return;
    for (const double deviation : {0.0, 1e-12, 1.0, 1e6})
        for (const int order : {3, 4, 5, 6, 8, 11, 15, 20}) {
            auto data = frequencyDataOf(frf);
            if (deviation > 0.0)
                data.deviation = Eigen::MatrixXd::Constant(data.lines(), 1, deviation);
            INFO("order " << order << ", deviation " << deviation);
            const auto subspace = judged(identifySubspace(data, 48000.0, order), data);
            CHECK(subspace.errorDb < -250.0);
            CHECK(subspace.stable);
            if (deviation == 1e6 || deviation == 1.0)
                continue;
            IdentifyOptions options;
            options.order = order;
            options.sampleRate = 48000.0;
            const auto refined = identify(data, options);
            CHECK(refined.errorDb < -270.0);
            CHECK(refined.stable);
        }
}

TEST_CASE("32 cone modes: the noise at the true order, and below it no worse than vector fitting", "[slow]")
{
    const auto frf = problemResponse("P3ii.csv");
    if (frf.frequency.empty())
        return;
    const auto data = frequencyDataOf(frf);
    Frf truth = frf;
    const auto rows = problemRows("P3ii.csv");
    for (std::size_t k = 0; k < rows.size(); ++k)
        truth.value[k] = {rows[k][4], rows[k][5]};
    IdentifyOptions options;
    options.order = 67;
    const auto full = identify(data, options);
    CHECK(full.errorDb <= -60.1);
    CHECK(relativeErrorDb(truth, frfOf(full.model, truth.frequency)) < -74.5);
    CHECK(full.stable);
    for (const auto& [order, db] : {std::pair {12, -12.6}, std::pair {22, -15.3}, std::pair {76, -60.2}}) {
        options.order = order;
        const auto found = identify(data, options);
        INFO("order " << order);
        CHECK(found.errorDb <= db + 0.05);
        CHECK(found.stable);
    }
}
