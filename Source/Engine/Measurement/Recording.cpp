// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Measurement/Recording.h"

#include "Engine/Error.h"
#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

struct Place {
    std::size_t shift = 0;
    double correlation = 0.0;  ///< normalized, with its sign
};

/// Where the wanted signal lies within a longer one.
Place find(const std::vector<double>& wanted, const std::vector<double>& recorded)
{
    auto padded = wanted;
    padded.resize(recorded.size(), 0.0);
    const auto W = fft(padded), R = fft(recorded);
    auto product = R;
    for (std::size_t k = 0; k < product.size(); ++k)
        product[k] *= std::conj(W[k]);
    const auto correlation = inverseFft(product, recorded.size());
    const auto last = correlation.begin() + static_cast<std::ptrdiff_t>(recorded.size() - wanted.size() + 1);
    const auto peak = std::max_element(correlation.begin(), last,
                                       [](double a, double b) { return std::abs(a) < std::abs(b); });
    Place place {static_cast<std::size_t>(peak - correlation.begin()), 0.0};
    double wantedPower = 0.0, recordedPower = 0.0;
    for (std::size_t n = 0; n < wanted.size(); ++n) {
        wantedPower += wanted[n] * wanted[n];
        recordedPower += recorded[place.shift + n] * recorded[place.shift + n];
    }
    if (wantedPower > 0.0 && recordedPower > 0.0)
        place.correlation = *peak / std::sqrt(wantedPower * recordedPower);
    return place;
}

}  // namespace

Measurement takeFrom(const Measurement& plan, const std::vector<RecordedChannel>& recorded)
{
    const auto voltage = std::find_if(recorded.begin(), recorded.end(),
                                      [](const RecordedChannel& c) { return c.quantity == Quantity::voltage; });
    if (voltage == recorded.end())
        throw Error(Error::Kind::data, "None of the inputs is the voltage at the loudspeaker's terminals; a "
                                       "measurement needs it to know what was played.");
    const auto& wanted = plan.input().samples;
    if (voltage->samples.size() < wanted.size())
        throw Error(Error::Kind::data, "The recording ended before all of the excitation was played.");
    const auto place = find(wanted, voltage->samples);
    if (!(std::abs(place.correlation) >= 0.5))
        throw Error(Error::Kind::data, "The excitation was not found in the voltage input: check the cables, which "
                                       "input is the voltage, and the gains.");
    Measurement take;
    take.sampleRate = plan.sampleRate;
    take.excitation = plan.excitation;
    take.driver = plan.driver;
    for (const auto& channel : recorded) {
        Channel cut {channel.quantity, std::string(siUnit(channel.quantity)), std::abs(channel.fullScale), {}};
        const auto begin = channel.samples.begin() + static_cast<std::ptrdiff_t>(place.shift);
        cut.samples.assign(begin, begin + static_cast<std::ptrdiff_t>(wanted.size()));
        // A voltage that is measured upside down is an input wired the wrong way round, whatever the loudspeaker does.
        const double scale = channel.quantity == Quantity::voltage && place.correlation * channel.fullScale < 0.0
                                 ? -channel.fullScale
                                 : channel.fullScale;
        for (auto& sample : cut.samples)
            sample *= scale;
        take.channels.push_back(std::move(cut));
    }
    return take;
}

}  // namespace excursion
