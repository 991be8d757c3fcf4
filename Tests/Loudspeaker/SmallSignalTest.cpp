// SPDX-License-Identifier: GPL-3.0-or-later
// The linear part of a model against the closed forms that any textbook has.
#include "Loudspeaker/EffectBench.h"

#include "Engine/Error.h"
#include "Engine/Loudspeaker/FitResponse.h"
#include "Engine/Loudspeaker/SmallSignal.h"
#include "Engine/Loudspeaker/Summary.h"

#include <catch2/catch.hpp>

#include <complex>

using namespace excursion;

namespace {

using Complex = std::complex<double>;

constexpr double Re = 3.3, Le = 266e-6, Bl = 4.95, mass = 14.35e-3, Rms = 0.786, K = 1852.0;
constexpr double area = 0.0132, distance = 0.3, tau = 0.9e-3;

Model midbass()
{
    auto model = makeModel("electrodynamic");
    const double values[] = {Re, Le, Bl, mass, Rms, K};
    for (std::size_t k = 0; k < 6; ++k)
        model.components.front().parameters[k].value = values[k];
    model.path.parameters[0].value = area;
    model.path.parameters[1].value = tau;
    model.microphoneDistance = distance;
    return model;
}

/// A model with every effect at work.
Model allAtWork()
{
    auto model = midbass();
    for (const auto* effect : catalogue()) {
        auto operatingRange = someOperatingRange(1.0);
        operatingRange.degree = 3;
        model = withEffect(model, *effect, operatingRange);
        auto& component = model.components.back();
        double sign = 1.0;
        for (auto& p : component.parameters)
            if (p.strength)
                p.value = effect->law()            ? 0.1 * (sign *= -1.0) * component.operatingRange.scale
                          : std::isfinite(p.prior) ? strengthOf(*effect, p, component.operatingRange, 0.3)
                                                   : someScale(*effect);
    }
    return model;
}

std::vector<double> someFrequencies()
{
    std::vector<double> result;
    for (double f = 15.0; f < 8000.0; f *= 1.37)
        result.push_back(f);
    return result;
}

double relative(Complex value, Complex truth) { return std::abs(value - truth) / std::abs(truth); }

}  // namespace

TEST_CASE("The responses of the electrodynamic driver are their closed forms", "[small-signal]")
{
    using enum Quantity;
    const auto frequency = someFrequencies();
    const auto response = respond(midbass(), {current, displacement, velocity, acceleration, pressure}, frequency);
    REQUIRE(response.size() == 5);
    for (std::size_t n = 0; n < frequency.size(); ++n) {
        INFO(frequency[n] << " Hz");
        const Complex s(0.0, 2.0 * std::numbers::pi * frequency[n]);
        const Complex mechanical = mass * s * s + Rms * s + K;
        const Complex i = 1.0 / (Re + s * Le + Bl * Bl * s / mechanical), x = Bl * i / mechanical;
        CHECK(relative(response[0].value[n], i) < 1e-10);
        CHECK(relative(response[1].value[n], x) < 1e-10);
        CHECK(relative(response[2].value[n], s * x) < 1e-10);
        CHECK(relative(response[3].value[n], s * s * x) < 1e-10);
        CHECK(relative(response[4].value[n],
                       1.2 * area / (2.0 * std::numbers::pi * distance) * s * s * x * std::exp(-s * tau))
              < 1e-10);
        CHECK(response[0].gradient.size() == 0);
    }
}

TEST_CASE("The response of the mechanical driver is its closed form, and it has no current", "[small-signal]")
{
    auto model = makeModel("mechanical");
    model.baseParameter("m").value = mass;
    model.baseParameter("Rms").value = Rms;
    model.baseParameter("K").value = K;
    const auto frequency = someFrequencies();
    const auto response = respond(model, {Quantity::displacement, Quantity::current}, frequency);
    for (std::size_t n = 0; n < frequency.size(); ++n) {
        const Complex s(0.0, 2.0 * std::numbers::pi * frequency[n]);
        CHECK(relative(response[0].value[n], 1.0 / (mass * s * s + Rms * s + K)) < 1e-10);
        CHECK(response[1].value[n] == 0.0);
    }
}

