// SPDX-License-Identifier: GPL-3.0-or-later
// A target of predistortion: what is played to the virtual bench, which shares no equation with the engine, moves as
// the closed form of the target says.
#include "Predistortion/Targets.h"

#include "Bench/Bench.h"
#include "Engine/Error.h"
#include "Engine/Loudspeaker/Simulate.h"
#include "Engine/Predistortion/Chain.h"
#include "Engine/Predistortion/Predistorter.h"
#include "Engine/Predistortion/TargetForecast.h"
#include "Engine/Signal/Fft.h"
#include "Engine/Signal/Multisine.h"
#include "Engine/Take/Air.h"

#include <catch2/catch.hpp>

#include <complex>

using namespace excursion;
using namespace excursion::test;

namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;

/// The same without regard to inductance: a resonance, and behind it the coil.
Complex plainResponse(const bench::Loudspeaker& d, const Resonance& wanted, double frequency)
{
    const Complex coil = 1.0 + Complex(0.0, 2.0 * pi * frequency * d.Le / d.Re);
    return d.Bl / (d.Re * d.m) / (quadratic(wanted, frequency) * coil);
}

/// From 8 to 400 Hz, with silence before and behind.
std::vector<double> sweep(double rate, double amplitude)
{
    constexpr double low = 8.0, high = 400.0, seconds = 6.0, fade = 0.4;
    std::vector<double> u(static_cast<std::size_t>((seconds + 1.0) * rate));
    const double growth = std::log(high / low);
    for (std::size_t n = 0; n < static_cast<std::size_t>(seconds * rate); ++n) {
        const double t = static_cast<double>(n) / rate, edge = std::min({1.0, t / fade, (seconds - t) / fade}),
                     phase = 2.0 * pi * low * seconds / growth * std::expm1(t / seconds * growth);
        u[n] = amplitude * (0.5 - 0.5 * std::cos(pi * edge)) * std::sin(phase);
    }
    return u;
}

double db(double ratio) { return 20.0 * std::log10(ratio); }

}  // namespace

TEST_CASE("The own resonance is that of Thiele and Small", "[predistortion][target]")
{
    const auto truth = ownOf({});
    for (const auto& model : {midbass(), withoutEffect(everything(), "creep")}) {
        const OwnLinearPart own(model);
        REQUIRE(own.single);
        CHECK(own.single->frequency == Approx(truth.frequency).epsilon(1e-12));
        CHECK(own.single->quality == Approx(truth.quality).epsilon(1e-12));
    }
    const auto mechanical = makeModel("mechanical");
    const OwnLinearPart force(mechanical);
    REQUIRE(force.single);
    CHECK(force.single->frequency == Approx(resonanceOf(mechanical.base().parameters)).epsilon(1e-12));
}

TEST_CASE("A suspension that has crept resonates, and is turned around, on what it is there", "[predistortion][target]")
{
    // Three quarters of the stiffness relax within seconds, far below the resonance.
    auto soft = midbass(), stiff = soft;
    const double K = stiff.baseParameter("K").value;
    soft.baseParameter("K").value = 0.25 * K;
    soft = withEffect(std::move(soft), effectNamed("creep"), stiff.base().operatingRange);
    auto& creep = soft.components.back().parameters;
    for (const auto& [name, value] : {std::pair {"S", 0.75 * K}, {"centre", -1.0}, {"width", 0.5}})
        std::find_if(creep.begin(), creep.end(), [name](const Parameter& p) { return p.name == name; })->value = value;
    const OwnLinearPart own(soft), truth(stiff);
    REQUIRE(own.single);
    CHECK(own.single->frequency == Approx(truth.single->frequency).epsilon(2e-4));
    CHECK(own.single->quality == Approx(truth.single->quality).epsilon(0.01));
    CHECK(own.suspensionVolume.value_or(0.0) == Approx(truth.suspensionVolume.value_or(0.0)).epsilon(4e-4));
}

