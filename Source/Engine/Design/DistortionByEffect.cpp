// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Design/DistortionByEffect.h"

#include "Engine/Error.h"
#include "Engine/Loudspeaker/Fit.h"
#include "Engine/Loudspeaker/OutputError.h"
#include "Engine/Loudspeaker/SensorResponse.h"
#include "Engine/Signal/Level.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>

namespace excursion {
namespace {

using Spectrum = std::vector<std::complex<double>>;
using Simulated = std::vector<std::vector<Spectrum>>;  ///< [section][channel]; empty where the model runs away

double db(double power, double reference)
{
    constexpr double least = 1e-12;  // what the simulation cannot tell from nothing
    return 10.0 * std::log10(std::max(power / std::max(reference, 1e-300), least));
}

double powerOf(const Spectrum& Y, std::size_t first, std::size_t end)
{
    double sum = 0.0;
    for (std::size_t k = first; k < end; ++k)
        sum += std::norm(Y[k]);
    return sum;
}

/// Lines [first, end).
struct Band {
    std::size_t first = 0, end = 0;
};

/// Thirds of an octave over the lines, each at least so many lines wide; what would be less at the end belongs to the
/// last.
std::vector<Band> bandsOver(std::size_t first, std::size_t end)
{
    constexpr std::size_t fewest = 8;
    std::vector<Band> bands;
    for (auto low = first; low < end;) {
        auto high = std::max(static_cast<std::size_t>(std::ceil(static_cast<double>(low) * std::cbrt(2.0))),
                             low + fewest);
        if (high + fewest > end)
            high = end;
        bands.push_back({low, high});
        low = high;
    }
    return bands;
}

/// A channel of a section as it is played and as its linear part would play it.
struct Played {
    Spectrum even, odd, linear;
};
/// [section][channel]; nothing where the model runs away.
using Performance = std::optional<std::vector<std::vector<Played>>>;

/// The stimulus, and how the lines of its period tell distortion from a change of level.
class Stimulus {
public:
    Stimulus(const Record& record, std::size_t index) : section_(record.sections[index])
    {
        const auto [first, last] = record.lineRange(section_);
        bands_ = bandsOver(first, last + 1);
        excitedFirst_ = first;
        excitedEnd_ = last + 1;
        if (!section_.excited.empty()) {
            excitedFirst_ = static_cast<std::size_t>(section_.excited.front());
            excitedEnd_ = std::min(last + 1, static_cast<std::size_t>(section_.excited.back()) + 1);
        }
        for (auto k = excitedFirst_; k < excitedEnd_; ++k)
            if (k % 2 == 1)
                (isPlayed(k) ? oddPlayed_ : oddSilent_) += 1;
    }

    /// A band that the stimulus excites.
    bool excites(const Band& band) const { return band.end > excitedFirst_ && band.first < excitedEnd_; }
    const std::vector<Band>& bands() const { return bands_; }
    double centre(const Record& record, const Band& band) const
    {
        return std::sqrt(record.frequency(section_, band.first) * record.frequency(section_, band.end - 1));
    }

    /// Power in a band of what the odd part has beyond g times the linear one.
    double oddPower(const Played& y, const Band& band) const
    {
        return onSilentLines(y, band) + (oddSilent_ > 0.0 ? 0.0 : besideGain(y, band));
    }

    /// Powers of the odd part and of the linear one, where the stimulus has lines.
    std::pair<double, double> levels(const Played& y, const Band& band) const
    {
        double odd = 0.0, linear = 0.0;
        for (auto k = band.first; k < band.end; ++k)
            if (isPlayed(k)) {
                odd += std::norm(y.odd[k]);
                linear += std::norm(y.linear[k]);
            }
        return {odd, linear};
    }

private:
    /// Whether the stimulus has power on a line; where nothing is known it may have on any.
    bool isPlayed(std::size_t k) const
    {
        return section_.excited.empty()
               || std::binary_search(section_.excited.begin(), section_.excited.end(), static_cast<int>(k));
    }

    double onSilentLines(const Played& y, const Band& band) const
    {
        double sum = 0.0;
        for (auto k = band.first; k < band.end; ++k)
            if (!isPlayed(k)) {
                const bool between = k >= excitedFirst_ && k < excitedEnd_ && k % 2 == 1;
                sum += std::norm(y.odd[k] - y.linear[k]) * (between ? 1.0 + oddPlayed_ / oddSilent_ : 1.0);
            }
        return sum;
    }

