// SPDX-License-Identifier: GPL-3.0-or-later
#include "Study/Summary.h"

#include "Study/OutcomeFile.h"
#include "Study/Tables.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

namespace excursion::study {
namespace {

template <class... Values>
std::string formatted(const char* format, Values... values)
{
    char buffer[400];
    const int length = std::snprintf(buffer, sizeof buffer, format, values...);
    return {buffer, static_cast<std::size_t>(std::clamp(length, 0, static_cast<int>(sizeof buffer) - 1))};
}

std::string joined(const std::vector<std::string>& words)
{
    std::string all;
    for (const auto& word : words)
        all += (all.empty() ? "" : ",") + word;
    return all.empty() ? "-" : all;
}

std::string row(const char* what, const Share& share, double target)
{
    auto result = formatted("  %-58s %5.1f %%  (%d of %d)", what, 100.0 * share.value(), share.count, share.of);
    if (target > 0.0)
        result += formatted("  %s %.0f %%", share.value() >= target ? "reaches" : "MISSES", 100.0 * target);
    return result + "\n";
}

}  // namespace

void Calibration::add(double confidence, bool right)
{
    const auto place = std::clamp(static_cast<int>(confidence * bins), 0, bins - 1);
    auto& bin = byConfidence[static_cast<std::size_t>(place)];
    bin.right += right;
    ++bin.of;
    bin.confidence += confidence;
}

int Calibration::count() const
{
    return std::accumulate(byConfidence.begin(), byConfidence.end(), 0,
                           [](int sum, const Bin& b) { return sum + b.of; });
}

double Calibration::error() const
{
    double sum = 0.0;
    for (const auto& bin : byConfidence)
        sum += std::abs(bin.right - bin.confidence);
    return sum / std::max(1, count());
}

bool Summary::diagnosed() const
{
    return named.value() >= 0.98 && untouched.value() >= 0.99 && atNoise.value() >= 0.90;
}

bool Summary::reached() const { return diagnosed() && inBand.value() >= 0.85; }

double Summary::f1() const
{
    const int parts = shown + found + falselyAdded;  // added ones that do not show are neither right nor wrong
    return parts > 0 ? 2.0 * found / parts : 1.0;
}

Summary summarize(const std::vector<Outcome>& outcomes)
{
    Summary summary;
    std::vector<double> ratios;
    for (const auto& o : outcomes) {
        if (o.odd()) {
            summary.oddNothingFalse.add(o.failure.empty() && o.falselyAdded() == 0);
            if (o.oddityDb >= standsOutDb)
                summary.oddHonest.add(o.honest());
        }
        if (o.control() && o.odd()) {
            summary.falselyAdded += o.falselyAdded();
        } else if (o.control()) {
            summary.untouched.add(o.nothingAdded());
        } else if (o.whole()) {
            for (std::size_t n = 0; n < o.showDb.size(); ++n) {
                const bool added = std::find(o.added.begin(), o.added.end(), o.what.hidden[n]) != o.added.end();
                if (o.shows(n)) {
                    ++summary.shown;
                    summary.found += added;
                    summary.foundOf[o.what.hidden[n]].add(added);
                }
            }
            summary.falselyAdded += o.falselyAdded();
        } else if (o.standsDb >= standsOutDb) {
            summary.named.add(o.named());
            summary.alone.add(o.explained());
        } else {
            summary.faint.add(o.named());
        }
        for (std::size_t n = 0; n < std::min(o.added.size(), o.confidence.size()); ++n)
            summary.calibration.add(o.confidence[n], o.isThere(o.added[n]));
        if (!o.odd())
            summary.atNoise.add(o.finalDb <= nearNoiseDb);
        if (o.improveSeconds > 0.0)
            ratios.push_back(o.improveSeconds / o.takeSeconds);
        for (const auto& law : o.laws)
            if (law.hidden)
                for (auto* share : {&summary.inBand, &summary.inBandOf[law.effect]}) {
                    share->count += law.inside;
                    share->of += law.points;
                }
    }
    if (!ratios.empty()) {
        std::nth_element(ratios.begin(), ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2), ratios.end());
        summary.medianTimeRatio = ratios[ratios.size() / 2];
    }
    return summary;
}

