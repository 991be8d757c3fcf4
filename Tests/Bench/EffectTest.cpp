// SPDX-License-Identifier: GPL-3.0-or-later
#include "Bench/Draw.h"
#include "Bench/Fixture.h"
#include "Bench/Run.h"

#include <catch2/catch.hpp>

using namespace excursion;
using namespace excursion::bench;

namespace {

Loudspeaker with(const std::string& effect, double strength, const BenchSetup& setup)
{
    Loudspeaker speaker;
    Random random(7, 3);
    addEffect(speaker, {effect, strength}, visit(speaker, setup), setup, random);
    return speaker;
}

}  // namespace

TEST_CASE("halving the step changes less than -100 dB", "[bench][slow]")
{
    auto setup = quietSetup();
    for (const auto& id : effectIds()) {
        INFO(id);
        const auto speaker = with(id, 0.4, setup);
        const auto normal = measure(speaker, setup);
        auto finer = setup;
        finer.oversampling = 2 * defaultOversampling(speaker, setup.sampleRate);
        const auto refined = measure(speaker, finer);
        for (const auto quantity : setup.channels) {
            INFO(name(quantity));
            CHECK(difference(normal, refined, quantity).band < -100.0);
        }
    }
}

TEST_CASE("every effect plays, and changes what is heard or measured", "[bench]")
{
    auto setup = quietSetup();
    setup.excitation.period = 2048;
    setup.excitation.bandLow = 60.0;
    const auto linear = measure(Loudspeaker {}, setup);
    for (const auto& id : effectIds()) {
        INFO(id);
        const auto take = measure(with(id, 0.4, setup), setup);
        CHECK(difference(take, linear, Quantity::pressure).band > -70.0);
        for (const auto& channel : take.channels)
            CHECK(
                std::all_of(channel.samples.begin(), channel.samples.end(), [](double s) { return std::isfinite(s); }));
    }
}

TEST_CASE("an effect shows in the channels it should", "[bench][slow]")
{
    using enum Quantity;
    const auto setup = quietSetup();
    const auto linear = measure(Loudspeaker {}, setup);
    CHECK(distortion(linear, current, true) < -110.0);
    CHECK(distortion(linear, pressure, false) < -110.0);

    for (const std::string id :
         {"force-factor", "stiffness", "inductance-position", "inductance-current", "damping-velocity", "friction"}) {
        INFO(id);
        const auto take = measure(with(id, 0.5, setup), setup);
        for (const auto quantity : {current, displacement})
            CHECK(std::max(distortion(take, quantity, true), distortion(take, quantity, false)) > -75.0);
    }
    for (const std::string id : {"eddy-currents", "creep", "vented-box", "side-resonance"}) {
        INFO(id);
        const auto take = measure(with(id, 0.5, setup), setup);
        CHECK(difference(take, linear, current).band > -45.0);
        CHECK(distortion(take, current, true) < -60.0);  // linear, but for memories that have not settled
    }
    const auto hot = measure(with("coil-heating", 0.5, setup), setup);
    CHECK(difference(hot, linear, current).band > -45.0);
    for (const std::string id : {"doppler", "cone-breakup"}) {
        INFO(id);
        const auto take = measure(with(id, 0.5, setup), setup);
        CHECK(difference(take, linear, current).band < -150.0);
        CHECK(difference(take, linear, displacement).band < -150.0);
        CHECK(difference(take, linear, pressure).band > -60.0);
    }
    const auto moving = measure(with("doppler", 0.5, setup), setup);
    CHECK(distortion(moving, pressure, false) > -70.0);  // product of x and da/dt: even
}

TEST_CASE("the reluctance force pulls the coil in", "[bench]")
{
    auto setup = quietSetup();
    setup.excitation.levels = {15.0};
    Loudspeaker speaker;
    speaker.Le = 2e-3;
    speaker.inductancePosition = Curve {Curve::Shape::tanhStep, 0.0, 2e-3, 0.7, 0.0};  // Le falls outward
    const auto take = measure(speaker, setup);
    CHECK(lastPeriod(take, Quantity::displacement)[0].real() < 0.0);
}

TEST_CASE("a coil heats towards its steady temperature", "[bench]")
{
    Loudspeaker speaker;
    speaker.coilHeating = CoilHeating {0.0039, 0.05, 4.0, 1e6, 1.0};  // 0.2 s
    std::vector<double> voltage(96000, 0.0);
    for (std::size_t n = 0; n < voltage.size(); ++n)
        voltage[n] = 5.0 * std::sqrt(2.0) * std::sin(0.05 * static_cast<double>(n)) * (n < 90000 ? 1.0 : 0.0);
    const auto record = run(speaker, std::span(voltage).first(90000), 48000.0, {Quantity::current}, 0.3, 5.0);
    // T = R Re(T) I^2 with |Z| close to Re at 382 Hz: 4 K/W of about 7 W, and Re a tenth higher
    CHECK(record.coilTemperature > 20.0);
    CHECK(record.coilTemperature < 30.0);
}

TEST_CASE("Loops that move with the coil let go of their flux within a few periods of the lowest tone")
{
    int moving = 0;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
        bench::DrawOptions options;
        options.seconds = 1.0;
        options.hidden = {{"eddy-currents", 0.0}, {"inductance-position", 0.0}};
        const auto drawn = bench::draw(seed, options);
        const auto& eddy = drawn.speaker.eddyCurrents.value();
        if (!eddy.moves)
            continue;
        ++moving;
        REQUIRE(!eddy.cells.empty());
        for (const auto& cell : eddy.cells)
            CHECK(cell.rate >= 0.99 * 2.0 * std::numbers::pi * drawn.setup.excitation.bandLow / 30.0);
    }
    CHECK(moving > 2);
}