    double besideGain(const Played& y, const Band& band) const
    {
        std::complex<double> together = 0.0;
        double linear = 0.0, sum = 0.0, lines = 0.0;
        for (auto k = band.first; k < band.end; ++k)
            if (isPlayed(k)) {
                together += std::conj(y.linear[k]) * y.odd[k];
                linear += std::norm(y.linear[k]);
                lines += 1.0;
            }
        if (!(linear > 0.0))
            return 0.0;
        const auto g = together / linear;
        for (auto k = band.first; k < band.end; ++k)
            if (isPlayed(k))
                sum += std::norm(y.odd[k] - g * y.linear[k]);
        return lines > 1.0 ? sum * lines / (lines - 1.0) : 0.0;  // g has taken its share of one line
    }

    const Section& section_;
    std::vector<Band> bands_;
    std::size_t excitedFirst_ = 0, excitedEnd_ = 0;
    double oddPlayed_ = 0.0, oddSilent_ = 0.0;
};

/// Plays variants of a model.
class Player {
public:
    Player(const Model& model, const Record& record, const std::vector<std::size_t>& sections)
        : record_(record), sections_(sections)
    {
        for (const auto section : sections)
            stimuli_.emplace_back(record, section);
        record_.channels = {Quantity::displacement, Quantity::pressure};
        record_.units = {"m", "Pa"};
        if (model.electrical()) {
            record_.channels.insert(record_.channels.begin(), Quantity::current);
            record_.units.insert(record_.units.begin(), "A");
        }
        record_.wanderDb.assign(record_.channels.size(), std::nullopt);
        record_.sectionsDrift = false;
        for (auto& s : record_.sections) {  // nothing is compared
            s.measured.assign(record_.channels.size(), Spectrum(s.window / 2 + 1, 0.0));
            s.deviation.assign(record_.channels.size(), std::vector<double>(s.window / 2 + 1, 1.0));
            s.deviationWithoutDrift.clear();
            s.inputVariance.clear();
            s.inputNoise.clear();
            s.departure.spectrum.clear();
        }
    }

    /// What a model plays as it is.
    Simulated simulated(const Model& model) const
    {
        auto record = record_;
        adapt(record, model);
        return spectra(model, record);
    }

    /// @param linear  of the model's linear part
    Performance play(const Model& model, const Simulated& linear) const
    {
        auto record = record_;
        adapt(record, model);
        const auto straight = spectra(model, record);
        for (auto& section : record.sections)
            for (auto& sample : section.input)
                sample = -sample;
        const auto turned = spectra(model, record);
        if (straight.empty() || linear.empty() || turned.empty())
            return std::nullopt;
        std::vector<std::vector<Played>> result(sections_.size(), std::vector<Played>(record_.channels.size()));
        for (std::size_t n = 0; n < result.size(); ++n)
            for (std::size_t c = 0; c < result[n].size(); ++c) {
                auto& y = result[n][c];
                y.linear = linear[n][c];
                for (std::size_t k = 0; k < y.linear.size(); ++k) {
                    y.even.push_back(0.5 * (straight[n][c][k] + turned[n][c][k]));
                    y.odd.push_back(0.5 * (straight[n][c][k] - turned[n][c][k]));
                }
            }
        return result;
    }

    /// One entry a channel; none of what ran away.
    std::vector<ChannelDistortion> judge(const Performance& played, const Performance& whole) const
    {
        std::vector<ChannelDistortion> result;
        for (std::size_t c = 0; played && c < record_.channels.size(); ++c)
            result.push_back(judge(c, *played, *whole));
        return result;
    }

private:
    Simulated spectra(const Model& model, const Record& record) const
    {
        OutputErrorOptions options;
        options.gradient = false;
        options.spectra = true;
        options.substeps = substepsFor(model, record, tolerance);
        Simulated result;
        for (auto& fit : outputError(withoutSensors(model), record, sections_, {}, options)) {
            if (!fit.finite)
                return {};
            result.push_back(std::move(fit.predicted));
        }
        return result;
    }

    /// Powers in a band, summed over the sections.
    struct Powers {
        double even = 0.0, odd = 0.0, reference = 0.0, played = 0.0, expected = 0.0, own = 0.0;

        Powers& operator+=(const Powers& other)
        {
            even += other.even;
            odd += other.odd;
            reference += other.reference;
            played += other.played;
            expected += other.expected;
            own += other.own;
            return *this;
        }
    };