std::string line(const Outcome& o)
{
    std::string hidden;
    for (std::size_t n = 0; n < o.what.hidden.size(); ++n) {
        hidden += (n > 0 ? ", " : "") + o.what.hidden[n];
        if (n < o.strengths.size())
            hidden += formatted(" %.2f", o.strengths[n]);
        if (n < o.showDb.size())
            hidden += formatted(" (%.0f dB)", o.showDb[n]);
    }
    auto result = formatted("%s seed %-4llu %-9s %5.1f kHz noise %5.1f dB, hidden ", o.explained() ? "ok   " : "WRONG",
                            static_cast<unsigned long long>(o.what.seed), o.driver.c_str(), o.sampleRate / 1000.0,
                            o.noiseDb)
                  + (o.control() ? "nothing" : hidden)
                  + (o.odd() ? formatted(" beside %s (%.0f dB)", o.what.oddity.c_str(), o.oddityDb) : "") + ": ";
    if (!o.failure.empty())
        return result + "failed: " + o.failure;
    result += formatted("stands %5.1f dB, first %s, added %s", o.standsDb, o.first.empty() ? "-" : o.first.c_str(),
                        joined(o.added).c_str());
    if (!o.withdrawn.empty())
        result += ", withdrawn " + joined(o.withdrawn);
    result += formatted(", %s, final %.2f dB", o.verdict.c_str(), o.finalDb);
    for (const auto& law : o.laws)
        result += formatted(", %s %d/%d in band (%.2g)", law.effect.c_str(), law.inside, law.points, law.spread);
    return result + formatted(", %.1f s = %.1f x", o.improveSeconds, o.improveSeconds / o.takeSeconds);
}

std::string text(const Summary& s, const std::vector<Outcome>& outcomes)
{
    std::string result = "\n";
    result += row("hidden effect first, where it stands 6 dB above the noise", s.named, 0.98);
    result += row("  ... and the only one added", s.alone, 0.0);
    result += row("hidden effect first, where it does not", s.faint, 0.0);
    if (s.shown > 0) {
        result += formatted(
            "  of several hidden effects %d of %d that show were added, %d beside them that are not there: F1 %.3f\n",
            s.found, s.shown, s.falselyAdded, s.f1());
        for (const auto& [effect, share] : s.foundOf)
            result += row(("  " + effect).c_str(), share, 0.0);
    }
    if (s.oddNothingFalse.of > 0) {
        result += row("beside something unknown: not called complete, or its kin named", s.oddHonest, 1.0);
        result += row("beside something unknown: nothing added that is not there", s.oddNothingFalse, 0.97);
    }
    result += row("controls to which nothing was added", s.untouched, 0.99);
    result += row("final validation error within 3 dB of the noise", s.atNoise, 0.90);
    result += row("points of the true laws inside the 95 % bands", s.inBand, 0.85);
    for (const auto& [effect, share] : s.inBandOf)
        result += row(("  " + effect).c_str(), share, 0.0);
    if (s.calibration.count() > 0) {
        result += formatted("  calibration error of the confidence in %d added effects: %.1f %%\n",
                            s.calibration.count(), 100.0 * s.calibration.error());
        for (const auto& bin : s.calibration.byConfidence)
            if (bin.of > 0)
                result += formatted("    of %3d that were %5.1f %% sure on average %5.1f %% are there\n", bin.of,
                                    100.0 * bin.confidence / bin.of, 100.0 * bin.right / bin.of);
    }
    result += formatted("  median time of improve over the take's length: %.2f\n", s.medianTimeRatio);
    result += text(tabulate(outcomes));
    bool any = false;
    for (const auto& o : outcomes)
        if (!o.explained() || (!o.odd() && o.finalDb > nearNoiseDb)) {
            result += any ? "" : "\nNot as they should be:\n";
            any = true;
            result += "  " + line(o) + "\n";
        }
    return result;
}

nlohmann::ordered_json toJson(const Summary& s, const std::vector<Outcome>& outcomes)
{
    using Json = nlohmann::ordered_json;
    const auto share = [](const Share& part) {
        return Json {{"share", part.value()}, {"count", part.count}, {"of", part.of}};
    };
    Json document {{"format", "excursion-study"}, {"version", 1}};
    document["named"] = share(s.named);
    document["namedAlone"] = share(s.alone);
    document["namedFaint"] = share(s.faint);
    document["several"] = {{"shown", s.shown}, {"found", s.found}, {"falselyAdded", s.falselyAdded}, {"f1", s.f1()}};
    for (const auto& [effect, part] : s.foundOf)
        document["foundOf"][effect] = share(part);
    if (s.oddNothingFalse.of > 0)
        document["besideUnknown"] = {{"notComplete", share(s.oddHonest)}, {"nothingFalse", share(s.oddNothingFalse)}};
    document["controlsUntouched"] = share(s.untouched);
    document["atNoise"] = share(s.atNoise);
    document["inBand"] = share(s.inBand);
    for (const auto& [effect, part] : s.inBandOf)
        document["inBandOf"][effect] = share(part);
    auto& calibration = document["calibration"] = {{"effects", s.calibration.count()},
                                                   {"error", s.calibration.error()}};
    for (const auto& bin : s.calibration.byConfidence)
        if (bin.of > 0)
            calibration["bins"].push_back(
                {{"confidence", bin.confidence / bin.of}, {"there", share({bin.right, bin.of})}});
    document["medianTimeRatio"] = s.medianTimeRatio;
    document["tables"] = toJson(tabulate(outcomes));
    document["takes"] = Json::array();
    for (const auto& o : outcomes)
        document["takes"].push_back(toJson(o));
    return document;
}

}  // namespace excursion::study
