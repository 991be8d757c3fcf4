// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Datasheet/ThieleSmall.h"

#include "Engine/Datasheet/Impedances.h"
#include "Engine/Error.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/Resonance.h"
#include "Engine/Loudspeaker/Simulate.h"
#include "Engine/Loudspeaker/SmallSignal.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

using namespace excursion;

namespace {

constexpr double pi = std::numbers::pi;

/// A midbass: Re, Le, Bl, m, Rms, K, Sd.
Model midbass(double Le = 3e-4)
{
    auto model = makeModel("electrodynamic");
    const double values[] = {5.6, Le, 7.1, 0.0142, 1.15, 1310.0};
    for (std::size_t k = 0; k < 6; ++k)
        model.components.front().parameters[k].value = values[k];
    model.path.parameters[0].value = 0.0133;
    return model;
}

Model withNumbers(Model model, const std::string& effect, const std::vector<double>& numbers)
{
    const OperatingRange operatingRange {.displacement = 2e-3,
                                         .velocity = 0.5,
                                         .current = 2.0,
                                         .lowFrequency = 15.0,
                                         .highFrequency = 5000.0,
                                         .degree = 2};
    model = withEffect(std::move(model), effectNamed(effect), operatingRange);
    for (std::size_t k = 0; k < numbers.size(); ++k)
        model.components.back().parameters[k].value = numbers[k];
    return model;
}

const DatasheetFigure& figureNamed(const std::vector<DatasheetFigure>& figures, std::string_view symbol)
{
    const auto found = std::find_if(figures.begin(), figures.end(),
                                    [&](const DatasheetFigure& figure) { return figure.symbol == symbol; });
    REQUIRE(found != figures.end());
    return *found;
}

double valueOf(const std::vector<DatasheetFigure>& figures, const char* symbol)
{
    return figureNamed(figures, symbol).value;
}

std::complex<double> impedance(const Model& model, double frequency)
{
    return 1.0 / respond(model, {Quantity::current}, {frequency}).front().value[0];
}

double bisect(double low, double high, const std::function<double(double)>& f)
{
    const bool rising = f(high) > 0.0;
    for (int k = 0; k < 100; ++k) {
        const double middle = 0.5 * (low + high);
        ((f(middle) > 0.0) == rising ? high : low) = middle;
    }
    return 0.5 * (low + high);
}

}  // namespace

TEST_CASE("Thiele/Small parameters of the base are the closed forms", "[datasheet]")
{
    const auto figures = thieleSmall({midbass(), false, false});
    const double Re = 5.6, Bl = 7.1, m = 0.0142, Rms = 1.15, K = 1310.0, Sd = 0.0133, w = std::sqrt(K / m), c = 343.0,
                 rho = 1.2;
    CHECK(valueOf(figures, "Re") == 5.6);
    CHECK(valueOf(figures, "Le") == Approx(3e-4).epsilon(1e-12));
    CHECK(valueOf(figures, "fs") == Approx(w / (2.0 * pi)).epsilon(1e-12));
    CHECK(valueOf(figures, "Mms") == Approx(m).epsilon(1e-10));
    CHECK(valueOf(figures, "Cms") == Approx(1.0 / K).epsilon(1e-10));
    CHECK(valueOf(figures, "Rms") == Approx(Rms).epsilon(1e-10));
    const double Qms = w * m / Rms, Qes = w * m * Re / (Bl * Bl), fs = w / (2.0 * pi), Vas = rho * c * c * Sd * Sd / K;
    CHECK(valueOf(figures, "Qms") == Approx(Qms).epsilon(1e-10));
    CHECK(valueOf(figures, "Qes") == Approx(Qes).epsilon(1e-10));
    CHECK(valueOf(figures, "Qts") == Approx(Qms * Qes / (Qms + Qes)).epsilon(1e-10));
    CHECK(valueOf(figures, "Vas") == Approx(Vas).epsilon(1e-10));
    // Small's form of the efficiency, and what it makes at 1 m of a half space: p^2 = rho c P/(2 pi).
    const double eta0 = 4.0 * pi * pi / (c * c * c) * fs * fs * fs * Vas / Qes;
    CHECK(valueOf(figures, "eta0") == Approx(eta0).epsilon(1e-9));
    const double watt = 10.0 * std::log10(rho * c * eta0 / (2.0 * pi) / (20e-6 * 20e-6));
    CHECK(valueOf(figures, "SPL 1W") == Approx(watt).epsilon(1e-9));
    CHECK(valueOf(figures, "SPL 2.83V") == Approx(watt + 10.0 * std::log10(2.83 * 2.83 / Re)).epsilon(1e-9));
    // In the mass-controlled band the model itself plays that loud, but for Le.
    auto pure = midbass(1e-9);
    pure.microphoneDistance = 1.0;
    const double played = std::abs(respond(pure, {Quantity::pressure}, {40.0 * fs}).front().value[0]) * 2.83;
    CHECK(20.0 * std::log10(played / 20e-6) == Approx(valueOf(figures, "SPL 2.83V")).margin(0.02));
}

