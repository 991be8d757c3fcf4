// SPDX-License-Identifier: GPL-3.0-or-later
// Ladders of impedances in closed form: what hides behind something else is found with it, and what is not there is
// not.
#include "Engine/Diagnosis/Improve.h"
#include "Engine/Diagnosis/Improvement.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

using namespace excursion;

namespace {

using Complex = std::complex<double>;

/// Several impedances that share a voltage, or mechanical ones that share a force.
Complex parallel(Complex a, Complex b) { return a * b / (a + b); }

/// A woofer as its parts are: a coil with a chain of resistors beside inductors, a cone on a suspension, and what its
/// motion feels besides.
struct Woofer {
    bool port = false, part = false, leak = false, eddies = true;

    Complex impedance(double frequency) const
    {
        const Complex s(0.0, 2.0 * std::numbers::pi * frequency);
        Complex coil = 5.8 + 1.5e-4 * s;
        for (const auto& [R, L] : {std::pair {1.1, 6e-4}, {3.0, 2.2e-4}, {19.0, 4e-4}})
            coil += eddies ? parallel(R, s * L) : 0.0;
        const double Bl = 7.2, m = 0.018, K = 1100.0;
        Complex mechanical = 1.4 + s * m + K / s;
        if (port) {  // air whose pressure moves the mass in a port of 33 Hz and leaks
            const double stiffness = 2400.0, mass = stiffness / std::pow(2.0 * std::numbers::pi * 33.0, 2);
            mechanical += parallel(stiffness / s, parallel(s * mass + 0.04 * std::sqrt(stiffness * mass),
                                                           12.0 * std::sqrt(stiffness * mass)));
        }
        if (leak) {  // a closed box, whose air gets out below 7 Hz through a narrow tube
            const double stiffness = 4000.0, mass = stiffness / std::pow(2.0 * std::numbers::pi * 7.0, 2);
            mechanical += parallel(stiffness / s, s * mass + std::sqrt(stiffness * mass) / 0.8);
        }
        if (part) {  // a surround of 0.9 g that swings at 640 Hz
            const double mass = 9e-4, w = 2.0 * std::numbers::pi * 640.0;
            mechanical += parallel(s * mass, mass * w * w / s + mass * w / 5.0);
        }
        return coil + Bl * Bl / mechanical;
    }

    Spectra measured(double lowest = 10.0) const
    {
        Spectra spectra;
        std::vector<Complex> ohms;
        for (double f = lowest; f < 20000.0; f *= std::exp2(1.0 / 24.0)) {
            spectra.frequency.push_back(f);
            const auto n = static_cast<double>(ohms.size());
            // as rough as measured curves are
            ohms.push_back(impedance(f) * (1.0 + std::polar(3e-3, 2.4 * n * n)));
        }
        spectra.channels = {{Quantity::voltage, "V", ohms},
                            {Quantity::current, "A", std::vector<Complex>(ohms.size(), 1.0)}};
        return spectra;
    }
};

double errorDb(const Rung& rung) { return rung.comparison.channels.front().total.db; }

}  // namespace

TEST_CASE("An effect that is asked for comes in, however little a frequency response gains by it",
          "[improve][responses]")
{
    Improvement work(Woofer {.eddies = false}.measured());
    work.begin();
    const auto added = [&](const std::string& id) {
        CAPTURE(id);
        auto other = work;
        other.add(id);
        CHECK(other.ladder().model().has(id));
        CHECK(other.ladder().rungs.back().added == id);
        CHECK_THROWS_WITH(other.add(id), Catch::Contains("already"));
    };
    int gainless = 0;
    for (const auto& ranked : work.ladder().rungs.back().diagnosis.ranking)
        if (!ranked.model.has(ranked.effect)) {
            added(ranked.effect);
            ++gainless;
        }
    CHECK(gainless > 0);  // else this asks nothing
    added(work.ladder().rungs.back().diagnosis.ranking.front().effect);
}

TEST_CASE("A port and a part that swings are found together, and neither where it is not",
          "[.thorough][improve][responses]")
{
    for (const auto& woofer : {Woofer {true, true}, Woofer {true, false}, Woofer {false, true}}) {
        CAPTURE(woofer.port, woofer.part);
        const auto ladder = improve(woofer.measured());
        const auto effects = ladder.model().effectIds();
        const auto box = std::find(effects.begin(), effects.end(), "vented-box");
        CAPTURE(effects);
        CHECK(errorDb(ladder.rungs.back()) < -46.0);
        CHECK(ladder.model().has("eddy-currents"));
        CHECK((box != effects.end()) == woofer.port);
        CHECK((!woofer.port || box - effects.begin() < 2));
        CHECK(ladder.model().has("side-resonance") == woofer.part);
        CHECK_FALSE(ladder.model().has("creep"));
        // each rung is what the one before asked for, and lowers the error
        for (std::size_t k = 1; k < ladder.rungs.size(); ++k)
            CHECK(errorDb(ladder.rungs[k]) < errorDb(ladder.rungs[k - 1]) - 1.0);
        for (std::size_t k = 0; k + 1 < ladder.rungs.size(); ++k)
            CHECK(ladder.rungs[k].diagnosis.ranking.front().effect == ladder.rungs[k + 1].added);
        if (woofer.port)
            CHECK(ladder.model().find("vented-box")->parameters[1].value == Approx(33.0).epsilon(0.01));
    }
}

TEST_CASE("Air that leaks out of a closed box is told from a suspension that creeps", "[.thorough][improve][responses]")
{
    const auto ladder = improve(Woofer {.leak = true}.measured(1.5));
    CAPTURE(ladder.model().effectIds());
    CHECK(errorDb(ladder.rungs.back()) < -46.0);
    REQUIRE(ladder.model().has("vented-box"));
    CHECK_FALSE(ladder.model().has("creep"));
    CHECK_FALSE(ladder.model().has("side-resonance"));
    // The impedance alone does not tell the mass, nor so the newtons, and of the suspension below the leak it shows
    // little.
    const auto& model = ladder.model();
    const auto& box = *model.find("vented-box");
    const double stiffness = box.parameters[0].value + model.baseParameter("K").value;
    CHECK(stiffness / model.baseParameter("m").value == Approx((4000.0 + 1100.0) / 0.018).epsilon(0.02));
    CHECK(box.parameters[1].value == Approx(7.0).epsilon(0.1));
}