TEST_CASE("Laws that are zero at rest leave the linear part alone", "[small-signal]")
{
    auto bent = midbass();
    for (const auto* effect : catalogue())
        if (effect->law()) {
            bent = withEffect(bent, *effect, someOperatingRange(1.0));
            auto& component = bent.components.back();
            for (auto& p : component.parameters)
                p.value = 0.1 * component.operatingRange.scale;
        }
    REQUIRE(bent.components.size() > 1);
    const auto straight = smallSignal(midbass()), linear = smallSignal(bent);
    const auto n = straight.A.rows(), memories = linear.A.rows() - n;
    CHECK((linear.A.topLeftCorner(n, n) - straight.A).norm() < 1e-6 * straight.A.norm());
    CHECK(linear.A.topRightCorner(n, memories).norm() < 1e-6 * straight.A.norm());
    CHECK((linear.B.head(n) - straight.B).norm() < 1e-6 * straight.B.norm());
    CHECK(linear.B.tail(memories).norm() == 0.0);
}

TEST_CASE("An effect of no strength changes no response, whatever it stands beside", "[small-signal]")
{
    using enum Quantity;
    const std::vector<Quantity> quantities {current, displacement, pressure};
    const auto frequency = someFrequencies();
    for (const auto* atWork : catalogue()) {
        if (!atWork->linear())
            continue;
        const auto only = linearPart(allAtWork());
        auto model = midbass();
        for (const auto& component : only.components)
            if (component.effect == atWork)
                model.components.push_back(component);
        const auto alone = respond(model, quantities, frequency);
        for (const auto* other : catalogue()) {
            if (!other->linear() || other == atWork)
                continue;
            const auto beside = respond(withEffect(model, *other, someOperatingRange(1.0)), quantities, frequency);
            for (std::size_t q = 0; q < quantities.size(); ++q)
                for (std::size_t n = 0; n < frequency.size(); ++n) {
                    INFO(atWork->id() << " beside " << other->id() << ", " << name(quantities[q]) << ", "
                                      << frequency[n] << " Hz");
                    CHECK(relative(beside[q].value[n], alone[q].value[n]) < 1e-9);
                }
        }
    }
}

TEST_CASE("A driver is stable with every effect at work, and not with a resistance that drives it", "[small-signal]")
{
    CHECK(isStable(midbass()));
    CHECK(isStable(allAtWork()));
    CHECK(isStable(makeModel("mechanical")));
    auto driven = midbass();
    driven.baseParameter("Bl").value = 0.0;
    driven.baseParameter("Rms").value = -0.1;
    CHECK_FALSE(isStable(driven));
    driven.baseParameter("m").value = 0.0;
    CHECK_FALSE(isStable(driven));
}

TEST_CASE("Gradients of the responses are what finite differences show, by every parameter", "[small-signal]")
{
    using enum Quantity;
    const std::vector<Quantity> quantities {current, displacement, pressure};
    const auto frequency = someFrequencies();
    const auto model = allAtWork();
    const auto response = respond(model, quantities, frequency, true);
    const auto theta = parameterVector(model);
    for (Eigen::Index k = 0; k < theta.size(); ++k) {
        const double step = 1e-4 * std::max(std::abs(theta[k]), 2e-4);
        const auto moved = [&](double by) {
            auto there = model;
            auto changed = theta;
            changed[k] += by;
            setParameterVector(there, changed);
            return respond(there, quantities, frequency);
        };
        const auto above = moved(step), below = moved(-step);
        for (std::size_t q = 0; q < quantities.size(); ++q)
            for (std::size_t n = 0; n < frequency.size(); ++n) {
                INFO(parametersOf(model)[static_cast<std::size_t>(k)]->name << ", " << name(quantities[q]) << ", "
                                                                            << frequency[n] << " Hz");
                const Complex slope = (above[q].value[n] - below[q].value[n]) / (2.0 * step);
                const Complex gradient = response[q].gradient(static_cast<Eigen::Index>(n), k);
                const double rounding = 1e-9 * std::abs(response[q].value[n]) / step;
                CHECK(std::abs(gradient - slope) < 3e-5 * std::abs(slope) + rounding);
            }
    }
}

