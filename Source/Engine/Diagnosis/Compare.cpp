// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Compare.h"

#include "Engine/Document/Figures.h"
#include "Engine/Error.h"
#include "Engine/Loudspeaker/Fit.h"
#include "Engine/Loudspeaker/FitResponse.h"
#include "Engine/Loudspeaker/OutputError.h"
#include "Engine/Loudspeaker/SmallSignal.h"
#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace excursion {
namespace {

/// The errors of one channel.
struct ChannelSums {
    ErrorSums total;
    std::vector<ErrorSums> byLevel;

    template <class Add>
    void add(int level, const Add& to)
    {
        to(total);
        to(byLevel[static_cast<std::size_t>(std::max(0, level))]);
    }
    template <class Holds>
    bool everywhere(const Holds& holds) const
    {
        return holds(total) && std::all_of(byLevel.begin(), byLevel.end(), holds);
    }
};

/// Whether what is left may be what parameters leave open: something stands over the noise, and nothing far.
bool mayBeOpen(const std::vector<ChannelSums>& channels)
{
    constexpr double near = 4.0;  // times the noise: where more is missing, standard errors tell of that
    const auto noise = [](const ErrorSums& sums) { return isNoise(levelOf(sums, true)); };
    const auto close = [](const ErrorSums& sums) { return sums.power.error <= near * sums.power.noise; };
    return std::all_of(channels.begin(), channels.end(), [&](const auto& c) { return c.everywhere(close); })
           && !std::all_of(channels.begin(), channels.end(), [&](const auto& c) { return c.everywhere(noise); });
}

ErrorKinds kindsOf(const Record& record, const std::vector<std::size_t>& sections, const std::vector<SectionFit>& fits,
                   std::size_t c, int level)
{
    ErrorKinds kinds;
    double linear = 0.0, odd = 0.0, even = 0.0, noise = 0.0, measured = 0.0;
    bool known = false, oddSeen = false, evenSeen = false;
    for (std::size_t n = 0; n < sections.size(); ++n) {
        const auto& section = record.sections[sections[n]];
        if (section.level != level || section.excited.empty())
            continue;
        known = true;
        const auto [first, last] = record.lineRange(section);
        for (std::size_t k = first; k <= last; ++k) {
            const double error = std::norm(fits[n].predicted[c][k] - section.measured[c][k]);
            measured += std::norm(section.measured[c][k]);
            noise += section.deviation[c][k] * section.deviation[c][k];
            if (std::binary_search(section.excited.begin(), section.excited.end(), static_cast<int>(k)))
                linear += error;
            else if (k % 2 == 1) {
                odd += error;
                oddSeen = oddSeen || k < static_cast<std::size_t>(section.excited.back());
            } else {
                even += error;
                evenSeen = true;
            }
        }
    }
    if (!known)
        return kinds;
    kinds.linear = powerRatioDb(linear, measured);
    if (oddSeen)
        kinds.odd = powerRatioDb(odd, measured);
    if (evenSeen)
        kinds.even = powerRatioDb(even, measured);
    if (record.noiseKnown)
        kinds.noise = powerRatioDb(noise, measured);
    return kinds;
}

/// Rms per band of 1/24 octave (one line where lines are sparser), averaged over the level's sections.
ErrorSpectrum spectrumOf(const Record& record, const std::vector<std::size_t>& sections,
                         const std::vector<SectionFit>& fits, std::size_t c, int level)
{
    constexpr double bandsPerOctave = 24.0;
    ErrorSpectrum spectrum;
    std::vector<std::size_t> used;
    for (std::size_t n = 0; n < sections.size(); ++n)
        if (record.sections[sections[n]].level == level)
            used.push_back(n);
    if (used.empty())
        return spectrum;
    const auto& shape = record.sections[sections[used.front()]];
    const auto [first, last] = record.lineRange(shape);
    const double scale = 2.0 / (static_cast<double>(shape.window) * static_cast<double>(shape.window))
                         / static_cast<double>(used.size());
    for (std::size_t k = first; k <= last;) {
        const auto end = std::min(
            last + 1,
            std::max(k + 1, static_cast<std::size_t>(static_cast<double>(k) * std::exp2(1.0 / bandsPerOctave))));
        double measured = 0.0, model = 0.0, error = 0.0, noise = 0.0;
        for (const auto n : used) {
            const auto& section = record.sections[sections[n]];
            for (std::size_t j = k; j < end; ++j) {
                measured += std::norm(section.measured[c][j]);
                model += std::norm(fits[n].predicted[c][j]);
                error += std::norm(fits[n].predicted[c][j] - section.measured[c][j]);
                noise += section.deviation[c][j] * section.deviation[c][j];
            }
        }
        spectrum.frequency.push_back(record.frequency(shape, k)
                                     * std::sqrt(static_cast<double>(end - 1) / static_cast<double>(k)));
        spectrum.measured.push_back(std::sqrt(scale * measured));
        spectrum.model.push_back(std::sqrt(scale * model));
        spectrum.error.push_back(std::sqrt(scale * error));
        spectrum.noise.push_back(record.noiseKnown ? std::sqrt(scale * noise)
                                                   : std::numeric_limits<double>::quiet_NaN());
        k = end;
    }
    return spectrum;
}

/// Those of every section, of which some are there.
std::vector<SectionFit> fitsOfAll(const Model& model, const Record& record, const std::vector<std::size_t>& sections,
                                  const std::vector<SectionFit>& fits, const OutputErrorOptions& options,
                                  const Progress& progress)
{
    std::vector<SectionFit> all(record.sections.size());
    std::vector<std::size_t> others;
    for (std::size_t n = 0; n < all.size(); ++n)
        if (const auto found = std::find(sections.begin(), sections.end(), n); found != sections.end())
            all[n] = fits[static_cast<std::size_t>(found - sections.begin())];
        else
            others.push_back(n);
    auto more = outputError(model, record, others, {}, options, progress);
    for (std::size_t n = 0; n < others.size(); ++n)
        all[others[n]] = std::move(more[n]);
    return all;
}

}  // namespace

