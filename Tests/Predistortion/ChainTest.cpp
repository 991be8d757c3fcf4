// SPDX-License-Identifier: GPL-3.0-or-later
#include "Predistortion/Drivers.h"

#include "Engine/Predistortion/Chain.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

using namespace excursion;

namespace {

ChainControls controls(Mode mode) { return {mode, 8.0, 1.0, {}}; }

std::vector<double> played(Mode mode, const std::vector<double>& u)
{
    Chain chain(everything(), {48000.0, 2}, controls(mode));
    return through(chain, u);
}

std::vector<double> scaled(std::vector<double> values, double factor)
{
    for (auto& value : values)
        value *= factor;
    return values;
}

}  // namespace

TEST_CASE("A chain does what its mode says, always as late", "[chain]")
{
    const auto u = burst(48000.0, 0.3, 1.0);
    const RealTimeOptions options {48000.0, 2};
    const auto model = everything();
    CHECK(played(Mode::bypass, u) == u);

    Predistorter bend(model, options);
    const auto bent = through(bend, scaled(u, 8.0));
    CHECK(relativeError(played(Mode::linearize, u), scaled(bent, 1.0 / 8.0)) < 1e-12);

    Speaker speaker(model, options);
    const double gain = 1.0 / (8.0 * plateau(model));
    CHECK(relativeError(played(Mode::speaker, u), scaled(through(speaker, scaled(u, 8.0)), gain)) < 1e-12);
    speaker.reset();
    auto both = played(Mode::audition, u), apart = scaled(through(speaker, bent), gain);
    both.resize(both.size() - 200);  // `bent` ends where the signal does, and the second filter looks beyond that
    apart.resize(both.size());
    // the chain stays at the higher rate in between; a filter is flat within 3e-6
    CHECK(relativeError(both, apart) < 1e-6);

    // Linearized, the speaker is a linear one; alone it is not.
    Speaker straight(linearPart(model), options);
    const auto linear = scaled(through(straight, scaled(u, 8.0)), gain);
    CHECK(relativeError(played(Mode::audition, u), linear) < 1e-4);
    CHECK(relativeError(played(Mode::speaker, u), linear) > 0.01);
    auto sum = played(Mode::distortion, u);
    for (std::size_t n = 0; n < sum.size(); ++n)
        sum[n] += linear[n];
    CHECK(relativeError(sum, played(Mode::speaker, u)) < 1e-4);
}

TEST_CASE("What a speaker did before a bypass is not heard after it", "[chain]")
{
    Chain chain(everything(), {48000.0, 2}, controls(Mode::speaker));
    auto u = burst(48000.0, 0.3, 1.0);
    u.resize(u.size() / 2);  // at its loudest
    through(chain, u);
    const std::vector<double> silence(24000, 0.0);
    for (const auto mode : {Mode::speaker, Mode::distortion, Mode::audition}) {
        INFO(name(mode));
        chain.set(controls(Mode::bypass));
        through(chain, silence);
        chain.set(controls(mode));
        CHECK(rms(through(chain, silence)) == 0.0);
    }
}

TEST_CASE("No mode lets through what is not finite", "[chain]")
{
    for (const auto mode : modes) {
        INFO(name(mode));
        Chain chain(everything(), {48000.0, 2}, controls(mode));
        auto u = burst(48000.0, 0.3, 0.5);
        u[5000] = std::numeric_limits<double>::quiet_NaN();
        u[5001] = -std::numeric_limits<double>::infinity();
        const auto out = through(chain, u);
        CHECK(std::all_of(out.begin(), out.end(), [](double value) { return std::isfinite(value); }));
        CHECK(chain.collectMeters().faults == 2);
    }
}

TEST_CASE("Modes and levels are changed without a click", "[chain]")
{
    Chain chain(everything(), {48000.0, 2}, controls(Mode::bypass));
    std::vector<double> u(60000);
    for (std::size_t n = 0; n < u.size(); ++n)
        u[n] = 0.5 * std::sin(2.0 * std::numbers::pi * 150.0 * static_cast<double>(n) / 48000.0);
    auto out = u;
    std::size_t turn = 0;
    for (std::size_t n = 0; n < u.size(); n += 1000) {
        auto next = controls(modes[turn++ % modes.size()]);
        next.fullScale = turn % 2 == 0 ? 3.0 : 8.0;
        chain.set(next);
        chain.process(u.data() + n, out.data() + n, 1000);
    }
    double steepest = 0.0;
    for (std::size_t n = 1; n < out.size(); ++n)
        steepest = std::max(steepest, std::abs(out[n] - out[n - 1]));
    CHECK(steepest < 0.05);  // the tone has 0.01
}

