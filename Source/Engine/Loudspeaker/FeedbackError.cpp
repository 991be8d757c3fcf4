// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/FeedbackError.h"

#include "Engine/Loudspeaker/Arrival.h"
#include "Engine/Loudspeaker/DepartureResponse.h"
#include "Engine/Loudspeaker/SensorResponse.h"
#include "Engine/Numerics/Parallel.h"
#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <type_traits>
#include <utility>

namespace excursion {
namespace {

using Complex = std::complex<double>;

/// Residuals and columns of one section.
class FedSection {
public:
    FedSection(const Model& model, const Record& record, const Section& section, const ShownMotion& motion,
               const Fed& fed, const Paths& paths, const DepartureResponse* departures)
        : model_(model),
          record_(record),
          section_(section),
          motion_(motion),
          residual_(record, section),
          fed_(fed),
          paths_(paths),
          departures_(departures)
    {
    }

    /// @param played  null: residuals are those of the fed laws
    SectionFit run(const std::vector<Eigen::Index>& active, const OutputErrorOptions& options, const SectionFit* played)
    {
        SectionFit fit;
        const auto channels = record_.channels.size();
        std::vector<Spectrum> predicted;
        std::vector<Eigen::VectorXd> residual;
        std::vector<Eigen::MatrixXd> J;
        fit.finite = true;
        for (std::size_t c = 0; c < channels; ++c) {
            predicted.push_back(sum(c, fed_.voltage, fed_.force));
            if (record_.channels[c] == Quantity::pressure)
                radiate(predicted[c]);
            const bool heard = record_.channels[c] == Quantity::pressure && hear(predicted[c]);
            if (options.gradient && !active.empty())
                J.push_back(columns(c, active, heard));
        }
        if (played)
            predicted = played->predicted;
        else if (departures_)
            departures_->addTo(predicted, section_);
        for (std::size_t c = 0; c < channels; ++c)
            residual.push_back(residual_.of(c, predicted[c]));
        if (record_.sectionsDrift || options.sectionsDrift) {
            const auto shown = everySample(motion_);
            const SectionDrift drift(model_, record_, section_, residual_, paths_, fft(shown.i), fft(shown.x));
            fit.drift = played ? played->drift : drift.follow(predicted, residual);
            if (!J.empty())
                drift.takeOut(J);
        }
        for (std::size_t c = 0; c < channels; ++c) {
            NormalEquations normal(residual[c]);
            fit.finite = fit.finite && std::isfinite(normal.cost);
            if (!J.empty()) {
                normal.differentiateBy(J[c], residual[c]);
                fit.pull(residual_.pulls(J[c], residual[c]));
                if (options.slopes)
                    fit.slopes.push_back(J[c].cast<float>());
            }
            fit.channels.push_back(std::move(normal));
            fit.power.push_back(played ? played->power[c] : residual_.power(c, predicted[c]));
        }
        if (options.shared && !J.empty())
            fit.shared = residual_.shared(J);
        if (options.spectra)
            fit.predicted = std::move(predicted);
        return fit;
    }

private:
    /// The lines of the residuals, of a spectrum that begins with line `begin`.
    template <class Lines>
    auto lines(Lines&& spectrum, std::size_t begin = 0) const
    {
        using Array =
            std::conditional_t<std::is_const_v<std::remove_reference_t<Lines>>, const Eigen::ArrayXcd, Eigen::ArrayXcd>;
        return Eigen::Map<Array>(spectrum.data() + (residual_.firstLine() - begin), residual_.rows() / 2);
    }

    /// The spectrum that a voltage and a force make of a channel.
    Spectrum sum(std::size_t c, const Spectrum& voltage, const Spectrum& force) const
    {
        Spectrum result(voltage.size(), 0.0);
        lines(result) = lines(paths_.fromVoltage[c].value, paths_.first) * lines(voltage)
                        + lines(paths_.fromForce[c].value, paths_.first) * lines(force);
        return result;
    }

    /// What the way to the microphone makes of each line.
    void goTheWay()
    {
        for (std::size_t k = onTheWay_.size(); k < fed_.voltage.size(); ++k)
            onTheWay_.push_back(
                std::polar(1.0, -2.0 * std::numbers::pi * record_.frequency(section_, k) * paths_.lateness));
    }

    /// Adds the sound that laws make beside the cone.
    void radiate(Spectrum& sound)
    {
        if (std::none_of(fed_.laws.begin(), fed_.laws.end(), [](const LawDrive& law) { return law.radiates(); }))
            return;
        goTheWay();
        heardOf_ = onTheWay_;
        passSensor(heardOf_, 2.0 * std::numbers::pi * record_.frequency(section_, 1),
                   sensorOf(model_, Quantity::pressure));
        const double gain = radiationPerArea() / model_.microphoneDistance * model_.path.parameters.front().value;
        for (auto& line : heardOf_)
            line *= gain;
        flow_.assign(fed_.voltage.size(), 0.0);
        for (const auto& law : fed_.laws)
            if (!law.flow.empty())
                lines(flow_) += lines(heardOf_) * lines(law.flow);
        lines(sound) += lines(flow_);
    }

