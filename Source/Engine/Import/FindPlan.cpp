// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Import/FindPlan.h"

#include "Engine/Signal/Fft.h"
#include "Engine/Signal/Level.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <tuple>

namespace excursion {
namespace {

using Complex = std::complex<double>;

constexpr double mostDrift = 300e-6;
constexpr double recognized = 0.5;         // correlation of a period with what it should be
constexpr double leastCorrelation = 0.15;  // of the first period, anywhere
constexpr std::size_t mostPlaces = 64, mostAnchors = 8;
constexpr std::size_t mostJudged = 72;  // periods by which a place is judged

/// Mean power of the bins of a spectrum in bands of a third of an octave, one value a bin.
std::vector<double> envelope(const std::vector<Complex>& spectrum, std::size_t first, std::size_t last)
{
    std::vector<double> result(spectrum.size(), 0.0);
    for (std::size_t begin = first; begin <= last;) {
        const auto end = std::min(last + 1,
                                  std::max(begin + 8, static_cast<std::size_t>(static_cast<double>(begin) * 1.26)));
        double power = 0.0;
        for (std::size_t k = begin; k < end; ++k)
            power += std::norm(spectrum[k]);
        std::fill(result.begin() + static_cast<std::ptrdiff_t>(begin),
                  result.begin() + static_cast<std::ptrdiff_t>(end), power / static_cast<double>(end - begin));
        begin = end;
    }
    return result;
}

/// Normalized correlation of `wanted` with each stretch of `recorded`, both with the spectral envelope of `wanted`.
std::vector<double> correlations(std::span<const double> wanted, std::span<const double> recorded, double lowest,
                                 double highest)
{
    const auto L = quickLength(recorded.size() + wanted.size());
    std::vector<double> padded(wanted.begin(), wanted.end());
    padded.resize(L, 0.0);
    const auto W = fft(padded);
    padded.assign(recorded.begin(), recorded.end());
    padded.resize(L, 0.0);
    auto R = fft(padded);
    const auto first = std::max<std::size_t>(1, static_cast<std::size_t>(lowest * static_cast<double>(L)));
    const auto last = std::min(R.size() - 2, static_cast<std::size_t>(highest * static_cast<double>(L)) + 1);
    const auto wantedPower = envelope(W, first, last), recordedPower = envelope(R, first, last);
    for (std::size_t k = 0; k < R.size(); ++k)
        R[k] *= recordedPower[k] > 0 ? std::sqrt(wantedPower[k] / recordedPower[k]) : 0.0;
    const auto shaped = inverseFft(R, L);
    double energy = 0.0;
    for (std::size_t k = first; k <= last; ++k) {
        energy += 2.0 * std::norm(W[k]) / static_cast<double>(L);
        R[k] *= std::conj(W[k]);
    }
    auto result = inverseFft(R, L);
    std::vector<double> sums(L + 1, 0.0);
    for (std::size_t n = 0; n < L; ++n)
        sums[n + 1] = sums[n] + shaped[n] * shaped[n];
    const auto energyAt = [&](std::size_t n) { return sums[std::min(L, n + wanted.size())] - sums[n]; };
    result.resize(recorded.size());
    double loudest = 0.0;
    for (std::size_t n = 0; n < result.size(); ++n)
        loudest = std::max(loudest, energyAt(n));
    for (std::size_t n = 0; n < result.size(); ++n)  // 1e-3: silence resembles nothing
        result[n] = energy > 0 && loudest > 0 ? result[n] / std::sqrt(energy * (energyAt(n) + 1e-3 * loudest)) : 0.0;
    return result;
}

/// The highest peaks of |c|, no two of them closer than `apart`.
std::vector<std::size_t> peaks(const std::vector<double>& c, std::size_t apart)
{
    std::vector<std::size_t> order;
    for (std::size_t n = 0; n < c.size(); ++n) {
        const double here = std::abs(c[n]);
        if (here >= leastCorrelation && (n == 0 || here >= std::abs(c[n - 1]))
            && (n + 1 == c.size() || here > std::abs(c[n + 1])))
            order.push_back(n);
    }
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return std::abs(c[a]) > std::abs(c[b]); });
    std::vector<std::size_t> kept;
    for (const auto n : order) {
        if (std::none_of(kept.begin(), kept.end(),
                         [&](std::size_t k) { return std::max(k, n) - std::min(k, n) < apart; }))
            kept.push_back(n);
        if (kept.size() == mostPlaces)
            break;
    }
    return kept;
}

