// SPDX-License-Identifier: GPL-3.0-or-later
#include "Loudspeaker/EffectBench.h"

#include "Engine/Loudspeaker/OutputError.h"
#include "Engine/Loudspeaker/StartState.h"
#include "Engine/Loudspeaker/Trajectory.h"
#include "Engine/Signal/Fft.h"

#include <catch2/catch.hpp>

#include <random>

using namespace excursion;

namespace {

constexpr std::size_t N = 1024;
constexpr double sampleRate = 16000.0;

/// A suspension whose relaxations take from a thirtieth of a second to a second, far longer than a period of 64 ms.
Model creeping()
{
    OperatingRange operatingRange;
    operatingRange.lowFrequency = 15.0;
    auto model = withEffect(makeModel("electrodynamic"), effectNamed("creep"), operatingRange);
    auto& p = model.components.back().parameters;
    p[0].value = 0.4 * model.baseParameter("K").value;
    p[1].value = -0.1;
    p[2].value = 1.4;
    return model;
}

/// One period of a random-phase multisine from 15 Hz on, measured by nobody.
Record someRecord(std::size_t leadIn)
{
    Record record;
    record.sampleRate = sampleRate;
    record.channels = {Quantity::current, Quantity::displacement};
    record.units = {"A", "m"};
    record.lowFrequency = record.bandLow = sampleRate / N;
    record.highFrequency = record.bandHigh = 60 * sampleRate / N;
    record.leadIn = leadIn;
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    std::vector<std::complex<double>> U(N / 2 + 1, 0.0);
    for (std::size_t k = 1; k <= 60; ++k)
        U[k] = std::polar(0.1 * N, 6.28 * uniform(random));
    Section section;
    section.periodic = true;
    section.window = N;
    section.input = inverseFft(U, N);
    record.sections.push_back(section);
    return record;
}

}  // namespace

TEST_CASE("A linear section starts in the state that it would reach after a long time", "[output-error]")
{
    const auto model = creeping();
    const auto begin = GENERATE(std::size_t {0}, std::size_t {300});
    const auto record = someRecord(N / 4 + begin);
    const auto drive = record.drive(record.sections.front());
    const auto start = startStates(model, record, {0}, 0, false, 2);
    REQUIRE(start.size() == 1);
    CHECK(start[0].gradient.size() == 0);

    // 200 periods are 12.8 s, more than twelve times as long as the slowest relaxation takes.
    const auto patient = someRecord(N / 4 + begin + 200 * N);
    Trajectory settled, started;
    const auto longDrive = patient.drive(patient.sections.front());
    REQUIRE(integrate(model, Drive(longDrive, sampleRate, 4), {longDrive.size() - N}, settled));
    REQUIRE(integrate(model, Drive(drive, sampleRate, 4), {drive.size() - N}, started, start[0].value));
    double difference = 0.0, power = 0.0, fromRest = 0.0;
    Trajectory rested;
    REQUIRE(integrate(model, Drive(drive, sampleRate, 4), {drive.size() - N}, rested));
    for (std::size_t n = 0; n < N; ++n) {
        difference += std::pow(started.displacement[n] - settled.displacement[n], 2);
        fromRest += std::pow(rested.displacement[n] - settled.displacement[n], 2);
        power += std::pow(settled.displacement[n], 2);
    }
    CHECK(10.0 * std::log10(difference / power) < -80.0);
    CHECK(difference < 1e-3 * fromRest);  // what it is good for
}

TEST_CASE("The derivative of the start state is that of finite differences", "[output-error]")
{
    const auto model = creeping();
    const auto record = someRecord(N / 2);
    const auto start = startStates(model, record, {0}, 0, true, 2);
    const auto theta = parameterVector(model);
    REQUIRE(start[0].gradient.cols() == theta.size());
    for (Eigen::Index k = 0; k < theta.size(); ++k) {
        const double step = theta[k] != 0.0 ? 1e-4 * std::abs(theta[k]) : 1e-4;
        const auto moved = [&](double by) {
            auto there = model;
            auto changed = theta;
            changed[k] += by;
            setParameterVector(there, changed);
            return startStates(there, record, {0}, 0, false, 2)[0].value;
        };
        const Eigen::VectorXd slope = (moved(step) - moved(-step)) / (2.0 * step);
        INFO("parameter " << k);
        CHECK((start[0].gradient.col(k) - slope).norm() <= 1e-5 * slope.norm() + 1e-12);
    }
}

TEST_CASE("A section without periods starts at rest", "[output-error]")
{
    auto record = someRecord(0);
    record.sections.front().periodic = false;
    CHECK(startStates(creeping(), record, {0}, 0, true, 2)[0].value.size() == 0);
}