    /// d ln/d of what is heard of each line that leaves beside the cone, by a parameter of the path.
    std::vector<Complex> logSlopesOf(Eigen::Index parameter) const
    {
        std::vector<Complex> slopes(flow_.size(), 0.0);
        const auto sensor = sensorOf(model_, Quantity::pressure);
        const auto sensed = sensorParameters(Quantity::pressure);
        const auto own = std::find_if(sensed.begin(), sensed.end(),
                                      [&](const SensorParameter& p) { return p.place == parameter; });
        for (std::size_t k = 1; k < slopes.size(); ++k) {
            const Complex s(0.0, 2.0 * std::numbers::pi * record_.frequency(section_, k));
            slopes[k] = parameter == 0        ? 1.0 / model_.path.parameters.front().value
                        : parameter == 1      ? -s
                        : own != sensed.end() ? sensor.logSlope(own->value, s)
                                              : 0.0;
        }
        return slopes;
    }

    /// The spectrum of what leaves the cone, of what arrives as late as at rest.
    Spectrum leaving(Spectrum sound) const
    {
        for (std::size_t k = 0; k < sound.size(); ++k)
            sound[k] *= std::conj(onTheWay_[k]);
        return sound;
    }

    /// As late as at rest.
    Spectrum later(const std::vector<double>& flow) const
    {
        auto sound = fft(flow);
        for (std::size_t k = 0; k < sound.size(); ++k)
            sound[k] *= onTheWay_[k];
        return sound;
    }

    /// Makes the sound of laws arrive late; true where any does.
    bool hear(Spectrum& sound)
    {
        for (const auto& law : fed_.laws) {
            if (!law.isLate())
                continue;
            goTheWay();
            const auto flow = inverseFft(leaving(std::move(sound)), section_.window);
            arrival_.emplace_back(law.lateness, record_.sampleRate);
            byLeaving_ = slopeByLeaving(flow, law.lateness, record_.sampleRate);
            sound = later(arrival_.back().heard(flow));
        }
        return !arrival_.empty();
    }

    Eigen::MatrixXd columns(std::size_t c, const std::vector<Eigen::Index>& active, bool heard) const
    {
        Eigen::MatrixXd J = Eigen::MatrixXd::Zero(residual_.rows(), static_cast<Eigen::Index>(active.size()));
        Spectrum slope;
        bool any = false;  // of it is not zero
        const auto add = [&](const Spectrum& path, double sign, const Spectrum& drive) {
            if (path.empty() || drive.empty())
                return;
            lines(slope) += sign * lines(path, paths_.first) * lines(drive);
            any = true;
        };
        const auto& byVoltage = paths_.fromVoltage[c];
        const auto& byForce = paths_.fromForce[c];
        std::vector<std::vector<Eigen::Index>> valuesOfLaws;
        for (const auto k : fed_.component)
            valuesOfLaws.push_back(placesOf(model_, k));
        for (std::size_t a = 0; a < active.size(); ++a) {
            slope.assign(fed_.voltage.size(), 0.0);
            const auto place = static_cast<std::size_t>(active[a]);
            add(byVoltage.slopes[place], 1.0, fed_.voltage);
            add(byForce.slopes[place], 1.0, fed_.force);
            if (const auto ofPath = active[a] - firstParameterOf(model_, model_.components.size());
                record_.channels[c] == Quantity::pressure && ofPath >= 0 && !flow_.empty()) {
                const auto slopes = logSlopesOf(ofPath);
                lines(slope) += lines(flow_) * lines(slopes);
                any = true;
            }
            for (std::size_t law = 0; law < fed_.laws.size(); ++law) {
                const auto own = std::find(valuesOfLaws[law].begin(), valuesOfLaws[law].end(), active[a]);
                if (own == valuesOfLaws[law].end())
                    continue;
                const auto& slopes = *fed_.laws[law].slopes;
                const auto at = static_cast<std::size_t>(own - valuesOfLaws[law].begin());
                add(byForce.value, 1.0, slopes.force[at]);
                if (model_.electrical())
                    add(byVoltage.value, -1.0, slopes.voltage[at]);
                if (record_.channels[c] == Quantity::pressure && !slopes.flow[at].empty()) {
                    lines(slope) += lines(heardOf_) * lines(slopes.flow[at]);
                    any = true;
                }
                if (const auto& lateness = slopes.lateness[at]; heard && !lateness.empty()) {
                    auto change = lateness;
                    for (std::size_t n = 0; n < change.size(); ++n)
                        change[n] *= -byLeaving_[n];
                    const auto late = later(change);
                    lines(slope) += lines(late);  // as at rest, which the fill makes later still
                    any = true;
                }
            }
            if (!std::exchange(any, false))
                continue;
            if (heard)
                slope = later(arrival_.back().heardRoughly(leaving(std::move(slope)), section_.window));
            residual_.fill(c, slope, J.col(static_cast<Eigen::Index>(a)));
        }
        return J;
    }