/// Follows the periods of a plan through a recording from where one of them was found.
class Track {
public:
    Track(const PlanPeriods& plan, std::span<const double> recorded) : plan_(plan), recorded_(recorded) {}

    /// @param chosen  the periods to look for, in the order of time
    std::optional<PlanPlace> from(std::size_t anchor, std::size_t at, const std::vector<std::size_t>& chosen)
    {
        if (at + plan_.length > recorded_.size())
            return std::nullopt;
        anchor_ = anchor;
        at_ = static_cast<double>(at);
        const auto& X = played(anchor);
        const auto Z = plan_.at(recorded_.subspan(at, plan_.length));
        response_.resize(Z.size());
        double recordedPower = 0.0, playedPower = 0.0;
        for (std::size_t k = 0; k < Z.size(); ++k) {
            response_[k] = std::norm(X[k]) > 0 ? Z[k] / X[k] : 0.0;
            recordedPower += std::norm(Z[k]);
            playedPower += std::norm(X[k]);
        }
        if (!(recordedPower > 0))
            return std::nullopt;
        PlanPlace place;
        place.gain = std::sqrt(recordedPower / playedPower);
        drift_ = 0.0;
        credit_ = 0.0;
        const auto middle = std::lower_bound(chosen.begin(), chosen.end(), anchor);
        walk(std::vector<std::size_t>(middle, chosen.end()), false, place.sightings);
        std::vector<std::size_t> before(chosen.begin(), middle);
        std::reverse(before.begin(), before.end());
        walk(before, true, place.sightings);
        std::sort(place.sightings.begin(), place.sightings.end(),
                  [](const auto& a, const auto& b) { return a.period < b.period; });
        fitLine(place);
        return place;
    }

    double credit() const { return credit_; }

private:
    const std::vector<Complex>& played(std::size_t period) const { return plan_.played[plan_.periods[period].block]; }
    double timeOf(std::size_t period) const { return static_cast<double>(plan_.periods[period].start); }

    struct Match {
        double later = 0.0, correlation = 0.0, gain = 0.0;
    };

    /// Where, later than `at` and modulo a period, the stretch there is most like the period.
    Match compare(std::size_t period, std::size_t at, std::size_t within) const
    {
        const auto N = plan_.length;
        const auto spectrum = fft(recorded_.subspan(at, N));
        const auto& X = played(period);
        double recordedPower = 0.0, expectedPower = 0.0;
        for (auto k = static_cast<std::size_t>(plan_.lines.front()); k <= static_cast<std::size_t>(plan_.lines.back());
             ++k)
            recordedPower += std::norm(spectrum[k]);
        std::vector<Complex> cross(N / 2 + 1);
        for (std::size_t i = 0; i < X.size(); ++i) {
            const auto k = static_cast<std::size_t>(plan_.lines[i]);
            const auto expected = X[i] * response_[i];
            cross[k] = spectrum[k] * std::conj(expected);
            expectedPower += std::norm(expected);
        }
        if (!(recordedPower > 0) || !(expectedPower > 0))
            return {};
        const auto c = inverseFft(cross, N);
        const auto value = [&](std::ptrdiff_t lag) {
            const auto n = static_cast<std::ptrdiff_t>(N);
            return c[static_cast<std::size_t>((lag % n + n) % n)];
        };
        const auto reach = static_cast<std::ptrdiff_t>(std::min(within, N / 2 - 1));
        std::ptrdiff_t best = 0;
        for (std::ptrdiff_t lag = -reach; lag <= reach; ++lag)
            if (value(lag) > value(best))
                best = lag;
        const double bend = value(best - 1) - 2 * value(best) + value(best + 1);
        const double part = bend < 0 ? std::clamp((value(best - 1) - value(best + 1)) / (2 * bend), -0.5, 0.5) : 0.0;
        const double product = value(best) * static_cast<double>(N) / 2;
        return {static_cast<double>(best) + part, product / std::sqrt(recordedPower * expectedPower),
                product / expectedPower};
    }