namespace {

/// What a change does to a tone that has settled: the largest second difference after it, in units of the largest
/// before and long after.
double kink(const ChainControls& before, const ChainControls& after, double frequency, double amplitude = 0.3)
{
    Chain chain(everything(), {48000.0, 2}, before);
    std::vector<double> u(96000);
    for (std::size_t n = 0; n < u.size(); ++n)
        u[n] = amplitude * std::sin(2.0 * std::numbers::pi * frequency * static_cast<double>(n) / 48000.0)
               * std::min(1.0, static_cast<double>(n) / 9600.0);
    const std::size_t change = 48000;
    for (std::size_t n = 0; n < u.size(); n += 480) {
        chain.set(n < change ? before : after);
        chain.process(u.data() + n, u.data() + n, 480);
    }
    const auto largest = [&u](std::size_t from, std::size_t to) {
        double result = 0.0;
        for (std::size_t n = from; n < to; ++n)
            result = std::max(result, std::abs(u[n + 1] - 2.0 * u[n] + u[n - 1]));
        return result;
    };
    return largest(change, 80000) / std::max(largest(24000, change - 1), largest(80000, u.size() - 1));
}

}  // namespace

TEST_CASE("No change bends the signal more than three times as much as the signal itself does", "[chain][slow]")
{
    for (const double frequency : {30.0, 300.0}) {
        INFO(frequency << " Hz");
        for (const auto from : modes)
            for (const auto to : modes)
                if (from != to) {
                    INFO(name(from) << " to " << name(to));
                    CHECK(kink(controls(from), controls(to), frequency) < 3.0);
                }
        for (const auto mode : {Mode::linearize, Mode::audition, Mode::speaker}) {
            INFO(name(mode));
            const auto changed = [&](const auto& change) {
                auto after = controls(mode);
                change(after);
                return std::max(kink(controls(mode), after, frequency), kink(after, controls(mode), frequency));
            };
            CHECK(changed([](ChainControls& c) { c.trim = 4.0; }) < 3.0);
            CHECK(changed([](ChainControls& c) { c.trim = 0.001; }) < 3.0);
            CHECK(changed([](ChainControls& c) { c.fullScale = 1.0; }) < 3.0);
            CHECK(changed([](ChainControls& c) { c.fullScale = 12.0; }) < 3.0);
            CHECK(changed([](ChainControls& c) { c.predistortion.amount = 0.0; }) < 3.0);
            CHECK(changed([](ChainControls& c) { c.predistortion.displacementLimit = 20e-3; }) < 3.0);
            CHECK(changed([](ChainControls& c) { c.predistortion.voltageLimit = 1.0; }) < 3.0);
            CHECK(changed([](ChainControls& c) { c.predistortion.displacementLimit = 0.3e-3; }) < 3.0);
            CHECK(changed([](ChainControls& c) { c.predistortion.powerLimit = 0.1; }) < 3.0);
        }
    }
}

TEST_CASE("The volts at full scale do not disturb the signal", "[chain]")
{
    std::vector<double> u(48000);
    for (std::size_t n = 0; n < u.size(); ++n)
        u[n] = 0.1 * std::sin(2.0 * std::numbers::pi * 100.0 * static_cast<double>(n) / 48000.0);
    for (const auto mode : {Mode::bypass, Mode::linearize}) {
        Chain chain(linearPart(everything()), {48000.0, 2}, controls(mode));
        auto out = u;
        for (std::size_t n = 0; n < u.size(); n += 480) {
            auto now = controls(mode);
            now.fullScale = n / 4800 % 2 == 0 ? 1.0 : 200.0;
            chain.set(now);
            chain.process(u.data() + n, out.data() + n, 480);
        }
        const auto latency = static_cast<std::size_t>(chain.latency());
        double worst = 0.0;
        for (std::size_t n = 4800; n < u.size(); ++n)
            worst = std::max(worst, std::abs(out[n] - u[n - latency]));
        CHECK(worst < (mode == Mode::bypass ? 1e-300 : 0.005 * 0.1));
    }
}