TEST_CASE("In a vented box two resonances share the motion: no target, and a sentence that says so",
          "[predistortion][target]")
{
    auto model = withStrong(midbass(), effectNamed("vented-box"));
    CHECK(OwnLinearPart(model).single);  // a port that takes hardly part is none
    for (auto& parameter : model.components.back().parameters)
        parameter.value = parameter.name == "Kb"   ? 3000.0
                          : parameter.name == "fB" ? 45.0
                                                   : std::min(parameter.value, 0.1);
    const OwnLinearPart vented(model);
    CHECK_FALSE(vented.single);
    CHECK_THROWS_WITH(vented.require({Target::Kind::resonance, 30.0, 0.7, 0.02}), Catch::Contains("vented box"));
    CHECK_NOTHROW(vented.require({}));
    // A control that asks for it anyway changes nothing.
    Predistorter plain(model, {48000.0, 2}), asked(model, {48000.0, 2}, towards(30.0, 0.7));
    const auto u = burst(48000.0, 0.3, 4.0);
    CHECK(through(asked, u) == through(plain, u));
}

TEST_CASE("Predistorter and loudspeaker have the target's response, to below f0 and at every rate",
          "[predistortion][target]")
{
    for (const double inductance : {266e-6, 10e-6})
        for (const double rate : {44100.0, 48000.0, 96000.0})
            for (const Resonance wanted : {Resonance {28.0, 0.707}, Resonance {40.0, 1.1}, Resonance {90.0, 0.5}}) {
                bench::Loudspeaker driver;
                auto model = midbass();
                model.baseParameter("Le").value = driver.Le = inductance;
                const auto u = sweep(rate, 1.0);
                Predistorter predistorter(model, {rate, 2}, towards(wanted.frequency, wanted.quality));
                const auto take = bench::play(driver, through(predistorter, u), rate, {Quantity::displacement});
                const auto U = fft(u), X = fft(take.find(Quantity::displacement)->samples);
                double worst = 0.0, plain = 0.0;
                for (std::size_t k = 0; k < U.size() / 2; ++k) {
                    const double f = static_cast<double>(k) * rate / static_cast<double>(u.size());
                    if (f < 10.0 || f > 300.0)
                        continue;
                    const auto off = [&](Complex truth) { return std::abs(db(std::abs(X[k] / U[k] / truth))); };
                    worst = std::max(worst, off(targetResponse(driver, wanted, f)));
                    plain = std::max(plain, off(plainResponse(driver, wanted, f)));
                }
                INFO(rate << " Hz, target " << wanted.frequency << " Hz: " << worst << " dB off at worst, " << plain
                          << " without regard to inductance");
                CHECK(worst < 0.1);
                if (inductance < 1e-4)
                    CHECK(plain < 0.1);
                CHECK(predistorter.collectMeters().faults == 0);
            }
}

TEST_CASE("The filter of a target is exact at 0 and at its resonance, and 1 far above", "[predistortion][target]")
{
    for (const double rate : {44100.0, 48000.0, 96000.0}) {
        TargetFilter filter(OwnLinearPart(midbass()), rate);
        const auto own = *filter.own().single;
        filter.aim({Target::Kind::resonance, 31.0, 0.6, 0.02});
        filter.jump();
        const Complex s(0.0, 31.0), exactly = (s * s + s * own.frequency / own.quality + own.frequency * own.frequency)
                                              / (s * s + s * 31.0 / 0.6 + 31.0 * 31.0);
        CHECK(std::abs(filter.at(31.0) - exactly) < 1e-12 * std::abs(exactly));
        CHECK(std::abs(filter.at(0.0)) == Approx(std::pow(own.frequency / 31.0, 2)).epsilon(1e-12));
        CHECK(std::abs(filter.at(0.45 * rate)) == Approx(1.0).epsilon(1e-4));
        // What steps does as it is said to.
        const auto n = static_cast<std::size_t>(rate);
        std::vector<double> response(n);
        for (std::size_t k = 0; k < n; ++k)
            response[k] = filter.step(k == 0 ? 1.0 : 0.0);
        const auto H = fft(response);
        for (const std::size_t f : {1, 10, 31, 60, 500, 5000})
            CHECK(std::abs(H[f] - filter.at(static_cast<double>(f))) < 1e-6 * std::abs(H[f]));
    }
}