TEST_CASE("Thiele/Small parameters agree with those read off the impedance", "[datasheet]")
{
    // The classic method: Re at zero, Zmax at fs, and f1, f2 where |Z| = (Re Zmax)^1/2.
    const auto model = midbass(1e-12);
    const auto size = [&](double f) { return std::abs(impedance(model, f)); };
    const double low = 5.0, high = 500.0;
    const double fs = bisect(low, high, [&](double f) { return -impedance(model, f).imag(); });
    const double Re = size(1e-4), most = size(fs), r0 = most / Re, between = std::sqrt(Re * most);
    const double f1 = bisect(low, fs, [&](double f) { return size(f) - between; }),
                 f2 = bisect(fs, high, [&](double f) { return size(f) - between; });
    const double Qms = fs * std::sqrt(r0) / (f2 - f1), Qes = Qms / (r0 - 1.0);
    const auto figures = thieleSmall({model, false, false});
    CHECK(valueOf(figures, "fs") == Approx(fs).epsilon(1e-8));
    CHECK(valueOf(figures, "Re") == Approx(Re).epsilon(1e-6));
    CHECK(valueOf(figures, "Qms") == Approx(Qms).epsilon(1e-6));
    CHECK(valueOf(figures, "Qes") == Approx(Qes).epsilon(1e-6));
    CHECK(valueOf(figures, "Qts") == Approx(Qms / r0).epsilon(1e-6));
}

TEST_CASE("A suspension that creeps has its compliance at the resonance", "[datasheet]")
{
    const auto model = withNumbers(midbass(1e-12), "creep", {500.0, 1.0, 3.0, 0.0});
    const auto figures = thieleSmall({model, false, false});
    // Without Le the impedance is real where the mechanics are, and its peak over Re is Bl^2/Rms there.
    const double f0 = resonanceOf(model.base().parameters),
                 fs = bisect(0.9 * f0, 2.0 * f0, [&](double f) { return -impedance(model, f).imag(); });
    CHECK(fs > 1.05 * f0);
    CHECK(valueOf(figures, "fs") == Approx(fs).epsilon(1e-8));
    CHECK(valueOf(figures, "Rms") == Approx(7.1 * 7.1 / (impedance(model, fs).real() - 5.6)).epsilon(1e-8));
    CHECK(valueOf(figures, "Mms") == Approx(0.0142).epsilon(1e-8));
    CHECK(valueOf(figures, "Cms") < 1.0 / 1310.0);
}

TEST_CASE("The resonance is found where creep has all of the stiffness at rest", "[datasheet]")
{
    auto model = withNumbers(midbass(1e-12), "creep", {1310.0, 0.9, 2.0, -0.25});
    model.baseParameter("K").value = 0.2;
    const double fs = bisect(20.0, 60.0, [&](double f) { return -impedance(model, f).imag(); });
    CHECK(resonanceOf(model) == Approx(fs).epsilon(0.05));
    const auto figures = thieleSmall({model, false, false});
    CHECK(valueOf(figures, "fs") == Approx(fs).epsilon(1e-8));
    CHECK(valueOf(figures, "Mms") == Approx(0.0142).epsilon(1e-8));
}

TEST_CASE("What swings far above the resonance is moving mass, and a box is left out", "[datasheet]")
{
    const auto side = thieleSmall({withNumbers(midbass(), "side-resonance", {0.001, 2000.0, 0.2}), false, false});
    CHECK(valueOf(side, "Mms") == Approx(0.0152).epsilon(1e-3));
    CHECK(valueOf(side, "fs") == Approx(std::sqrt(1310.0 / 0.0152) / (2.0 * pi)).epsilon(1e-3));
    const auto boxed = thieleSmall({withNumbers(midbass(), "vented-box", {900.0, 45.0, 0.02, 0.1}), false, false}),
               free = thieleSmall({midbass(), false, false});
    for (std::size_t k = 0; k < free.size(); ++k)
        CHECK(boxed[k].value == free[k].value);
}