    void walk(const std::vector<std::size_t>& periods, bool backwards, std::vector<Sighting>& sightings)
    {
        double time = timeOf(anchor_), at = at_;
        for (const auto period : periods) {
            const double elapsed = timeOf(period) - time, predicted = at + elapsed * (1 + drift_);
            Sighting sighting {period, predicted, false, false, 0.0};
            const double whole = std::round(predicted);
            sighting.inside = whole >= 0
                              && whole + static_cast<double>(plan_.length) <= static_cast<double>(recorded_.size());
            if (sighting.inside) {
                const auto start = static_cast<std::size_t>(whole);
                const auto match = compare(period, start, static_cast<std::size_t>(4 + mostDrift * std::abs(elapsed)));
                const double evenness = match.gain > 0 ? std::min(match.gain, 1 / match.gain) : 0.0;
                credit_ += 2 * match.correlation * evenness - 1;
                sighting.seen = match.correlation >= recognized;
                if (sighting.seen) {
                    sighting.at = whole + match.later;
                } else if (const auto elsewhere = compare(period, start, plan_.length); elsewhere.correlation >= 0.8) {
                    sighting.seen = true;
                    sighting.at = whole + elsewhere.later;
                    sighting.jump = sighting.at - predicted;
                    if (backwards)  // it is what comes after this period that jumps
                        sighting.jump *= -1;
                }
                if (sighting.seen) {
                    time = timeOf(period);
                    at = sighting.at;
                    const double span = time - timeOf(anchor_);
                    const double least = (plan_.sweeps ? 1.0 : 2.0) * static_cast<double>(plan_.length);
                    if (sighting.jump == 0.0 && std::abs(span) >= 0.999 * least && !jumped(sightings))
                        drift_ = std::clamp((at - at_) / span - 1, -mostDrift, mostDrift);
                }
            }
            sightings.push_back(sighting);
        }
    }

    static bool jumped(const std::vector<Sighting>& sightings)
    {
        return std::any_of(sightings.begin(), sightings.end(), [](const Sighting& s) { return s.jump != 0.0; });
    }

    /// Least squares over what was seen and stands where it should.
    void fitLine(PlanPlace& place) const
    {
        double count = 0.0, meanTime = 0.0, meanAt = 0.0;
        for (const auto& s : place.sightings)
            if (s.seen) {
                count += 1;
                meanTime += timeOf(s.period);
                meanAt += s.at;
            }
        place.step = 1 + drift_;
        place.start = at_ - timeOf(anchor_) * place.step;
        if (count < (plan_.sweeps ? 2 : 3)) {
            place.start -= lateBy(place.step);
            return;
        }
        meanTime /= count;
        meanAt /= count;
        double square = 0.0, product = 0.0;
        for (const auto& s : place.sightings)
            if (s.seen) {
                square += (timeOf(s.period) - meanTime) * (timeOf(s.period) - meanTime);
                product += (timeOf(s.period) - meanTime) * (s.at - meanAt);
            }
        if (square > 0 && !jumped(place.sightings)) {
            place.step = product / square;
            place.start = meanAt - place.step * meanTime;
        }
        place.start -= lateBy(place.step);
    }

    /// What was found is the middle of a sweep, half of one after its beginning on the recorder's clock.
    double lateBy(double step) const { return plan_.sweeps ? (step - 1) * static_cast<double>(plan_.length) / 2 : 0.0; }

    const PlanPeriods& plan_;
    std::span<const double> recorded_;
    std::vector<Complex> response_;
    std::size_t anchor_ = 0;
    double at_ = 0.0, drift_ = 0.0, credit_ = 0.0;
};

/// Periods to begin with: the last ones of blocks, which are steady. The first of each level come first, the loud ones
/// before the quiet ones: a recording may have been cut short.
std::vector<std::size_t> anchors(const std::vector<double>& played, const PlanPeriods& plan)
{
    struct Anchor {
        std::size_t period = 0, turn = 0;  ///< how many blocks of that loudness came before it
        long loudness = 0;                 ///< in steps of 1 dB
    };
    std::vector<Anchor> found;
    for (std::size_t p = 0; p < plan.periods.size(); ++p) {
        const bool lastOfBlock = p + 1 == plan.periods.size() || plan.periods[p + 1].block != plan.periods[p].block;
        if (!lastOfBlock)
            continue;
        const auto* x = played.data() + plan.periods[p].start;
        Anchor anchor {p, 0, std::lround(decibelsOf(std::inner_product(x, x + plan.length, x, 0.0)))};
        for (const auto& other : found)
            anchor.turn += other.loudness == anchor.loudness ? 1 : 0;
        found.push_back(anchor);
    }
    std::stable_sort(found.begin(), found.end(), [](const Anchor& a, const Anchor& b) {
        return std::tie(a.turn, b.loudness) < std::tie(b.turn, a.loudness);
    });
    std::vector<std::size_t> periods;
    for (const auto& anchor : found)
        periods.push_back(anchor.period);
    return periods;
}

