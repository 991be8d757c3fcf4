// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Fractional/FractionalIdentify.h"
#include "Engine/GreyBox/MixedImpedance.h"
#include "Engine/Import/ReadTake.h"
#include "Engine/Linear/Identify.h"

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

namespace excursion::test {

/// The measured drivers, as files below the data folder.
inline std::vector<std::filesystem::path> measuredDrivers()
{
    return {"novak/novak.csv",
            "seas-l16rnx/L16RNX_0g_242_27mV.zma",
            "seas-l16rnx/L16RNX_8_017g_242_27mV.zma",
            "seas-l16rnx/L16RNX_16_048g_242_27mV.zma",
            "impedance/Morel_CAW938_caw938.zma",
            "impedance/Morel_CAW938_sb26adc.zma",
            "impedance/Sealed_SIG120_DX25TG59_Woofer.zma",
            "impedance/SB15NRX2C30-4_SB26STCN-4_Woofer.zma"};
}

/// Its impedance from 10 Hz to 20 kHz on at most 180 lines that are evenly spread in log f; all lines count by their
/// relative error.
inline FrequencyData measuredImpedance(const std::filesystem::path& file)
{
    const auto take = std::get<Spectra>(readTake(file));
    const auto &u = take.find(Quantity::voltage)->values, &i = take.find(Quantity::current)->values;
    FrequencyData data;
    std::vector<std::complex<double>> value;
    double next = 10.0;
    for (std::size_t k = 0; k < take.frequency.size(); ++k) {
        if (take.frequency[k] < next || take.frequency[k] > 20000.0)
            continue;
        data.frequency.push_back(take.frequency[k]);
        value.push_back(u[k] / i[k]);
        next = take.frequency[k] * std::pow(2000.0, 1.0 / 180.0);
    }
    data.value = Eigen::Map<const Eigen::VectorXcd>(value.data(), static_cast<Eigen::Index>(value.size()));
    data.deviation = 1e-9 * data.value.cwiseAbs();  // no model may think that it has met the noise
    return data;
}

/// Root of the mean square of |model - Z|/|Z| over the lines, dB.
template <class Response>
double meanRelativeDb(const FrequencyData& data, Response model)
{
    double sum = 0.0;
    for (Eigen::Index k = 0; k < data.lines(); ++k)
        sum += std::norm(model(data.frequency[static_cast<std::size_t>(k)]) / data.value(k, 0) - 1.0);
    return 10.0 * std::log10(sum / static_cast<double>(data.lines()));
}

/// One family of models: errors of its members, by ascending number of parameters.
struct OrderFamily {
    std::string name;
    struct Member {
        int parameters = 0;
        double errorDb = 0.0, alpha = 1.0;
        bool stable = true;
    };
    std::vector<Member> members;

    /// The least error with no more than this many parameters, and that member.
    const Member* within(int parameters) const
    {
        const Member* best = nullptr;
        for (const auto& member : members)
            if (member.parameters <= parameters && (!best || member.errorDb < best->errorDb))
                best = &member;
        return best;
    }

    /// The fewest parameters with an error of at most this; 0: none.
    int fewestFor(double errorDb) const
    {
        for (const auto& member : members)
            if (member.errorDb <= errorDb)
                return member.parameters;
        return 0;
    }
};

/// Integer order 1 .. highest, order 1/2 and free order 1 .. highest and 1 .. highestFree, and resonances with R + L s
/// and with R + L s^alpha.
inline std::vector<OrderFamily> compareOrders(const FrequencyData& data, int highest, int highestFree)
{
    std::vector<OrderFamily> families {
        {"integer", {}}, {"half", {}}, {"free", {}}, {"R + L s", {}}, {"R + L s^alpha", {}}};
    const auto judge = [&data](const FractionalStateSpace& model) {
        const auto response = respond(model, data.frequency);
        std::size_t k = 0;
        return meanRelativeDb(data, [&](double) { return response[k++](0, 0); });
    };
    for (int order = 1; order <= highest; ++order) {
        IdentifyOptions integer;
        integer.order = order;
        const auto found = identify(data, integer);
        families[0].members.push_back({2 * order + 1, judge({1.0, found.model}), 1.0, found.stable});
        FractionalOptions half;
        half.order = order;
        half.alpha = 0.5;
        const auto halved = identifyFractional(data, half);
        families[1].members.push_back({2 * order + 1, judge(halved.model), 0.5, halved.stable});
    }
    for (int order = 1; order <= highestFree; ++order) {
        FractionalOptions free;
        free.order = order;
        free.thorough = false;
        const auto found = identifyFractional(data, free);
        families[2].members.push_back({2 * order + 2, judge(found.model), found.model.alpha, found.stable});
    }
    for (const bool free : {false, true}) {
        MixedImpedanceOptions mixed;
        if (!free)
            mixed.alpha = 1.0;
        const auto fit = fitMixedImpedance(data, mixed);
        families[free ? 4 : 3].members.push_back(
            {free ? 6 : 5, meanRelativeDb(data, [&](double f) { return fit.model.at(f); }), fit.model.alpha, true});
    }
    return families;
}

}  // namespace excursion::test