TEST_CASE("A closed box is played as the driver would be in it", "[predistortion][target]")
{
    bench::Loudspeaker driver, boxed;
    driver.Le = boxed.Le = 1e-8;
    const double volume = 0.012;
    boxed.K += airDensity * speedOfSound * speedOfSound * std::pow(driver.coneArea, 2) / volume;
    auto model = midbass();
    model.baseParameter("Le").value = driver.Le;
    model.path.parameters.front().value = driver.coneArea;
    TargetFilter filter(OwnLinearPart(model), 96000.0);
    filter.aim({Target::Kind::closedBox, 40.0, 0.7, volume});
    filter.jump();
    for (double f = 5.0; f < 500.0; f *= 1.1) {
        const auto played = filter.at(f) * driver.small(f).displacement, truth = boxed.small(f).displacement;
        CHECK(std::abs(db(std::abs(played / truth))) < 0.01);
    }
    // Where the area is not known, a box is none.
    const OwnLinearPart own(midbass());
    CHECK_FALSE(own.suspensionVolume);
    CHECK_THROWS_WITH(own.require({Target::Kind::closedBox, 40.0, 0.7, volume}), Catch::Contains("area"));
    for (const Target& refused : {Target {Target::Kind::closedBox, 40.0, 0.7, volume}, {Target::Kind::resonance, 4.0}})
        CHECK(own.played(refused).frequency == own.single->frequency);
    CHECK_THROWS_WITH(own.require({Target::Kind::resonance, 4.0, 0.7, volume}), Catch::Contains("out of reach"));
    CHECK_THROWS_WITH(own.require({Target::Kind::resonance, 40.0, 0.0, volume}), Catch::Contains("Q of"));
}

TEST_CASE("Linear to -90 dB at 75 % of xmax, towards a target as towards the own linear part",
          "[predistortion][target][slow]")
{
    constexpr double rate = 48000.0;
    const auto model = everything(), linear = linearPart(model);
    MultisineOptions options;
    options.sampleRate = rate;
    options.period = 8192;
    options.bandHigh = 6000.0;
    const auto lines = chooseLines(options);
    const auto one = multisine(options, lines, 0);
    for (const Resonance wanted : {Resonance {40.0, 0.707}, Resonance {80.0, 0.6}}) {
        const auto controls = towards(wanted.frequency, wanted.quality);
        std::vector<double> u;
        for (int p = 0; p < 5; ++p)
            u.insert(u.end(), one.begin(), one.end());
        for (std::size_t n = 0; n < 2048; ++n)
            u[n] *= 0.5 - 0.5 * std::cos(pi * static_cast<double>(n) / 2048.0);
        const auto targeted = [&](std::vector<double> samples) {
            TargetFilter filter(OwnLinearPart(model), rate);
            filter.aim(controls.target);
            filter.jump();
            for (auto& sample : samples)
                sample = filter.step(sample);
            return exact(linear, samples, rate);
        };
        const double reach = peak(targeted(u).find(Quantity::displacement)->samples);
        for (auto& sample : u)
            sample *= 0.75 * xmax / reach;
        const auto truth = targeted(u);
        CHECK(peak(truth.find(Quantity::displacement)->samples) == Approx(0.75 * xmax).epsilon(1e-3));
        Predistorter predistorter(model, {rate, 2}, controls);
        const auto moves = exact(model, through(predistorter, u), rate);
        const auto last = [&](const Measurement& take, Quantity quantity) {
            const auto& samples = take.find(quantity)->samples;
            return fft(std::vector<double>(samples.end() - options.period, samples.end()));
        };
        for (const auto quantity : {Quantity::displacement, Quantity::acceleration}) {
            const auto Y = last(moves, quantity), L = last(truth, quantity);
            double silent = 0.0, all = 0.0;
            for (int k = lines.front(); k <= lines.back(); ++k) {
                const auto line = static_cast<std::size_t>(k);
                all += std::norm(L[line]);
                if (!std::binary_search(lines.begin(), lines.end(), k))
                    silent += std::norm(Y[line] - L[line]);
            }
            INFO("towards " << wanted.frequency << " Hz: " << 10.0 * std::log10(silent / all) << " dB of the "
                            << name(quantity));
            CHECK(10.0 * std::log10(silent / all) < -90.0);
        }
        CHECK(relativeError(moves.find(Quantity::displacement)->samples, truth.find(Quantity::displacement)->samples)
              < 2e-3);
    }
}

