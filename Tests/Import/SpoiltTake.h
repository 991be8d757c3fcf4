// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Import/ReadTake.h"
#include "Engine/Take/ExcitationPlan.h"
#include "Engine/Take/TakeFile.h"
#include "Scratch.h"

#include <nlohmann/json.hpp>

#include <random>

namespace excursion::test {

/// Two levels, two realizations, a voltage and a current.
inline Measurement take(double noise = 0.0)
{
    ExcitationPlanOptions o;
    o.multisine.period = 512;
    o.multisine.bandLow = 100;
    o.levels = {0.5, 2.0};
    o.realizations = 2;
    auto m = planExcitation(o);
    std::mt19937_64 random(5);
    std::normal_distribution<double> normal(0, noise);
    Channel current {Quantity::current, "A", 0.75, m.channels[0].samples};
    for (auto& value : current.samples)
        value = value / 6.1 + (noise > 0 ? normal(random) : 0.0);
    if (noise > 0)
        for (auto& value : m.channels[0].samples)
            value += normal(random);
    m.channels.push_back(std::move(current));
    m.driver = {"T\u00fcr \u2014 15\u2033", 0.0132, 0.3};
    return m;
}

/// A readable take whose JSON a test then spoils.
struct Spoilt {
    Scratch scratch;
    nlohmann::json json;

    Spoilt()
    {
        writeMeasurement(take(), scratch.folder());
        json = nlohmann::json::parse(bytesOf(scratch / "measurement.json"));
    }
    void refused(const std::string& contains, Error::Kind kind = Error::Kind::input)
    {
        scratch.file("measurement.json", json.dump());
        test::refused(kind, contains, [&] { readTake(scratch.folder()); });
    }
};

}  // namespace excursion::test