    const Model& model_;
    const Record& record_;
    const Section& section_;
    const ShownMotion& motion_;
    Residual residual_;
    const Fed& fed_;
    const Paths& paths_;
    const DepartureResponse* departures_;
    std::vector<Arrival> arrival_;
    std::vector<double> byLeaving_;
    Spectrum flow_;      ///< Pa, of laws that radiate beside the cone
    Spectrum heardOf_;   ///< Pa per m/s^2 of a line that leaves beside the cone, where any does
    Spectrum onTheWay_;  ///< what the way to the microphone makes of a line, once it is asked for
};

}  // namespace

std::vector<SectionFit> feedbackError(const Model& model, const Record& record,
                                      const std::vector<std::size_t>& sections, const ShownMotions& motions,
                                      const std::vector<Eigen::Index>& active, const OutputErrorOptions& options,
                                      const Progress& progress, const std::vector<SectionFit>* played,
                                      std::vector<KnownSlopes>* known)
{
    if (played && std::any_of(played->begin(), played->end(), [](const SectionFit& fit) { return !fit.finite; }))
        return *played;
    const bool gradient = options.gradient && !active.empty();
    std::vector<std::vector<bool>> wanted;
    for (std::size_t k = 0; k < model.components.size(); ++k) {
        wanted.emplace_back();
        for (const auto place : placesOf(model, k))
            wanted.back().push_back(gradient && std::binary_search(active.begin(), active.end(), place));
    }
    const auto histories = lawHistories(model, record, sections, motions, gradient);
    const auto paths = pathsToChannels(model, record, sections, gradient, options.threads);
    const auto departures = played ? DepartureResponses {}  // their prediction holds them
                                   : departureResponses(model, record, sections, options.threads);
    std::vector<SectionFit> fits(sections.size());
    inParallel(sections.size(), options.threads, progress, [&](std::size_t s) {
        const auto& section = record.sections[sections[s]];
        const auto fed = feed(model, record, section, motions[s], histories, s, wanted,
                              known && gradient ? &(*known)[s] : nullptr);
        fits[s] = FedSection(model, record, section, motions[s], fed, paths.at(section.window),
                             ofWindow(departures, section))
                      .run(active, options, played ? &(*played)[s] : nullptr);
        return fits[s].finite;
    });
    return fits;
}

Record withoutLaws(const Model& model, const Record& record, unsigned threads)
{
    if (!hasPeriods(record) || !hasLaws(model))
        return record;
    const auto still = linearPart(model);
    std::vector<std::size_t> every(record.sections.size());
    std::iota(every.begin(), every.end(), std::size_t {0});
    OutputErrorOptions run;
    run.gradient = false;
    run.spectra = true;
    run.threads = threads;
    Record result = record;
    result.sectionsDrift = false;  // what the linear part alone would follow is not what moved
    const auto with = quickError(model, result, every, {}, run), without = quickError(still, result, every, {}, run);
    result.sectionsDrift = record.sectionsDrift;
    for (std::size_t s = 0; s < every.size(); ++s) {
        if (!with[s].finite || !without[s].finite)
            return record;
        for (std::size_t c = 0; c < record.channels.size(); ++c)
            for (std::size_t k = 0; k < result.sections[s].measured[c].size(); ++k)
                result.sections[s].measured[c][k] += without[s].predicted[c][k] - with[s].predicted[c][k];
    }
    return result;
}

std::vector<SectionFit> playedError(const Model& model, const Record& record, const std::vector<std::size_t>& sections,
                                    const ShownMotions& motions, const std::vector<Eigen::Index>& active,
                                    const OutputErrorOptions& options, const Progress& progress)
{
    auto simulated = options;
    simulated.gradient = false;
    simulated.spectra = simulated.spectra || options.gradient;
    const auto played = outputError(model, record, sections, active, simulated, progress);
    return options.gradient ? feedbackError(model, record, sections, motions, active, options, progress, &played)
                            : played;
}

bool isBetterPlayed(const Model& model, const Record& record, const std::vector<std::size_t>& sections,
                    const OutputErrorOptions& options)
{
    if (!hasPeriods(record) || !hasLaws(model))
        return false;
    const auto costOf = [&](bool played) {
        auto run = options;
        run.gradient = false;
        run.played = played;
        const auto sum = sumOf(quickError(model, record, sections, {}, run));
        return sum ? sum->cost : std::numeric_limits<double>::infinity();
    };
    return costOf(true) < costOf(false);
}

std::vector<SectionFit> quickError(const Model& model, const Record& record, const std::vector<std::size_t>& sections,
                                   const std::vector<Eigen::Index>& active, const OutputErrorOptions& options,
                                   const Progress& progress)
{
    if (!hasPeriods(record) || (options.played && !(options.gradient && !active.empty())))
        return outputError(model, record, sections, active, options, progress);
    const auto motions = settledMotions(model, record, sections, options.threads);
    return options.played ? playedError(model, record, sections, motions, active, options, progress)
                          : feedbackError(model, record, sections, motions, active, options, progress);
}

}  // namespace excursion