TEST_CASE("The limits hold for what a target asks for", "[predistortion][target]")
{
    constexpr double rate = 48000.0;
    const auto model = everything();
    for (const double frequency : {25.0, 35.0, 110.0})
        for (int kind = 0; kind < 3; ++kind) {
            auto controls = towards(frequency, 0.8);
            controls.displacementLimit = 0.5 * xmax;
            controls.voltageLimit = 9.0;
            controls.powerLimit = 4.0;
            std::vector<double> u = noise(96000, 12.0, 3);
            if (kind > 0)
                for (std::size_t n = 0; n < u.size(); ++n)
                    u[n] = 9.0 * std::sin(2.0 * pi * (kind == 1 ? 24.0 : 48.0) * static_cast<double>(n) / rate);
            Predistorter predistorter(model, {rate, 2}, controls);
            const auto bent = through(predistorter, u);
            const auto take = exact(model, bent, rate);
            INFO(frequency << " Hz, signal " << kind);
            CHECK(peak(take.find(Quantity::displacement)->samples) < controls.displacementLimit * 1.001);
            CHECK(peak(bent) <= controls.voltageLimit);
            const auto meters = predistorter.collectMeters();
            CHECK(meters.faults == 0);
            CHECK(meters.power < controls.powerLimit * 1.02);
            if (kind == 1 && frequency < 50.0)
                CHECK(meters.displacementReduction > 1.0);
        }
}

TEST_CASE("A target comes and goes without a click, and without one the samples are as they were",
          "[predistortion][target]")
{
    constexpr double rate = 48000.0;
    const auto model = withStrong(midbass(), effectNamed("stiffness"));
    std::vector<double> u(static_cast<std::size_t>(3.0 * rate));
    for (std::size_t n = 0; n < u.size(); ++n) {
        const double t = static_cast<double>(n) / rate;
        u[n] = 0.7 * std::min(1.0, 5.0 * t) * std::sin(2.0 * pi * 35.0 * t);
    }
    // Above 1 kHz a tone of 35 Hz has nothing; a click has.
    const auto clicks = [](const std::vector<double>& samples) {
        double most = 0.0;
        for (std::size_t n = 3; n < samples.size(); ++n)
            most = std::max(most, std::abs(samples[n] - 3.0 * samples[n - 1] + 3.0 * samples[n - 2] - samples[n - 3]));
        return most;
    };
    Predistorter plain(model, {rate, 2}), towardsLow(model, {rate, 2}, towards(25.0, 0.7)), moved(model, {rate, 2});
    std::vector<double> out(u.size()), expected(u.size()), low(u.size());
    plain.process(u.data(), expected.data(), u.size());
    towardsLow.process(u.data(), low.data(), u.size());
    const double still = std::max(clicks(expected), clicks(low));
    constexpr std::size_t block = 480;
    for (std::size_t n = 0; n < u.size(); n += block) {
        const auto at = n / block;
        if (at == 100)
            moved.set(towards(25.0, 0.7));
        if (at == 150)
            moved.set(towards(100.0, 0.4));
        if (at == 155)  // before it is there
            moved.set(towards(45.0, 1.5));
        if (at == 200)
            moved.set({});
        moved.process(u.data() + n, out.data() + n, block);
    }
    INFO(clicks(out) << " against " << still);
    CHECK(clicks(out) < 3.0 * still);
    // Where it came from it goes back to: the filter is none again, and its past is forgotten.
    double apart = 0.0;
    for (std::size_t n = u.size() - 9600; n < u.size(); ++n)
        apart = std::max(apart, std::abs(out[n] - expected[n]));
    CHECK(apart < 1e-6 * peak(expected));

    TargetFilter none(OwnLinearPart(model), rate);
    for (const double sample : noise(1000, 5.0))
        REQUIRE(none.step(sample) == sample);
}

TEST_CASE("In bypass a target changes no bit", "[predistortion][target]")
{
    constexpr double rate = 48000.0;
    ChainControls controls;
    controls.predistortion = towards(25.0, 0.7);
    Chain chain(everything(), {rate, 2}, controls);
    const auto u = noise(20000, 0.7);
    CHECK(through(chain, u) == u);
    controls.mode = Mode::linearize;
    chain.set(controls);
    through(chain, u);
    controls.mode = Mode::bypass;
    chain.set(controls);
    through(chain, u);
    CHECK(through(chain, u) == u);
}
