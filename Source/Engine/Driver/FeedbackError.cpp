// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Driver/FeedbackError.h"

#include "Engine/Driver/Arrival.h"
#include "Engine/Driver/EachSection.h"
#include "Engine/Driver/LawDrive.h"
#include "Engine/Driver/Linearize.h"
#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

namespace excursion {
namespace {

using Complex = std::complex<double>;

/// Responses of several quantities to the voltage and to a force on the cone, on the lines of a window.
struct Paths {
    std::vector<Response> fromVoltage, fromForce;   ///< by quantity; by line from `first` on
    std::size_t first = 0;
    double lateness = 0.0;   ///< s, of the sound at rest
};

/// 0 Hz is taken for a small share of the first line's frequency, where nothing divides by zero.
Paths pathsOf(const Model& model, const std::vector<Quantity>& quantities, std::size_t first, std::size_t last, double resolution, bool withGradient,
              unsigned threads = 1)
{
    constexpr double nearlyRest = 1e-3;
    std::vector<double> frequency;
    for (std::size_t k = first; k <= last; ++k)
        frequency.push_back(resolution * (k > 0 ? static_cast<double>(k) : nearlyRest));
    Paths paths {{}, {}, first, linearize(model).lateness};
    forEachSection(2, threads, {}, [&](std::size_t n) {
        (n == 0 ? paths.fromVoltage : paths.fromForce) = respond(model, quantities, frequency, withGradient, n == 0 ? Drives::terminals : Drives::cone);
        return true;
    });
    return paths;
}

bool isLaw(const Component& component) { return !component.effect->linear(); }

/// What all laws make of the motion of one section.
struct Fed {
    std::vector<std::size_t> component;   ///< of the model, one a law
    std::vector<LawDrive> laws;
    Spectrum voltage, force;              ///< at the terminals with the laws' taken away, and on the cone
};

/// Memories of the laws a quarter of a period before the window of each section: of slow ones with their history, of others settled.
std::vector<MemoryStart> startsOf(const Component& law, const Record& record, const std::vector<std::size_t>& sections, const ShownMotions& motions,
                                  bool withGradient)
{
    const auto size = static_cast<Eigen::Index>(law.effect->memorySize(law.extent));
    const auto count = static_cast<Eigen::Index>(law.parameters.size());
    std::vector<MemoryStart> starts(sections.size(), {Eigen::VectorXd::Zero(size), Eigen::MatrixXd::Zero(size, count)});
    if (size == 0)
        return starts;
    if (!law.effect->slow()) {
        for (std::size_t s = 0; s < sections.size(); ++s) {
            const std::size_t N = record.sections[sections[s]].window;
            starts[s] = settledMemory(law, motions[s].coarse, N - N / 4, record.sampleRate);
        }
        return starts;
    }
    // Sections that are not asked for have heated the coil all the same: as much as those of the same level, or of the nearest.
    std::vector<PeriodicMotion> all;
    std::vector<double> run;
    for (const auto& section : record.sections) {
        const auto nearest = std::min_element(sections.begin(), sections.end(), [&](std::size_t a, std::size_t b) {
            const auto distance = [&](std::size_t n) {
                const auto& other = record.sections[n];
                return std::pair(&other == &section ? 0 : 1, std::abs(other.level - section.level));
            };
            return distance(a) < distance(b);
        });
        all.push_back(motions[static_cast<std::size_t>(nearest - sections.begin())].coarse);
        run.push_back(0.75 * static_cast<double>(section.window) / record.sampleRate);
    }
    const auto histories = historyOf(law, record, all, run, withGradient);
    for (std::size_t s = 0; s < sections.size(); ++s)
        starts[s] = histories[sections[s]];
    return starts;
}

using Starts = std::vector<std::vector<MemoryStart>>;   ///< [component][section]

Starts startsOf(const Model& model, const Record& record, const std::vector<std::size_t>& sections, const ShownMotions& motions, bool withGradient)
{
    Starts starts;
    for (const auto& component : model.components)
        starts.push_back(isLaw(component) ? startsOf(component, record, sections, motions, withGradient) : std::vector<MemoryStart> {});
    return starts;
}

Fed feed(const Model& model, const Record& record, const Section& section, const ShownMotion& motion, const Starts& starts, std::size_t place,
         const std::vector<std::vector<bool>>& wanted)
{
    Fed fed;
    fed.voltage = fft(section.input);
    fed.force.assign(fed.voltage.size(), 0.0);
    for (std::size_t k = 1; k < model.components.size(); ++k) {
        if (!isLaw(model.components[k]))
            continue;
        auto drive = driveOf(model.components[k], motion, starts[k][place], record.sampleRate, wanted.empty() ? std::vector<bool> {} : wanted[k]);
        for (std::size_t n = 0; n < fed.voltage.size(); ++n) {
            if (model.electrical())
                fed.voltage[n] -= drive.voltage[n];
            fed.force[n] += drive.force[n];
        }
        fed.component.push_back(k);
        fed.laws.push_back(std::move(drive));
    }
    return fed;
}

/// Residuals and columns of one section.
class FedSection {
public:
    FedSection(const Model& model, const Record& record, const Section& section, const Fed& fed, const Paths& paths)
        : model_(model), record_(record), section_(section), fed_(fed), paths_(paths)
    {
        std::tie(first_, last_) = record.lineRange(section);
        lines_ = static_cast<Eigen::Index>(last_ - first_ + 1);
    }