    Powers powersIn(std::size_t band, std::size_t c, const std::vector<std::vector<Played>>& played,
                    const std::vector<std::vector<Played>>& whole) const
    {
        Powers sum;
        for (std::size_t n = 0; n < sections_.size(); ++n) {
            const auto& at = stimuli_[n].bands()[band];
            const auto &y = played[n][c], &reference = whole[n][c];
            const double even = powerOf(y.even, at.first, at.end);
            const auto [level, expected] = stimuli_[n].levels(y, at);
            sum += {even,
                    stimuli_[n].oddPower(y, at),
                    powerOf(reference.even, at.first, at.end) + powerOf(reference.odd, at.first, at.end),
                    level,
                    expected,
                    even + powerOf(y.odd, at.first, at.end)};
        }
        return sum;
    }

    ChannelDistortion judge(std::size_t c, const std::vector<std::vector<Played>>& played,
                            const std::vector<std::vector<Played>>& whole) const
    {
        ChannelDistortion result;
        result.quantity = record_.channels[c];
        Powers all;
        const auto& stimulus = stimuli_.front();  // one shape
        for (std::size_t band = 0; band < stimulus.bands().size(); ++band) {
            const auto here = powersIn(band, c, played, whole);
            all += here;
            if (!stimulus.excites(stimulus.bands()[band]) || !(here.expected > 0.0))
                continue;
            result.frequency.push_back(stimulus.centre(record_, stimulus.bands()[band]));
            result.even.push_back(db(here.even, here.reference));
            result.odd.push_back(db(here.odd, here.reference));
            result.gain.push_back(db(here.played, here.expected));
        }
        result.evenDb = db(all.even, all.reference);
        result.oddDb = db(all.odd, all.reference);
        result.gainDb = db(all.played, all.expected);
        result.rms = std::sqrt(2.0 * all.own / static_cast<double>(sections_.size()))
                     / static_cast<double>(record_.sections[sections_.front()].window);
        return result;
    }

    static constexpr double tolerance = 1e-5;  // distortion is told down to -100 dB

    Record record_;
    std::vector<std::size_t> sections_;
    std::vector<Stimulus> stimuli_;  ///< one a section
};

/// The linear part with that effect.
Model alone(const Model& model, std::string_view effect)
{
    auto result = model;
    for (const auto& component : model.components)
        if (!component.effect->linear() && component.effect->id() != effect)
            result = withoutEffect(std::move(result), component.effect->id());
    return result;
}

}  // namespace

std::vector<std::size_t> loudestSections(const Record& record)
{
    const auto louder = [](const Section& a, const Section& b) {
        return a.level != b.level ? a.level < b.level : rmsOf(a.input) < rmsOf(b.input);
    };
    const auto loudest = std::max_element(record.sections.begin(), record.sections.end(), louder);
    std::vector<std::size_t> result;
    for (std::size_t n = 0; n < record.sections.size(); ++n)
        if (loudest->level >= 0 ? record.sections[n].level == loudest->level : &record.sections[n] == &*loudest)
            result.push_back(n);
    return result;
}

DistortionByEffect distortionByEffect(const Model& model, const Record& record,
                                      const std::vector<std::size_t>& sections, const Progress& progress)
{
    const Player player(model, record, sections);
    const auto linear = player.simulated(linearPart(model));
    const auto whole = player.play(model, linear);
    if (!whole)
        throw Error(Error::Kind::numerical,
                    "The model runs away when it is simulated on this take; fit it to the take first.");
    DistortionByEffect result;
    for (const auto n : sections)
        result.level += rmsOf(record.sections[n].input) / static_cast<double>(sections.size());
    result.whole = player.judge(whole, whole);
    for (std::size_t k = 1; k < model.components.size(); ++k) {
        const auto& effect = *model.components[k].effect;
        progress.at(static_cast<double>(k) / static_cast<double>(model.components.size()), "without " + effect.id());
        EffectDistortion one;
        one.effect = effect.id();
        const auto without = withoutEffect(model, one.effect);
        one.without = player.judge(
            player.play(without, effect.linear() ? player.simulated(linearPart(without)) : linear), whole);
        if (!effect.linear())
            one.alone = player.judge(player.play(alone(model, one.effect), linear), whole);
        result.effects.push_back(std::move(one));
    }
    return result;
}

}  // namespace excursion
