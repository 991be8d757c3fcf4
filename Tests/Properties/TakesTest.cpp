// SPDX-License-Identifier: GPL-3.0-or-later
// What must not change what a take tells: the units of its channels, where its periods are cut, the order of its
// realizations and of its channels.
#include "Engine/Estimate/Bla.h"
#include "Engine/Estimate/Distortion.h"
#include "Engine/Linear/Identify.h"
#include "Engine/Polynomial/Pnlss/PnlssFit.h"
#include "Engine/Polynomial/TakeRecords.h"
#include "Estimate/SyntheticTake.h"
#include "Properties/Property.h"

#include <algorithm>
#include <complex>

using namespace excursion;
using namespace excursion::test;

namespace {

Measurement drawnTake(int seed, double noiseDb = -60.0)
{
    synthetic::Loudspeaker driver;
    driver.evenStiffness = 0.2;
    driver.oddForce = 0.1;
    synthetic::Plan plan;
    plan.sampleRate = 8000.0;
    plan.period = 1024;
    plan.realizations = 4;
    plan.levels = {2.0};
    plan.bandHigh = 2500.0;
    plan.noiseDb = noiseDb;
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    return synthetic::record(driver, plan, random);
}

Channel& channelOf(Measurement& take, Quantity quantity)
{
    return *std::find_if(take.channels.begin(), take.channels.end(),
                         [&](const Channel& channel) { return channel.quantity == quantity; });
}

void scale(Measurement& take, Quantity quantity, double by)
{
    auto& channel = channelOf(take, quantity);
    channel.fullScale *= by;
    for (auto& sample : channel.samples)
        sample *= by;
}

double anyScale() { return std::pow(10.0, between(-6, 6)) * (1.5 + 0.4 * within1()); }

/// Response and variances of `a` are those of `b` times a gain, within rounding.
void sameResponse(const BlaResult& a, const BlaResult& b, double gain)
{
    RC_ASSERT(a.frf.value.size() == b.frf.value.size());
    for (std::size_t k = 0; k < a.frf.value.size(); ++k) {
        RC_ASSERT(a.frf.frequency[k] == b.frf.frequency[k]);
        RC_ASSERT(std::abs(a.frf.value[k] - gain * b.frf.value[k]) <= 1e-11 * gain * std::abs(b.frf.value[k]));
        for (const auto of : {&Frf::noiseVariance, &Frf::totalVariance})
            RC_ASSERT(std::abs((a.frf.*of)[k] - gain * gain * (b.frf.*of)[k]) <= 1e-6 * gain * gain * (b.frf.*of)[k]);
        RC_ASSERT(std::abs(a.coherence[k] - b.coherence[k]) <= 1e-11);
    }
}

/// The realizations of a take of one level in another order.
Measurement reordered(const Measurement& take, const std::vector<int>& order)
{
    auto result = take;
    const auto length = static_cast<std::ptrdiff_t>(take.excitation->samplesPerRealization());
    for (std::size_t c = 0; c < take.channels.size(); ++c)
        for (std::size_t r = 0; r < order.size(); ++r)
            std::copy_n(take.channels[c].samples.begin() + length * order[r], length,
                        result.channels[c].samples.begin() + length * static_cast<std::ptrdiff_t>(r));
    return result;
}

/// Every realization begins that many samples later in its period.
Measurement cutLater(const Measurement& take, int samples)
{
    auto result = take;
    const auto length = take.excitation->samplesPerRealization();
    for (auto& channel : result.channels)
        for (int r = 0; r < take.excitation->realizations; ++r) {
            const auto begin = channel.samples.begin() + r * length;
            std::rotate(begin, begin + samples, begin + length);
        }
    return result;
}

}  // namespace