TEST_CASE("Standard errors follow the covariance", "[datasheet]")
{
    auto model = midbass();
    model.path.parameters[0].free = true;
    const auto theta = parameterVector(model);
    model.covariance = Eigen::MatrixXd::Zero(theta.size(), theta.size());
    const double share[] = {1e-3, 2e-3, 3e-3, 4e-3, 5e-3, 6e-3, 7e-3, 0.0};
    for (Eigen::Index k = 0; k < theta.size(); ++k)
        model.covariance(k, k) = std::pow(share[k] * theta[k], 2);
    model.covariance(2, 3) = model.covariance(3, 2) = 0.8 * share[2] * theta[2] * share[3]
                                                      * theta[3];  // Bl and m err together
    const auto figures = thieleSmall({model, false, false});
    const auto relative = [&](const char* symbol) {
        return figureNamed(figures, symbol).standardError / figureNamed(figures, symbol).value;
    };
    CHECK(relative("Re") == Approx(1e-3).epsilon(1e-5));
    CHECK(relative("Le") == Approx(2e-3).epsilon(1e-5));
    CHECK(relative("fs") == Approx(0.5 * std::hypot(4e-3, 6e-3)).epsilon(1e-4));
    CHECK(relative("Qms") == Approx(std::hypot(std::hypot(2e-3, 3e-3), 5e-3)).epsilon(1e-4));
    // Qes = (K m)^1/2 Re/Bl^2
    CHECK(relative("Qes")
          == Approx(std::sqrt(3e-3 * 3e-3 + 2e-3 * 2e-3 + 1e-6 + 6e-3 * 6e-3 - 2.0 * 2.0 * 0.5 * 0.8 * 3e-3 * 4e-3))
                 .epsilon(1e-4));
    CHECK(relative("Vas") == Approx(std::hypot(2.0 * 7e-3, 6e-3)).epsilon(1e-4));
    CHECK(relative("Sd") == Approx(7e-3).epsilon(1e-5));
    model.covariance(3, 3) = std::numeric_limits<double>::quiet_NaN();
    const auto unseen = thieleSmall({model, false, false});
    CHECK(std::isnan(figureNamed(unseen, "fs").standardError));
    CHECK(figureNamed(unseen, "Re").standardError == Approx(5.6e-3).epsilon(1e-5));
    model.covariance.resize(0, 0);
    for (const auto& figure : thieleSmall({model, false, false}))
        CHECK(std::isnan(figure.standardError));
}

TEST_CASE("Where losses in the iron stand in for a part of Re, the coil's resistance is that of the lowest frequency",
          "[datasheet]")
{
    auto model = withNumbers(midbass(), "eddy-currents", {0.3, 0.4});
    const double low = blockedImpedance(model, {15.0}).front().real();
    CHECK(low > 6.0);
    const auto count = parameterVector(model).size();
    model.covariance = Eigen::MatrixXd::Zero(count, count);
    model.covariance(0, 0) = std::pow(0.01 * 5.6, 2);
    CHECK(valueOf(thieleSmall({model, false, false}), "Re") == 5.6);
    model.covariance(0, 0) = std::pow(0.5 * 5.6, 2);
    const auto figures = thieleSmall({model, false, false});
    CHECK(valueOf(figures, "Re") == Approx(low));
    const double w = 2.0 * pi * valueOf(figures, "fs");
    CHECK(valueOf(figures, "Qes") == Approx(w * valueOf(figures, "Mms") * low / (7.1 * 7.1)));
}