std::string inWords(const ErrorKinds& kinds)
{
    std::string text;
    const auto add = [&](const char* what, const std::optional<double>& level) {
        if (level)
            text += (text.empty() ? "" : ", ") + std::string(what) + " at " + figure(*level) + " dB";
    };
    add("excited lines", kinds.linear);
    add("odd detection lines", kinds.odd);
    add("even ones", kinds.even);
    if (!text.empty() && kinds.noise)
        text += ", noise at " + figure(*kinds.noise) + " dB";
    return text;
}

bool isNoise(const Comparison& comparison)
{
    // what only the loudest level shows would drown among the quiet ones
    const auto onlyNoise = [](const ChannelComparison& channel) {
        return isNoise(channel.total)
               && std::all_of(channel.byLevel.begin(), channel.byLevel.end(), [](const auto& e) { return isNoise(e); })
               && !channel.wanderDb;
    };
    return comparison.noiseKnown && std::all_of(comparison.channels.begin(), comparison.channels.end(), onlyNoise);
}

ErrorByChannel errorByChannel(const Comparison& comparison)
{
    ErrorByChannel errors;
    for (const auto& channel : comparison.channels)
        errors[channel.quantity] = channel.total;
    return errors;
}

bool followsDrift(const Model& model, const Record& record)
{
    constexpr double clearly = 1.0;  // dB: a noise of thousands of lines is known far better
    if (!noiseHoldsDrift(record) || warms(model))
        return noiseHoldsDrift(record);
    const auto reached = tryCompare(model, record, {0, false});
    return reached && std::any_of(reached->channels.begin(), reached->channels.end(), [](const ChannelComparison& c) {
               return c.total.noiseFloorDb && c.total.db < *c.total.noiseFloorDb - clearly;
           });
}