TEST_CASE("A driver has no response of its input", "[small-signal]")
{
    CHECK_THROWS_AS(respond(midbass(), {Quantity::voltage}, {100.0}), Error);
    CHECK_THROWS_AS(respond(midbass(), {Quantity::force}, {100.0}), Error);
}

TEST_CASE("The ladder of the eddy currents is K s^a within its accuracy over its band", "[effects]")
{
    constexpr double strength = 0.05, accuracy = 3.5e-4;
    for (const double high : {2000.0, 8000.0, 20000.0})
        for (const double a : {0.3, 0.5, 0.6, 0.75, 0.9, 0.98}) {
            auto operatingRange = someOperatingRange(1.0);
            operatingRange.highFrequency = high;
            auto model = withEffect(midbass(), effectNamed("eddy-currents"), operatingRange);
            model.baseParameter("Bl").value = 0.0;  // a blocked coil
            model.components.back().parameters[0].value = strength;
            model.components.back().parameters[1].value = a;
            std::vector<double> frequency;
            for (double f = operatingRange.lowFrequency; f <= high; f *= 1.05)
                frequency.push_back(f);
            const auto current = respond(model, {Quantity::current}, frequency).front().value;
            double worst = 0.0;
            for (std::size_t n = 0; n < frequency.size(); ++n) {
                const Complex s(0.0, 2.0 * std::numbers::pi * frequency[n]);
                worst = std::max(worst, relative(1.0 / current[n] - Re - s * Le, strength * std::pow(s, a)));
            }
            INFO("a " << a << ", up to " << high << " Hz");
            CHECK(worst < accuracy);
        }
}

TEST_CASE("The eddy currents follow a chain of few resistors and inductors that is far from a power law", "[effects]")
{
    // Cells well inside the band, off any power law by 40 %; the ladder finds them from the impedance of the blocked
    // coil.
    struct Cell {
        double resistance, inductance;
    };
    const Cell chain[] {{0.5, 0.4e-3}, {2.0, 0.3e-3}, {1.5, 0.05e-3}};
    std::vector<double> frequency;
    for (double f = 15.0; f <= 8000.0; f *= 1.04)
        frequency.push_back(f);
    ResponseTarget target;
    target.impedance = true;
    target.frequency = frequency;
    for (const double f : frequency) {
        const Complex s(0.0, 2.0 * std::numbers::pi * f);
        Complex Z = Re + s * Le;
        for (const auto& cell : chain)
            Z += cell.resistance * s * cell.inductance / (cell.resistance + s * cell.inductance);
        target.value.push_back(Z);
        target.deviation.push_back(1e-4 * std::abs(Z));
    }
    auto model = midbass();
    model.baseParameter("Bl").value = 1e-6;
    for (const char* held : {"Bl", "m", "Rms", "K"})
        model.baseParameter(held).free = false;
    REQUIRE(addByResponse(model, effectNamed("eddy-currents"), {target}).usable());
    INFO("error " << responseErrorDb(model, target) << " dB");
    CHECK(responseErrorDb(model, target) < -65.0);
    const auto figures = figuresOf(model, 1);
    REQUIRE(figures.size() == 3);
    CHECK(figures[2].value > 5.0);  // percent off a power law
    for (const auto& figure : figures)
        CHECK(figure.standardError < 0.1 * figure.value);
}