    SectionFit run(const std::vector<Eigen::Index>& active, const OutputErrorOptions& options)
    {
        SectionFit fit;
        fit.finite = true;
        for (std::size_t c = 0; c < record_.channels.size(); ++c) {
            auto predicted = sum(c, fed_.voltage, fed_.force);
            const bool heard = record_.channels[c] == Quantity::pressure && hear(predicted);
            NormalEquations normal;
            ErrorPower power;
            Eigen::VectorXd r(2 * lines_);
            for (Eigen::Index n = 0; n < lines_; ++n) {
                const auto k = first_ + static_cast<std::size_t>(n);
                const auto error = predicted[k] - section_.measured[c][k];
                r[n] = weight(c, k) * error.real();
                r[lines_ + n] = weight(c, k) * error.imag();
                power.error += std::norm(error);
                power.measured += std::norm(section_.measured[c][k]);
                power.noise += section_.deviation[c][k] * section_.deviation[c][k];
            }
            normal.cost = r.squaredNorm();
            normal.rows = static_cast<double>(2 * lines_);
            fit.finite = fit.finite && std::isfinite(normal.cost);
            if (options.gradient && !active.empty()) {
                const auto J = columns(c, active, heard);
                normal.N.setZero(J.cols(), J.cols());
                normal.N.selfadjointView<Eigen::Upper>().rankUpdate(J.transpose());
                normal.N.triangularView<Eigen::StrictlyLower>() = normal.N.transpose();
                normal.g.noalias() = J.transpose() * r;
            }
            fit.channels.push_back(std::move(normal));
            fit.power.push_back(power);
            if (options.spectra)
                fit.predicted.push_back(std::move(predicted));
        }
        return fit;
    }

private:
    double weight(std::size_t c, std::size_t line) const { return std::numbers::sqrt2 / section_.deviation[c][line]; }

    /// The spectrum that a voltage and a force make of a channel.
    Spectrum sum(std::size_t c, const Spectrum& voltage, const Spectrum& force) const
    {
        Spectrum result(voltage.size(), 0.0);
        for (std::size_t k = first_; k <= last_; ++k)
            result[k] = paths_.fromVoltage[c].value[k - paths_.first] * voltage[k] + paths_.fromForce[c].value[k - paths_.first] * force[k];
        return result;
    }