/// The periods that judge a place: all, or the first and the last of blocks.
std::vector<std::size_t> judges(const PlanPeriods& plan)
{
    std::vector<std::size_t> all(plan.periods.size());
    std::iota(all.begin(), all.end(), 0u);
    if (all.size() <= mostJudged)
        return all;
    std::vector<std::size_t> edges;
    for (const auto p : all)
        if (p == 0 || p + 1 == all.size() || plan.periods[p - 1].block != plan.periods[p].block
            || plan.periods[p + 1].block != plan.periods[p].block)
            edges.push_back(p);
    std::vector<std::size_t> chosen;
    const auto every = (edges.size() + mostJudged - 1) / mostJudged;
    for (std::size_t i = 0; i < edges.size(); ++i)
        if ((i / 2) % every == 0)  // both edges of a block
            chosen.push_back(edges[i]);
    return chosen;
}

/// Samples of a period to correlate with: so few that drift does not blur the middle of its power.
std::size_t templateLength(const std::vector<Complex>& X, const PlanPeriods& plan)
{
    if (plan.sweeps) {  // its middle plays the middle of the band
        const double middle = std::sqrt(static_cast<double>(plan.lines.front()) * plan.lines.back())
                              / static_cast<double>(plan.length);
        return std::min(plan.length, static_cast<std::size_t>(1.0 / (2 * mostDrift * middle)));
    }
    double power = 0.0, moment = 0.0;
    for (std::size_t i = 0; i < X.size(); ++i) {
        power += std::norm(X[i]);
        moment += std::norm(X[i]) * plan.lines[i];
    }
    const double frequency = moment / power / static_cast<double>(plan.length);  // cycles a sample
    const auto sharp = static_cast<std::size_t>(1.0 / (2 * mostDrift * frequency));
    return std::min(plan.length, std::max<std::size_t>(sharp, 4096));
}

}  // namespace

std::size_t PlanPlace::inside() const
{
    return static_cast<std::size_t>(
        std::count_if(sightings.begin(), sightings.end(), [](const auto& s) { return s.inside; }));
}

std::size_t PlanPlace::seen() const
{
    return static_cast<std::size_t>(
        std::count_if(sightings.begin(), sightings.end(), [](const auto& s) { return s.seen && s.jump == 0.0; }));
}

PlanPlace findPlan(const std::vector<double>& played, const PlanPeriods& plan, std::span<const double> recorded)
{
    PlanPlace best;
    if (recorded.size() < plan.length)
        return best;
    const auto N = static_cast<double>(plan.length);
    const auto judging = judges(plan);
    Track track(plan, recorded);
    double bestCredit = 0.0;
    std::vector<std::size_t> all(plan.periods.size());
    std::iota(all.begin(), all.end(), 0u);
    std::size_t tried = 0;
    for (const auto anchor : anchors(played, plan)) {
        if (++tried > mostAnchors)
            break;
        const auto L = templateLength(plan.played[plan.periods[anchor].block], plan);
        const auto offset = (plan.length - L) / 2;
        const auto c = correlations(std::span(played).subspan(plan.periods[anchor].start + offset, L), recorded,
                                    0.9 * plan.lines.front() / N, 1.1 * plan.lines.back() / N);
        std::optional<std::size_t> bestAt;
        for (const auto peak : peaks(c, plan.length / 4)) {
            if (peak < offset)
                continue;
            const auto place = track.from(anchor, peak - offset, judging);
            if (!place)
                continue;
            // What began before the recording is no take, but it must be told from what was never played.
            const double credit = track.credit() - (place->start < -8.0 ? 0.5 : 0.0);
            if (credit > bestCredit) {
                bestCredit = credit;
                bestAt = peak - offset;
            }
        }
        if (!bestAt)
            continue;
        best = track.from(anchor, *bestAt, all).value();
        best.found = best.seen() >= (plan.sweeps ? 1u : 2u) && 2 * best.seen() > best.inside();
        if (best.start >= -8.0 && 10 * best.seen() >= 9 * all.size())
            break;  // nothing could fit better
    }
    return best;
}

}  // namespace excursion