TEST_CASE("What the take does not show is not said", "[datasheet]")
{
    auto model = midbass();
    model.components.front().parameters[3].free = false;  // the mass is held by convention
    model.path.parameters[0].value = 0.01;
    const auto known = [](const std::vector<DatasheetFigure>& figures) {
        std::string list;
        for (const auto& figure : figures)
            if (figure.why.empty()) {
                CHECK(std::isfinite(figure.value));
                list += figure.symbol + " ";
            } else {
                CHECK(std::isnan(figure.value));
            }
        return list;
    };
    CHECK(known(thieleSmall(withKnown(model, {}))) == "Re Le fs Qms Qes Qts ");
    CHECK(known(thieleSmall(withKnown(model, {.mass = 0.02}))) == "Re Le Bl Mms Cms Rms fs Qms Qes Qts ");
    CHECK(known(thieleSmall(withKnown(model, {.coneArea = 0.02}))) == "Re Le fs Qms Qes Qts Sd ");
    const auto all = thieleSmall(withKnown(model, {.forceFactor = 10.0, .coneArea = 0.01}));
    CHECK(known(all) == "Re Le Bl Mms Cms Rms fs Qms Qes Qts Sd Vas eta0 SPL 1W SPL 2.83V ");
    CHECK(valueOf(all, "Bl") == Approx(10.0));
    CHECK(valueOf(all, "Mms") == Approx(0.0142 * std::pow(10.0 / 7.1, 2)));
    const auto heavy = thieleSmall(withKnown(model, {.mass = 0.02}));
    CHECK(valueOf(heavy, "Mms") == Approx(0.02));
    CHECK(valueOf(heavy, "Qes") == Approx(valueOf(all, "Qes")));
    CHECK_THROWS_AS(withKnown(model, {.mass = 0.02, .forceFactor = 10.0}), Error);
    CHECK_THROWS_AS(withKnown(model, {.mass = -0.02}), Error);
    CHECK_THROWS_AS(withKnown(model, {.coneArea = std::numeric_limits<double>::infinity()}), Error);
    CHECK_THROWS_AS(withKnown(midbass(), {.mass = 0.02}), Error);

    // Where the sound was measured, it tells Sd/Mms^1/2, and so Vas and the sensitivity.
    model.path.parameters[0].free = true;
    CHECK(known(thieleSmall(withKnown(model, {}))) == "Re Le fs Qms Qes Qts Vas eta0 SPL 1W SPL 2.83V ");

    const auto mechanical = thieleSmall(withKnown(makeModel("mechanical"), {}));
    CHECK(known(mechanical) == "Mms Cms Rms fs Qms ");
    CHECK(figureNamed(mechanical, "Qts").why == "the model has no coil");
}

TEST_CASE("Another motion is not seen by the coil", "[datasheet]")
{
    auto model = withNumbers(
        withNumbers(withNumbers(midbass(), "stiffness", {120.0, 300.0}), "force-factor", {0.3, -0.6}), "creep",
        {300.0, 1.0, 2.0, 0.1});
    model = withNumbers(withNumbers(model, "friction", {0.2, 2e-4, 0.5}), "side-resonance", {0.001, 900.0, 0.2});
    model.path.parameters[0].free = true;
    const auto other = withMotion(model, 0.6);
    CHECK(other.baseParameter("m").value == Approx(0.0142 / 0.36));
    std::vector<double> voltage;
    for (int n = 0; n < 3000; ++n)
        voltage.push_back(6.0 * std::sin(2.0 * pi * 45.0 * n / 16000.0) * std::min(1.0, n / 400.0));
    const auto a = simulate(model, voltage, 16000.0, {}), b = simulate(other, voltage, 16000.0, {});
    for (const auto quantity : {Quantity::current, Quantity::pressure, Quantity::displacement}) {
        const double factor = quantity == Quantity::displacement ? 0.6 : 1.0;
        double worst = 0.0, most = 0.0;
        for (std::size_t n = 0; n < voltage.size(); ++n) {
            const double one = a.find(quantity)->samples[n], two = b.find(quantity)->samples[n];
            worst = std::max(worst, std::abs(factor * one - two));
            most = std::max(most, std::abs(two));
        }
        CHECK(worst < 1e-6 * most);
    }
}

TEST_CASE("A motion alone tells no figure that hangs on the coil")
{
    ScaledModel given {midbass()};
    given.model.baseParameter("Re").free = false;
    const auto told = [&](const char* symbol) {
        const auto figures = thieleSmall(given);
        const auto& figure = figureNamed(figures, symbol);
        CHECK(std::isnan(figure.value) == !figure.why.empty());
        return figure.why.empty();
    };
    for (const char* symbol : {"fs", "Qms", "Qes", "Qts"})  // laws have told the coil's share of the damping
        CHECK(told(symbol));
    for (const char* symbol : {"Re", "Mms", "Cms", "Rms"})
        CHECK_FALSE(told(symbol));
    given.model.baseParameter("Rms").free = false;
    for (const char* symbol : {"fs", "Qts"})
        CHECK(told(symbol));
    for (const char* symbol : {"Re", "Mms", "Qms", "Qes", "Bl"})
        CHECK_FALSE(told(symbol));
}