    /// What leaves the cone, of what arrives as late as at rest.
    std::vector<double> leaving(const Spectrum& sound) const { return inverseFft(later(sound, -paths_.lateness), section_.window); }
    /// What arrives, as late as the laws make it.
    Spectrum arriving(const std::vector<double>& flow) const { return later(fft(arrival_.back().heard(flow)), paths_.lateness); }

    Spectrum later(Spectrum sound, double time) const
    {
        for (std::size_t k = 0; k < sound.size(); ++k)
            sound[k] *= std::polar(1.0, -2.0 * std::numbers::pi * record_.frequency(section_, k) * time);
        return sound;
    }

    /// Makes the sound of laws arrive late; true where any does.
    bool hear(Spectrum& sound)
    {
        for (const auto& law : fed_.laws) {
            if (law.lateness.empty())
                continue;
            const auto flow = leaving(sound);
            arrival_.emplace_back(law.lateness, record_.sampleRate);
            byLeaving_ = slopeOf(flow, record_.sampleRate);
            const auto drift = slopeOf(law.lateness, record_.sampleRate);
            for (std::size_t n = 0; n < flow.size(); ++n)
                byLeaving_[n] /= 1.0 + drift[n];
            sound = arriving(flow);
        }
        return !arrival_.empty();
    }

    Eigen::MatrixXd columns(std::size_t c, const std::vector<Eigen::Index>& active, bool heard) const
    {
        Eigen::MatrixXd J = Eigen::MatrixXd::Zero(2 * lines_, static_cast<Eigen::Index>(active.size()));
        Spectrum slope(fed_.voltage.size(), 0.0);
        const auto fill = [&](Eigen::Index column, const auto& at) {
            for (std::size_t k = first_; k <= last_; ++k)
                slope[k] = at(k);
            if (heard)
                slope = arriving(leaving(slope));
            for (Eigen::Index n = 0; n < lines_; ++n) {
                const auto k = first_ + static_cast<std::size_t>(n);
                const Complex row = weight(c, k) * slope[k];
                J(n, column) = row.real();
                J(lines_ + n, column) = row.imag();
            }
            if (heard)
                std::fill(slope.begin(), slope.end(), 0.0);
        };
        const auto& byVoltage = paths_.fromVoltage[c];
        const auto& byForce = paths_.fromForce[c];
        std::vector<std::pair<std::size_t, std::size_t>> owner;   // law (or none) and own index of every parameter
        const auto none = fed_.laws.size();
        for (std::size_t k = 0; k < model_.components.size(); ++k) {
            const auto law = static_cast<std::size_t>(std::find(fed_.component.begin(), fed_.component.end(), k) - fed_.component.begin());
            for (std::size_t j = 0; j < model_.components[k].parameters.size(); ++j)
                owner.emplace_back(law, j);
        }
        owner.resize(owner.size() + model_.path.parameters.size(), {none, 0});
        for (std::size_t a = 0; a < active.size(); ++a) {
            const auto column = static_cast<Eigen::Index>(a);
            const auto [law, own] = owner[static_cast<std::size_t>(active[a])];
            if (law == none) {
                fill(column, [&](std::size_t k) {
                    const auto row = static_cast<Eigen::Index>(k - paths_.first);
                    return byVoltage.gradient(row, active[a]) * fed_.voltage[k] + byForce.gradient(row, active[a]) * fed_.force[k];
                });
                continue;
            }
            const auto& drive = fed_.laws[law];
            const auto &U = drive.voltageSlopes[own], &F = drive.forceSlopes[own];
            if (U.empty())
                continue;
            const double electrical = model_.electrical() ? 1.0 : 0.0;
            Spectrum late;
            if (heard && !drive.latenessSlopes[own].empty()) {
                auto change = drive.latenessSlopes[own];
                for (std::size_t n = 0; n < change.size(); ++n)
                    change[n] *= -byLeaving_[n];
                late = later(fft(change), paths_.lateness);   // as at rest, which arriving() makes later still
            }
            fill(column, [&](std::size_t k) {
                const auto sum = byForce.value[k - paths_.first] * F[k] - electrical * byVoltage.value[k - paths_.first] * U[k];
                return late.empty() ? sum : sum + late[k];
            });
        }
        return J;
    }