TEST_CASE("Bypass is bit by bit the signal as it was, whatever is moved meanwhile", "[chain]")
{
    Chain chain(everything(), {48000.0, 2}, controls(Mode::bypass));
    const auto u = noise(48000, 1.0);
    auto out = u;
    for (std::size_t n = 0; n < u.size(); n += 480) {
        auto now = controls(Mode::bypass);
        now.fullScale = 1.0 + static_cast<double>(n % 7);
        now.trim = 0.1 * static_cast<double>(n % 11);
        now.predistortion = {0.1 * static_cast<double>(n % 10), 1e-4 * static_cast<double>(1 + n % 9),
                             static_cast<double>(1 + n % 5), 1.0, 0.1};
        chain.set(now);
        chain.process(u.data() + n, out.data() + n, 480);
    }
    CHECK(std::equal(u.begin(), u.end() - chain.latency(), out.begin() + chain.latency()));
}

TEST_CASE("Bypass keeps a zero's sign and the faintest samples", "[chain]")
{
    Chain chain(everything(), {48000.0, 2}, controls(Mode::bypass));
    const std::vector<double> faint {-0.0, 1e-31, -1e-31, 1e-40, -3e-45, 0.0};
    std::vector<double> u;
    for (int n = 0; n < 2000; ++n)
        u.push_back(faint[static_cast<std::size_t>(n) % faint.size()]);
    auto out = u;
    chain.process(u.data(), out.data(), u.size());
    const auto late = static_cast<std::size_t>(chain.latency());
    for (std::size_t n = late; n < u.size(); ++n) {
        INFO(n);
        REQUIRE(out[n] == u[n - late]);
        REQUIRE(std::signbit(out[n]) == std::signbit(u[n - late]));
    }
}

TEST_CASE("The meters fall to nothing in bypass", "[chain]")
{
    const auto u = noise(48000, 0.5);
    auto out = u;
    Chain chain(everything(), {48000.0, 2}, controls(Mode::linearize));
    chain.process(u.data(), out.data(), u.size());
    REQUIRE(chain.collectMeters().predistorter.power > 0.0);
    chain.set(controls(Mode::bypass));
    chain.process(u.data(), out.data(), u.size());  // fades
    chain.collectMeters();
    chain.process(u.data(), out.data(), u.size());
    const auto meters = chain.collectMeters();
    CHECK(meters.predistorter.power == 0.0);
    CHECK(meters.predistorter.voltage == 0.0);
    CHECK(meters.predistorter.displacement == 0.0);
}

TEST_CASE("No sample is above full scale while the volts at full scale and the limit fall with it", "[chain]")
{
    for (const double frequency : {25.0, 40.0}) {
        INFO(frequency << " Hz");
        auto some = controls(Mode::linearize);
        some.fullScale = some.predistortion.voltageLimit = 20.0;
        some.predistortion.target = {Target::Kind::resonance, 25.0, 0.7, 0.02};  // asks for more volts than come in
        Chain chain(everything(), {48000.0, 2}, some);
        std::vector<double> u(48000);
        for (std::size_t n = 0; n < u.size(); ++n)
            u[n] = std::sin(2.0 * std::numbers::pi * frequency * static_cast<double>(n) / 48000.0);
        double loudest = 0.0;
        for (std::size_t n = 0; n < u.size(); n += 480) {
            some.fullScale = some.predistortion.voltageLimit = n < 24000 ? 20.0 : 5.0;
            chain.set(some);
            chain.process(u.data() + n, u.data() + n, 480);
            for (std::size_t k = n; k < n + 480; ++k)
                loudest = std::max(loudest, std::abs(u[k]));
        }
        CHECK(loudest <= 1.0);
        CHECK(loudest > 0.9);
    }
}

TEST_CASE("From the sample at which it is switched on nothing passes the limit of the voltage", "[chain]")
{
    for (const double frequency : {50.0, 700.0}) {
        Chain chain(everything(), {48000.0, 2}, controls(Mode::bypass));
        std::vector<double> u(24000);
        for (std::size_t n = 0; n < u.size(); ++n)
            u[n] = 0.98 * std::sin(2.0 * std::numbers::pi * frequency * static_cast<double>(n) / 48000.0);
        const std::size_t change = 9600;
        for (std::size_t n = 0; n < u.size(); n += 480) {
            auto now = controls(n < change ? Mode::bypass : Mode::linearize);
            now.fullScale = 50.0;
            now.predistortion.voltageLimit = 25.0;
            chain.set(now);
            chain.process(u.data() + n, u.data() + n, 480);
        }
        double loudest = 0.0;
        for (std::size_t n = change + static_cast<std::size_t>(chain.latency()); n < u.size(); ++n)
            loudest = std::max(loudest, 50.0 * std::abs(u[n]));
        CHECK(loudest < 25.0 * (1.0 + 1e-9));
        CHECK(loudest > 15.0);
    }
}