TEST_CASE("An effect is sought in the whole band, whichever response comes first", "[effects]")
{
    // A motion counts up to where the cone moves as one piece, an impedance further.
    std::vector<double> low, high;
    for (double f = 20.0; f < 12000.0; f *= 1.05)
        (f < 800.0 ? low : high).push_back(f);
    high.insert(high.begin(), low.begin(), low.end());
    auto truth = withEffect(midbass(), effectNamed("eddy-currents"), someOperatingRange(1.0));
    ResponseTarget velocity {Quantity::velocity, false, low, {}, {}}, impedance {Quantity::current, true, high, {}, {}};
    velocity.value = respond(truth, {Quantity::velocity}, low).front().value;
    const auto current = respond(truth, {Quantity::current}, high);
    for (const auto& admittance : current.front().value)
        impedance.value.push_back(1.0 / admittance);
    for (auto* target : {&velocity, &impedance})
        for (const auto& value : target->value)
            target->deviation.push_back(1e-3 * std::abs(value));
    for (const auto& targets : {std::vector {velocity, impedance}, std::vector {impedance, velocity}}) {
        auto model = midbass();
        REQUIRE(addByResponse(model, effectNamed("eddy-currents"), targets).usable());
        CHECK(model.components.back().operatingRange.lowFrequency == low.front());
        CHECK(model.components.back().operatingRange.highFrequency == high.back());
    }
}

TEST_CASE("What an effect sums up to is its law where nothing departs from it", "[effects]")
{
    auto model = withEffect(midbass(), effectNamed("eddy-currents"), someOperatingRange(1.0));
    model.components.back().parameters[0].value = 0.05;
    model.components.back().parameters[1].value = 0.6;
    const auto figures = figuresOf(model, 1);
    REQUIRE(figures.size() == 3);
    CHECK(figures[0].value == Approx(0.05).epsilon(1e-3));
    CHECK(figures[1].value == Approx(0.6).epsilon(1e-3));
    CHECK(figures[2].value < 0.05);
    CHECK(std::isnan(figures[0].standardError));
    CHECK(figuresOf(model, 0).empty());
}

TEST_CASE("Creep is a sum of relaxing springs, stiffer the faster it is stretched", "[effects]")
{
    constexpr double S = 900.0, centre = 0.7, width = 2.0;
    auto model = makeModel("mechanical");
    const double m = model.baseParameter("m").value, r = model.baseParameter("Rms").value,
                 k = model.baseParameter("K").value;
    model = withEffect(model, effectNamed("creep"), someOperatingRange(1.0));
    const double values[] = {S, centre, width};
    for (std::size_t n = 0; n < 3; ++n)
        model.components.back().parameters[n].value = values[n];
    const int cells = effectNamed("creep").memorySize(model.components.back().operatingRange);
    std::vector<double> frequency;
    for (double f = 1e-3; f < 1e4; f *= 1.9)
        frequency.push_back(f);
    const auto receptance = respond(model, {Quantity::displacement}, frequency).front().value;
    double before = 0.0;
    for (std::size_t n = 0; n < frequency.size(); ++n) {
        INFO(frequency[n] << " Hz");
        const Complex s(0.0, 2.0 * std::numbers::pi * frequency[n]);
        const Complex stiffness = 1.0 / receptance[n] - m * s * s - r * s;
        Complex truth = k;
        for (int cell = 0; cell < cells; ++cell) {
            const double rate = 2.0 * std::numbers::pi * std::pow(10.0, centre + width * ((cell + 0.5) / cells - 0.5));
            truth += S / cells * s / (s + rate);
        }
        const double rounding = 1e-12 * std::abs(1.0 / receptance[n] + m * s * s);
        CHECK(std::abs(stiffness - truth) < 1e-11 * std::abs(truth) + 4.0 * rounding);
        // The same with infinitely many springs over the band: a logarithm.
        const double low = 2.0 * std::numbers::pi * std::pow(10.0, centre - width / 2.0),
                     high = 2.0 * std::numbers::pi * std::pow(10.0, centre + width / 2.0);
        const Complex many = k + S / std::log(high / low) * (std::log(high / (s + high)) - std::log(low / (s + low)));
        CHECK(std::abs(truth - many) < 0.02 * S);
        CHECK(truth.imag() > 0.0);
        CHECK(truth.real() > before);
        before = truth.real();
    }
}