    const Model& model_;
    const Record& record_;
    const Section& section_;
    const Fed& fed_;
    const Paths& paths_;
    std::size_t first_ = 0, last_ = 0;
    Eigen::Index lines_ = 0;
    std::vector<Arrival> arrival_;
    std::vector<double> byLeaving_;
};

} // namespace

bool hasPeriods(const Record& record)
{
    return std::all_of(record.sections.begin(), record.sections.end(), [](const Section& s) { return s.periodic && s.window == s.input.size(); });
}

ShownMotions shownMotions(const Model& model, const Record& record, const std::vector<std::size_t>& sections, const ShownMotions& before)
{
    const std::vector motion {Quantity::current, Quantity::displacement};
    const auto starts = before.empty() ? Starts {} : startsOf(model, record, sections, before, false);
    std::map<std::size_t, Paths> paths;   // by window
    ShownMotions motions;
    for (std::size_t s = 0; s < sections.size(); ++s) {
        const auto& section = record.sections[sections[s]];
        const auto last = record.lineRange(section).second;
        if (!paths.contains(section.window))
            paths[section.window] = pathsOf(model, motion, 0, last, record.sampleRate / static_cast<double>(section.window), false);
        const auto fed = before.empty() ? Fed {{}, {}, fft(section.input), Spectrum(section.window / 2 + 1, 0.0)}
                                        : feed(model, record, section, before[s], starts, s, {});
        std::array<Spectrum, 2> expected;
        for (std::size_t q = 0; q < 2; ++q) {
            expected[q].assign(fed.voltage.size(), 0.0);
            for (std::size_t k = 0; k <= last; ++k)
                expected[q][k] = paths[section.window].fromVoltage[q].value[k] * fed.voltage[k] + paths[section.window].fromForce[q].value[k] * fed.force[k];
            expected[q][0] = expected[q][0].real();
        }
        motions.push_back(shownMotion(record, section, expected[0], expected[1]));
    }
    return motions;
}

ShownMotions settledMotions(const Model& model, const Record& record, const std::vector<std::size_t>& sections)
{
    return shownMotions(model, record, sections, shownMotions(model, record, sections));
}

std::vector<SectionFit> feedbackError(const Model& model, const Record& record, const std::vector<std::size_t>& sections, const ShownMotions& motions,
                                      const std::vector<Eigen::Index>& active, const OutputErrorOptions& options, const Progress& progress)
{
    const bool gradient = options.gradient && !active.empty();
    std::vector<std::vector<bool>> wanted;
    Eigen::Index index = 0;
    for (const auto& component : model.components) {
        wanted.emplace_back();
        for (std::size_t j = 0; j < component.parameters.size(); ++j, ++index)
            wanted.back().push_back(gradient && std::binary_search(active.begin(), active.end(), index));
    }
    const auto starts = startsOf(model, record, sections, motions, gradient);
    std::map<std::size_t, Paths> paths;   // by window
    for (const auto s : sections)
        if (const auto& section = record.sections[s]; !paths.contains(section.window)) {
            const auto [first, last] = record.lineRange(section);
            paths[section.window] = pathsOf(model, record.channels, first, last, record.sampleRate / static_cast<double>(section.window), gradient,
                                             options.threads);
        }
    std::vector<SectionFit> fits(sections.size());
    forEachSection(sections.size(), options.threads, progress, [&](std::size_t s) {
        const auto& section = record.sections[sections[s]];
        const auto fed = feed(model, record, section, motions[s], starts, s, wanted);
        fits[s] = FedSection(model, record, section, fed, paths.at(section.window)).run(active, options);
        return fits[s].finite;
    });
    return fits;
}

} // namespace excursion
