// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Ranking/Predistortion.h"

#include "Engine/BlackBox/BlackBoxPredistorter.h"
#include "Engine/BlackBox/ModelDocument.h"
#include "Engine/BlackBox/PlayedBox.h"
#include "Engine/Document/Engineering.h"
#include "Engine/Error.h"
#include "Engine/Loudspeaker/ModelFile.h"
#include "Engine/Loudspeaker/Simulate.h"
#include "Engine/Predistortion/Predistorter.h"
#include "Engine/Signal/Level.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <span>
#include <vector>

namespace excursion {
namespace {

constexpr double worthTelling = 3.0, noDistortion = -120.0;  // dB
constexpr double belowNoise = 0.1;                           // of the noise: what the take could not show
constexpr double stimulusSeconds = 1.5;                      // at least, the last period being that which counts
constexpr int stimulusPeriods = 5;                           // at least
constexpr std::uint64_t stimulusSeed = 3;

/// Periods of what the model was fitted under.
std::vector<double> stimulusPlayed(const Stimulus& stimulus, double rate)
{
    const int length = periodFor(stimulus, rate);
    const auto period = playedAs(stimulus, rate, length, stimulusSeed);
    std::vector<double> signal;
    const int periods = std::max(stimulusPeriods, static_cast<int>(std::ceil(stimulusSeconds * rate / length)));
    for (int k = 0; k < periods; ++k)
        signal.insert(signal.end(), period.begin(), period.end());
    return signal;
}

/// Predistorts in place, without the delay. @returns core time over the signal's length
template <class AnyPredistorter>
double predistort(AnyPredistorter& predistorter, std::vector<double>& signal, double rate)
{
    const std::size_t length = signal.size(), latency = static_cast<std::size_t>(predistorter.latency());
    signal.resize(length + latency, 0.0);
    constexpr std::size_t block = 64;
    const auto start = std::clock();
    for (std::size_t n = 0; n < signal.size(); n += block)
        predistorter.process(signal.data() + n, signal.data() + n, std::min(block, signal.size() - n));
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    signal.erase(signal.begin(), signal.begin() + static_cast<std::ptrdiff_t>(latency));
    return seconds * rate / static_cast<double>(length);
}

RankedPredistortion ofBox(const JsonField& document, double rate, const Progress& progress)
{
    const PlayedBox played(blackBoxOf(modelDocumentFrom(document)), progress);
    RankedPredistortion told;
    if (!played.rehearsal) {
        told.trouble = played.refusal;
        return told;
    }
    BlackBoxPredistorter predistorter({played.box, played.region, played.rest, *played.rehearsal}, rate);
    auto signal = stimulusPlayed(played.box.stimulus, rate);
    told.load = predistort(predistorter, signal, rate);
    told.latency = predistorter.latency() / rate;
    told.beforeDb = played.rehearsal->beforeDb;
    told.modelDb = played.rehearsal->afterDb;
    return told;
}

/// The last period, of so many samples, of a channel of the driver, without its mean.
Eigen::VectorXd lastPeriod(const Model& model, const std::vector<double>& volts, int period, double rate,
                           Quantity output)
{
    const auto played = simulate(model, std::span<const double>(volts), rate, {});
    const auto* channel = played.find(output);
    if (channel == nullptr)
        throw Error(Error::Kind::data, "The physical driver does not know this channel.");
    Eigen::VectorXd last = Eigen::Map<const Eigen::VectorXd>(channel->samples.data(),
                                                             static_cast<Eigen::Index>(channel->samples.size()))
                               .tail(period);
    last.array() -= last.mean();
    return last;
}

RankedPredistortion ofDriver(const JsonField& document, const std::string& output, double rate)
{
    RankedPredistortion told;
    const auto model = modelFromJson(document);
    if (output == "current") {
        told.trouble = "A driver is inverted for its motion, and then its current is less linear than before: "
                       "rank a displacement, a velocity, an acceleration or a pressure.";
        return told;
    }
    const auto quantity = quantityNamed(output);
    const auto stimulus = stimulusFrom(document);
    if (!quantity || !stimulus)
        throw Error(Error::Kind::data, "It is not known what the driver was fitted under.");
    const auto plain = stimulusPlayed(*stimulus, rate);
    auto bent = plain;
    Predistorter predistorter(model, {rate, 2});
    told.load = predistort(predistorter, bent, rate);
    told.latency = predistorter.latency() / rate;
    const int period = periodFor(*stimulus, rate);
    const auto straight = lastPeriod(linearPart(model), plain, period, rate, *quantity);
    const auto over = [&](const std::vector<double>& volts) {
        return decibelsOf((lastPeriod(model, volts, period, rate, *quantity) - straight).squaredNorm()
                          / straight.squaredNorm());
    };
    told.beforeDb = over(plain);
    told.modelDb = over(bent);
    return told;
}

double powerOf(double db) { return std::pow(10.0, db / 10.0); }

}  // namespace

RankedPredistortion predistortionOf(const RankedModel& model, const std::string& output, double sampleRate,
                                    std::optional<double> noiseDb, const Progress& progress)
{
    RankedPredistortion told;
    try {
        if (!model.stable)
            throw Error(Error::Kind::data, "It is not stable.");
        const nlohmann::json document(model.document);
        const JsonField field(document, "", model.name);
        if (document.is_null() || field.at("format").value() == "excursion-state-space")
            throw Error(Error::Kind::data, "It is linear: there is nothing to correct.");
        told = isModelDocument(field) ? ofBox(field, sampleRate, progress) : ofDriver(field, output, sampleRate);
    } catch (const Error& error) {
        if (error.kind() == Error::Kind::cancelled)
            throw;
        told = {};
        told.trouble = error.what();
    }
    if (!told.trouble.empty())
        return told;
    if (told.beforeDb < noDistortion) {
        told.trouble = "It makes no distortion to speak of: there is nothing to correct.";
        return told;
    }
    const double error = model.judgedDb();
    const double noise = noiseDb ? powerOf(*noiseDb) : 0.0,
                 unexplained = std::max(powerOf(error) - noise, belowNoise * noise);
    told.leftDb = decibelsOf(powerOf(told.modelDb) + unexplained);
    if (!(told.beforeDb - told.leftDb >= worthTelling))
        told.trouble = "Its distortion is " + plainText(told.beforeDb, 1) + " dB, and " + plainText(told.leftDb, 1)
                       + " dB would be left on the take, because the model explains too little of it.";
    return told;
}

}  // namespace excursion