TEST_CASE("A take in other units has the same response in other units, the same distortion and the same poles")
{
    holds("units", 12, [] {
        const auto take = drawnTake(between(1, 1000));
        auto other = take;
        const double in = anyScale(), out = anyScale();
        scale(other, Quantity::voltage, in);
        scale(other, Quantity::displacement, out);
        const auto response = bla(take, Quantity::displacement, 0), scaled = bla(other, Quantity::displacement, 0);
        sameResponse(scaled, response, out / in);

        const auto levels = distortion(take, Quantity::displacement, 0),
                   scaledLevels = distortion(other, Quantity::displacement, 0);
        RC_ASSERT(levels.oddTotal.has_value() && levels.evenTotal.has_value());
        RC_ASSERT(std::abs(levels.oddTotal->db - scaledLevels.oddTotal->db) < 1e-6);
        RC_ASSERT(std::abs(levels.evenTotal->db - scaledLevels.evenTotal->db) < 1e-6);

        IdentifyOptions options;
        options.order = 3;
        options.sampleRate = take.sampleRate;
        const auto found = identify(frequencyDataOf(response.frf), options),
                   scaledFound = identify(frequencyDataOf(scaled.frf), options);
        RC_ASSERT(std::abs(found.errorDb - scaledFound.errorDb) < 1e-4);
        const auto expected = poles(found.model), got = poles(scaledFound.model);
        RC_ASSERT(expected.size() == got.size());
        for (std::size_t k = 0; k < expected.size(); ++k)
            RC_ASSERT(std::abs(expected[k] - got[k]) < 1e-6);
    });
}

TEST_CASE("A polynomial model of a take in other units has the same error")
{
    holds("units of a PNLSS fit", 4, [] {
        const auto take = drawnTake(between(1, 1000));
        auto other = take;
        scale(other, Quantity::voltage, anyScale());
        scale(other, Quantity::displacement, anyScale());
        const auto errorOf = [](const Measurement& measured) {
            const auto records = recordsOf(measured, channelOf(const_cast<Measurement&>(measured), Quantity::voltage),
                                           channelOf(const_cast<Measurement&>(measured), Quantity::displacement));
            IdentifyOptions identifying;
            identifying.order = 3;
            identifying.sampleRate = measured.sampleRate;
            const auto linear =
                identify(frequencyDataOf(bla(measured, Quantity::displacement, 0).frf), identifying).model;
            PnlssFitOptions options;
            options.maximumIterations = 8;
            options.search = PnlssSearch::plain;
            return fitPnlss(withTerms(linear, 2), records.estimation, records.validation, options).estimationDb;
        };
        const double expected = errorOf(take), got = errorOf(other);
        RC_ASSERT(expected < -10.0);
        RC_ASSERT(std::abs(expected - got) < 0.05);
    });
}

TEST_CASE("Where the periods of a take are cut, and in which order its realizations and channels come, changes nothing")
{
    holds("order", 12, [] {
        const auto take = drawnTake(between(1, 1000));
        const auto response = bla(take, Quantity::displacement, 0);
        // What settles is as periodic as the rest here, up to its noise: that of the first period counts elsewhere
        // then.
        auto quiet = drawnTake(between(1, 1000), -300.0);
        const auto cut = bla(cutLater(quiet, between(1, 1023)), Quantity::displacement, 0),
                   uncut = bla(quiet, Quantity::displacement, 0);
        for (std::size_t k = 0; k < cut.frf.value.size(); ++k)
            RC_ASSERT(std::abs(cut.frf.value[k] - uncut.frf.value[k]) < 1e-9 * std::abs(uncut.frf.value[k]));

        std::vector<int> order {0, 1, 2, 3};
        for (int k = 3; k > 0; --k)
            std::swap(order[static_cast<std::size_t>(k)], order[static_cast<std::size_t>(between(0, k))]);
        auto other = reordered(take, order);
        std::reverse(other.channels.begin(), other.channels.end());
        sameResponse(bla(other, Quantity::displacement, 0), response, 1.0);
        const auto levels = distortion(take, Quantity::displacement, 0),
                   otherLevels = distortion(other, Quantity::displacement, 0);
        RC_ASSERT(std::abs(levels.evenTotal->db - otherLevels.evenTotal->db) < 1e-6);
        RC_ASSERT(std::abs(*levels.noiseDb - *otherLevels.noiseDb) < 1e-6);
    });
}