std::optional<Comparison> tryCompare(const Model& model, const Record& record, const CompareOptions& options,
                                     const Progress& progress)
{
    const auto sections = validationSections(record);
    OutputErrorOptions run;
    run.gradient = false;
    run.spectra = options.spectra;
    run.substeps = options.substeps > 0 ? options.substeps : substepsFor(model, record);
    progress.at(0.1, "comparing");
    const auto fits = outputError(model, record, sections, {}, run, progress);
    if (std::any_of(fits.begin(), fits.end(), [](const SectionFit& fit) { return !fit.finite; }))
        return std::nullopt;

    Comparison result;
    result.levels = record.levels.empty() ? std::vector<double> {0.0} : record.levels;
    result.noiseKnown = record.noiseKnown;
    result.validated = std::any_of(record.sections.begin(), record.sections.end(),
                                   [](const Section& s) { return s.validation; });
    // What is slow, or still relaxes when the periods begin that count, differs from period to period by itself.
    const bool drifts = std::any_of(model.components.begin(), model.components.end(),
                                    [](const Component& part) { return part.effect->slow() || part.effect->creeps(); });
    std::vector<ChannelSums> sums(record.channels.size(), {{}, std::vector<ErrorSums>(result.levels.size())});
    for (std::size_t n = 0; n < fits.size(); ++n)
        for (std::size_t c = 0; c < sums.size(); ++c)
            sums[c].add(record.sections[sections[n]].level, [&](ErrorSums& sum) {
                sum.power.add(fits[n].power[c]);
                sum.cost += fits[n].channels[c].cost;
                sum.rows += fits[n].channels[c].rows;
            });
    if (record.noiseKnown && result.validated && mayBeOpen(sums))
        for (const auto place : sections) {
            const auto open = openError(model, record, place);
            for (std::size_t c = 0; c < sums.size(); ++c)
                sums[c].add(record.sections[place].level, [&](ErrorSums& sum) { sum.open.add(open[c]); });
        }
    double cost = 0.0, rows = 0.0;
    for (std::size_t c = 0; c < record.channels.size(); ++c) {
        ChannelComparison channel;
        channel.quantity = record.channels[c];
        channel.unit = record.units[c];
        if (!drifts)
            channel.wanderDb = record.wanderDb[c];
        channel.total = levelOf(sums[c].total, record.noiseKnown);
        cost += sums[c].total.cost;
        rows += sums[c].total.rows;
        for (std::size_t level = 0; level < result.levels.size(); ++level) {
            const int index = record.levels.empty() ? -1 : static_cast<int>(level);
            channel.byLevel.push_back(levelOf(sums[c].byLevel[level], record.noiseKnown));
            if (options.spectra) {
                channel.kindsByLevel.push_back(kindsOf(record, sections, fits, c, index));
                channel.spectrumByLevel.push_back(spectrumOf(record, sections, fits, c, index));
            }
        }
        result.channels.push_back(std::move(channel));
    }
    result.chiSquaredPerValue = cost / std::max(1.0, rows);
    if (record.sectionsDrift) {
        constexpr double enough = 0.1;  // of a wander's power, which is told to a few dB
        result.sectionMoves = movesOf(fits);
        if (std::any_of(result.channels.begin(), result.channels.end(), [](const auto& c) { return c.wanderDb; })) {
            const auto moved = wanderByMoves(model, record, run);
            for (std::size_t c = 0; c < moved.size(); ++c)
                if (auto& wander = result.channels[c].wanderDb;
                    wander && moved[c] > enough * std::pow(10.0, 0.1 * *wander))
                    wander.reset();
        }
    }
    if (options.spectra) {
        result.residuals = residualCurves(model, record, sections, fits);
        const bool isTold = !result.residuals.empty();
        if (isTold || record.channelIndex(Quantity::displacement)) {
            const auto all = fitsOfAll(model, record, sections, fits, run, progress.part(1.0, 1.0));
            if (isTold)
                result.overTime = curvesOverTime(model, record, all);
            result.restShift = restShift(record, all);
        }
    }
    progress.at(1.0, "compared");
    return result;
}

Comparison compare(const Model& model, const Record& record, const CompareOptions& options, const Progress& progress)
{
    auto comparison = tryCompare(model, record, options, progress);
    if (!comparison)
        throw Error(Error::Kind::numerical,
                    "The model runs away when it is simulated on this take; fit it to the take first.");
    return std::move(*comparison);
}

std::vector<Waveform> waveforms(const Model& model, const Record& record, int level)
{
    std::vector<Waveform> result;
    for (const auto n : validationSections(record)) {
        const auto& section = record.sections[n];
        if (std::max(0, section.level) != level)
            continue;
        OutputErrorOptions run;
        run.gradient = false;
        run.spectra = true;
        run.substeps = substepsFor(model, record);
        const auto fit = outputError(model, record, {n}, {}, run).front();
        if (!fit.finite)
            throw Error(Error::Kind::numerical,
                        "The model runs away when it is simulated on this take; fit it to the take first.");
        const auto [first, last] = record.lineRange(section);
        const auto inTime = [&, first = first, last = last](std::vector<std::complex<double>> lines) {
            for (std::size_t k = 0; k < lines.size(); ++k)
                if (k < first || k > last)
                    lines[k] = 0.0;
            return inverseFft(lines, section.window);
        };
        for (std::size_t c = 0; c < record.channels.size(); ++c)
            result.push_back({record.channels[c], record.units[c], record.sampleRate, inTime(section.measured[c]),
                              inTime(fit.predicted[c])});
        break;
    }
    return result;
}

std::string titleOf(const ChannelComparison& channel)
{
    return channel.unit == "ohm" ? std::string("impedance") : std::string(name(channel.quantity));
}

Comparison compare(const Model& model, const Spectra& spectra)
{
    Comparison result;
    result.levels = {0.0};
    for (const auto& target : responsesOf(spectra)) {
        ChannelComparison channel;
        channel.quantity = target.quantity;
        channel.unit = target.impedance ? "ohm" : std::string(siUnit(target.quantity)) + "/V";
        channel.total.db = responseErrorDb(model, target);
        channel.byLevel.push_back(channel.total);
        const auto response = respond(model, {target.quantity}, target.frequency).front();
        ErrorSpectrum spectrum;
        spectrum.frequency = target.frequency;
        for (std::size_t f = 0; f < target.frequency.size(); ++f) {
            const auto value = target.impedance ? 1.0 / response.value[f] : response.value[f];
            spectrum.measured.push_back(std::abs(target.value[f]));
            spectrum.model.push_back(std::abs(value));
            spectrum.error.push_back(std::abs(value - target.value[f]));
            spectrum.noise.push_back(std::numeric_limits<double>::quiet_NaN());
        }
        channel.spectrumByLevel.push_back(std::move(spectrum));
        channel.kindsByLevel.emplace_back();
        result.channels.push_back(std::move(channel));
    }
    return result;
}

}  // namespace excursion
