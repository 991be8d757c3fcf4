// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Design/StrokeLimits.h"

#include "Engine/Design/WhatIf.h"
#include "Engine/Design/WhatIfFile.h"
#include "Engine/Document/JsonText.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Signal/Fft.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <complex>
#include <numbers>

using namespace excursion;

namespace {

constexpr double visitedPeak = 4e-3;

OperatingRange visited(int degree)
{
    OperatingRange operatingRange;
    operatingRange.displacement = visitedPeak;
    operatingRange.degree = degree;
    return operatingRange;
}

/// A law b + c1 (x/X) + 2 c2 (x/X)^2 put into a driver.
Model with(const std::string& effect, double c1, double c2)
{
    auto model = withEffect(makeModel("electrodynamic"), effectNamed(effect), visited(2));
    auto& p = model.components.back().parameters;
    p[0].value = c1;
    p[1].value = c2;
    return model;
}

const StrokeLimit& named(const StrokeLimits& stroke, const std::string& words)
{
    for (const auto& limit : stroke.limits)
        if (limit.name.find(words) != std::string::npos)
            return limit;
    throw std::out_of_range(words);
}

}  // namespace

TEST_CASE("A parabolic force factor reaches 82 % where the parabola does, and is centred where its top is", "[design]")
{
    auto model = with("force-factor", 0.0, 0.0);
    const double Bl = model.baseParameter("Bl").value, top = 0.5e-3;
    const double c2 = -0.2 * Bl, c1 = -4.0 * c2 * top / visitedPeak;  // d/dx = 0 at the top
    model = with("force-factor", c1, c2);
    model.covariance = 1e-8 * Bl * Bl
                       * Eigen::MatrixXd::Identity(parameterVector(model).size(), parameterVector(model).size());
    const auto stroke = strokeLimits(model);
    CHECK(stroke.range == visitedPeak);
    const auto& limit = named(stroke, "Bl(x)");
    // c1 s + 2 c2 s^2 = -0.18 Bl
    const double a = 2.0 * c2, b = c1, c = 0.18 * Bl, root = std::sqrt(b * b - 4.0 * a * c);
    const double left = visitedPeak * (-b + root) / (2.0 * a), right = visitedPeak * (-b - root) / (2.0 * a);
    REQUIRE(limit.inward);
    REQUIRE(limit.outward);
    CHECK(*limit.inward == Approx(-left).epsilon(1e-4));
    CHECK(*limit.outward == Approx(right).epsilon(1e-4));
    CHECK(limit.stroke() == limit.inward);
    CHECK(stroke.tightest() == &limit);
    REQUIRE(stroke.gapCentre);
    CHECK(stroke.gapCentre->value == Approx(top).epsilon(1e-3));
    CHECK(stroke.gapCentre->standardError > 0.0);
    CHECK(stroke.gapCentre->standardError < 0.1 * top);
}

TEST_CASE("A limit that is not reached says how far it is", "[design]")
{
    const double K = makeModel("electrodynamic").baseParameter("K").value;
    const auto stroke = strokeLimits(with("stiffness", -0.1 * K, 0.05 * K));
    const auto& limit = named(stroke, "compliance");
    CHECK_FALSE(limit.inward);
    CHECK_FALSE(limit.outward);
    CHECK_FALSE(limit.stroke());
    CHECK(limit.inwardEnd == Approx(100.0 / 1.2).epsilon(1e-6));
    CHECK(limit.outwardEnd == Approx(100.0).epsilon(1e-6));
    REQUIRE(stroke.stiffnessAsymmetry);
    CHECK(stroke.stiffnessAsymmetry->value == Approx(200.0 * 0.2 / 2.2).epsilon(1e-6));
    CHECK_FALSE(stroke.gapCentre);
}

TEST_CASE("The impedance limit is that of Re and a coil's inductance held fast", "[design]")
{
    auto model = with("inductance-position", 0.0, 0.0);
    const double Le = model.baseParameter("Le").value, Re = model.baseParameter("Re").value;
    model = with("inductance-position", -0.9 * Le, 0.0);
    const auto stroke = strokeLimits(model);
    const double w = 2.0 * std::numbers::pi * stroke.tone;
    CHECK(stroke.tone == Approx(8.5 * stroke.resonance));
    const double atEnd = 100.0 * 0.9 * w * Le / std::hypot(Re, w * Le);
    const auto& limit = named(stroke, "impedance");
    CHECK(limit.inwardEnd == Approx(atEnd).epsilon(1e-6));
    CHECK(limit.outwardEnd == Approx(atEnd).epsilon(1e-6));
    REQUIRE(atEnd > 10.0);
    REQUIRE(limit.outward);
    CHECK(*limit.outward == Approx(visitedPeak * 10.0 / atEnd).epsilon(1e-6));
}