namespace {

/// A tone through modes that follow each other, each for 0.2 s; the largest sample of each.
std::vector<double> loudestOf(const std::vector<Mode>& modes, ChainControls controls, double amplitude,
                              double frequency)
{
    controls.mode = modes.front();
    Chain chain(everything(), {48000.0, 2}, controls);
    constexpr std::size_t block = 480, each = 20 * block;
    std::vector<double> u(modes.size() * each), loudest(modes.size());
    for (std::size_t n = 0; n < u.size(); ++n)
        u[n] = amplitude * std::sin(2.0 * std::numbers::pi * frequency * static_cast<double>(n) / 48000.0);
    for (std::size_t n = 0; n < u.size(); n += block) {
        controls.mode = modes[n / each];
        chain.set(controls);
        chain.process(u.data() + n, u.data() + n, block);
        const std::size_t from = n % each == 0 ? static_cast<std::size_t>(chain.latency()) : 0;
        for (std::size_t k = n + from; k < n + block; ++k)
            loudest[n / each] = std::max(loudest[n / each], std::abs(u[k]));
    }
    return loudest;
}

}  // namespace

TEST_CASE("A trim that moves from behind the loudspeaker to before it passes no limit and makes no burst", "[chain]")
{
    for (const double trim : {0.01, 0.1, 4.0, 16.0}) {
        CAPTURE(trim);
        auto some = controls(Mode::bypass);
        some.fullScale = 50.0;
        some.trim = trim;
        some.predistortion.voltageLimit = 25.0;
        for (const auto& before : {std::vector {Mode::speaker, Mode::bypass}, {Mode::speaker}, {Mode::distortion}}) {
            auto modes = before;
            modes.push_back(Mode::linearize);
            CHECK(50.0 * loudestOf(modes, some, 0.98, 300.0).back() < 25.0 * (1.0 + 1e-9));
        }
        // Quiet enough that nothing is limited: then the louder one of both is the loudest.
        some.predistortion.voltageLimit = 1e9;
        const double quiet = 0.002 / std::max(1.0, trim);
        for (const auto other : {Mode::speaker, Mode::audition}) {
            const auto loudest = loudestOf({Mode::linearize, other, Mode::linearize, other}, some, quiet, 300.0);
            CHECK(loudest[2] < 1.1 * std::max(loudest[0], loudest[1]));
            CHECK(loudest[3] < 1.1 * std::max(loudest[0], loudest[1]));
        }
    }
}

TEST_CASE("A chain that begins loud rings before by no more than its filters do", "[chain]")
{
    for (const double fullScale : {1.0, 100.0})
        for (const double trim : {0.01, 1.0, 16.0})
            for (const auto mode : {Mode::linearize, Mode::speaker}) {
                CAPTURE(fullScale, trim, name(mode));
                auto some = controls(mode);
                some.fullScale = fullScale;
                some.trim = trim;
                some.predistortion.amount = 0.0;
                Chain chain(linearPart(everything()), {48000.0, 2}, some);
                std::vector<double> u(4800, 0.5 / fullScale / std::max(1.0, trim));
                const double step = u.front() * trim;
                chain.process(u.data(), u.data(), u.size());
                double before = 0.0;
                for (int n = 0; n < chain.latency() - 1; ++n)
                    before = std::max(before, std::abs(u[static_cast<std::size_t>(n)]));
                CHECK(before < 0.15 * step);
            }
}

TEST_CASE("The sound of a linearized loudspeaker is not cut at the limit of its voltage", "[chain]")
{
    // A high-pass makes the edges of a low tone's square nearly twice as high.
    const auto model = linearPart(everything());
    std::vector<double> square(48000);
    for (std::size_t n = 0; n < square.size(); ++n)
        for (int k = 1; k < 40; k += 2)
            square[n] += 0.5 * std::sin(2.0 * std::numbers::pi * 25.0 * k * static_cast<double>(n) / 48000.0) / k;
    const auto heard = [&](double limit) {
        auto some = controls(Mode::audition);
        some.fullScale = 1.0;
        some.predistortion.voltageLimit = limit;
        Chain chain(model, {48000.0, 2}, some);
        return through(chain, square);
    };
    const auto free = heard(1e9);
    REQUIRE(*std::max_element(free.begin(), free.end()) > 0.53);
    CHECK(relativeError(heard(0.48), free) < 1e-9);  // the voltage itself stays below
}