TEST_CASE("At the Doppler limit a carried tone has 10 % in its two sidebands", "[design]")
{
    const auto stroke = strokeLimits(makeModel("electrodynamic"));
    const auto& limit = named(stroke, "Doppler");
    REQUIRE(limit.outward);
    constexpr std::size_t N = 4096;
    constexpr int low = 64, high = 544;  // 8.5 times
    std::vector<double> sound(N);
    for (std::size_t n = 0; n < N; ++n) {
        const double turn = 2.0 * std::numbers::pi * static_cast<double>(n) / N;
        const double earlier = *limit.outward * std::sin(low * turn) / 343.0;  // s
        sound[n] = std::cos(high * turn + 2.0 * std::numbers::pi * stroke.tone * earlier);
    }
    const auto P = fft(sound);
    CHECK(std::sqrt(std::norm(P[high - low]) + std::norm(P[high + low])) / std::abs(P[high])
          == Approx(0.1).epsilon(0.01));
}

TEST_CASE("Words and document of what-if say the same numbers", "[design]")
{
    WhatIf told;
    ChannelDistortion sound {Quantity::pressure, 1.0, -20.0, -40.0, -0.1, {100.0}, {-20.0}, {-40.0}, {-0.1}};
    auto better = sound, worse = sound;
    better.evenDb = -41.0;
    worse.evenDb = -18.0;
    told.distortion = {
        2.0, {sound}, {{"stiffness", {better}, {sound}}, {"force-factor", {worse}, {}}, {"doppler", {}, {}}}};
    told.stroke = strokeLimits(with("force-factor", 0.0, -0.2 * makeModel("electrodynamic").baseParameter("Bl").value));
    const auto words = advice(told);
    for (const char* part :
         {"-20.0 dB (10 %)", "mostly even", "Stiffness K(x), without which it would be 17.5 dB lower",
          "Force factor Bl(x) works against", "2.7 mm either way, where the force factor Bl(x) falls to 82 %"})
        CHECK_THAT(words, Catch::Contains(part));
    CHECK(std::isnan(fallWithout(told.distortion, told.distortion.effects[2], Quantity::pressure)));

    const auto document = toJson(told);
    const auto text = nlohmann::json::parse(jsonText(document));
    const auto read = whatIfFromJson(JsonField(text, "", "test"));
    CHECK(jsonText(toJson(read)) == jsonText(document));
    CHECK(document.at("advice") == words);
    CHECK(read.distortion.effects[0].alone.size() == 1);
}

TEST_CASE("Advice tells sound without distortion, parity, and by how much the cone moves more or less")
{
    WhatIf told;
    told.stroke = strokeLimits(with("force-factor", 0.0, -0.2 * makeModel("electrodynamic").baseParameter("Bl").value));
    CHECK_THAT(advice(told), Catch::StartsWith("The model adds no distortion to the sound."));  // no sound either
    ChannelDistortion sound, motion;
    sound.quantity = Quantity::pressure;
    motion.quantity = Quantity::displacement;
    const auto said = [&](double even, double odd, double gain) {
        sound.evenDb = even;
        sound.oddDb = odd;
        motion.gainDb = gain;
        told.distortion.whole = {sound, motion};
        return advice(told);
    };
    CHECK_THAT(said(-120.0, -110.0, 0.0), Catch::Contains("adds no distortion"));
    CHECK_THAT(said(-90.0, -110.0, 0.0), Catch::Contains("-90.0 dB") && Catch::Contains("mostly even"));
    CHECK_THAT(said(-60.0, -40.0, 0.4), Catch::Contains("mostly odd") && !Catch::Contains("The cone moves"));
    CHECK_THAT(said(-40.0, -42.0, -1.5),
               Catch::Contains("even and odd alike") && Catch::Contains("The cone moves 1.5 dB less"));
    CHECK_THAT(said(-40.0, -42.0, 2.0), Catch::Contains("The cone moves 2.0 dB more"));
}
