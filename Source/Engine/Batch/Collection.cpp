// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Batch/Collection.h"

#include "Engine/Batch/Statistics.h"
#include "Engine/Datasheet/LawTable.h"
#include "Engine/Datasheet/ThieleSmall.h"
#include "Engine/Design/StrokeLimits.h"
#include "Engine/Diagnosis/ComparisonFile.h"
#include "Engine/Diagnosis/Remainder.h"
#include "Engine/Document/Figures.h"
#include "Engine/Document/Words.h"
#include "Engine/Error.h"
#include "Engine/Numerics/Median.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace excursion {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t fewestForOutliers = 5, fewestForGolden = 3;

struct Figured {
    double value = nothing, error = nothing;
};

/// The table as it grows: a quantity is there once a unit has named it, in the order of the first unit that does.
class Table {
public:
    explicit Table(std::size_t units) : units_(units) {}

    void put(std::size_t unit, const std::string& name, const std::string& unitName, Figured figure,
             bool ofDriver = true)
    {
        auto found = std::find_if(rows.begin(), rows.end(), [&](const Quantities& q) { return q.name == name; });
        if (found == rows.end()) {
            Quantities row;
            row.name = name;
            row.unit = unitName;
            row.ofDriver = ofDriver;
            row.value.assign(units_, nothing);
            row.standardError.assign(units_, nothing);
            found = rows.insert(rows.end(), std::move(row));
        }
        found->value[unit] = figure.value;
        found->standardError[unit] = figure.error;
    }

    std::vector<Quantities> rows;

private:
    std::size_t units_;
};

void putStroke(Table& table, std::size_t unit, const StrokeLimits& stroke)
{
    constexpr double inMm = 1e3;
    for (const auto& [word, name] :
         {std::pair {"force factor", "XBl 82%"}, std::pair {"compliance", "XC 75%"}, std::pair {"impedance", "XL 10%"}})
        for (const auto& limit : stroke.limits)
            if (limit.name.starts_with(word))
                table.put(unit, name, "mm", {inMm * limit.stroke().value_or(nothing), nothing});
    if (stroke.gapCentre)
        table.put(unit, "gap centre", "mm", {inMm * stroke.gapCentre->value, inMm * stroke.gapCentre->standardError});
    if (stroke.stiffnessAsymmetry)
        table.put(unit, "K asymmetry", "%",
                  {stroke.stiffnessAsymmetry->value, stroke.stiffnessAsymmetry->standardError});
}

void putErrors(Table& table, std::size_t unit, const Comparison& comparison)
{
    for (const auto& channel : comparison.channels) {
        table.put(unit, "error " + std::string(name(channel.quantity)), "dB", {channel.total.db, nothing}, false);
        if (comparison.noiseKnown)
            table.put(unit, "noise " + std::string(name(channel.quantity)), "dB",
                      {channel.total.noiseFloorDb.value_or(nothing), nothing}, false);
    }
    if (comparison.noiseKnown)
        table.put(unit, "chiSquaredPerValue", "", {comparison.chiSquaredPerValue, nothing}, false);
}

double distanceScale(const Quantities& q)
{
    const double error = medianOf(q.standardError);
    return std::max({q.spread, std::isfinite(error) ? error : 0.0, 1e-9 * std::abs(q.median)});
}

void count(Quantities& q)
{
    double sum = 0.0;
    for (const double v : q.value)
        if (std::isfinite(v)) {
            ++q.known;
            sum += v;
            q.least = std::isnan(q.least) ? v : std::min(q.least, v);
            q.most = std::isnan(q.most) ? v : std::max(q.most, v);
        }
    if (q.known == 0)
        return;
    const auto n = static_cast<double>(q.known);
    q.median = medianOf(q.value);
    q.spread = robustSpread(q.value);
    q.mean = sum / n;
    if (q.known >= 2) {
        double power = 0.0;
        for (const double v : q.value)
            if (std::isfinite(v))
                power += (v - q.mean) * (v - q.mean);
        q.deviation = std::sqrt(power / (n - 1.0));
    }
    const auto trend = trendOf(q.value);
    q.drift = trend.slope;
    q.driftError = trend.standardError;
}

bool within(const Limits& limits, double value)
{
    return std::isfinite(value) && (!limits.least || value >= *limits.least) && (!limits.most || value <= *limits.most);
}

void judge(Collection& all, Quantities& q)
{
    for (std::size_t k = 0; k < all.units.size(); ++k)
        if (all.units[k].measured) {
            if (within(q.limits, q.value[k]))
                ++q.within;
            else
                all.units[k].beyondLimits.push_back(q.name);
        }
    if (!(q.deviation > 0.0))
        return;
    double room = std::numeric_limits<double>::infinity();
    if (q.limits.least)
        room = std::min(room, q.mean - *q.limits.least);
    if (q.limits.most)
        room = std::min(room, *q.limits.most - q.mean);
    q.Cpk = room / (3.0 * q.deviation);
}

void findOutliers(Collection& all)
{
    for (const auto& q : all.quantities) {
        if (q.known < fewestForOutliers)
            continue;
        const double most = all.threshold * (1.0 + 10.0 / (static_cast<double>(q.known) - 3.5)) * distanceScale(q);
        for (std::size_t k = 0; k < all.units.size(); ++k)
            if (std::abs(q.value[k] - q.median) > most)
                all.units[k].outlying.push_back(q.name);
    }
}

/// Effects and verdicts of one unit beside those of the others.
void compareFindings(Collection& all)
{
    std::map<std::string, std::size_t> having, verdicts;
    std::size_t measured = 0;
    for (const auto& unit : all.units) {
        ++verdicts[unit.verdict];
        measured += unit.measured;
        for (const auto& effect : unit.effects)
            ++having[effect];
    }
    for (auto& unit : all.units) {
        if (all.units.size() >= fewestForOutliers)
            for (const auto& [verdict, times] : verdicts)
                unit.otherVerdict = unit.otherVerdict || (2 * times > all.units.size() && verdict != unit.verdict);
        if (!unit.measured || measured < fewestForOutliers)
            continue;
        for (const auto& [effect, times] : having) {
            const bool has = std::find(unit.effects.begin(), unit.effects.end(), effect) != unit.effects.end();
            const auto others = times - (has ? 1 : 0), count = measured - 1;
            if (has && 2 * others < count)
                unit.additional.push_back(effect);
            if (!has && 2 * others > count)
                unit.absent.push_back(effect);
        }
    }
}

void findGolden(Collection& all)
{
    if (all.measured < fewestForGolden)
        return;
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < all.units.size(); ++k) {
        double sum = 0.0;
        int known = 0, possible = 0;
        for (const auto& q : all.quantities) {
            if (!q.ofDriver || q.known < fewestForGolden || !(distanceScale(q) > 0.0))
                continue;
            ++possible;
            if (std::isfinite(q.value[k])) {
                ++known;
                sum += std::pow((q.value[k] - q.median) / distanceScale(q), 2);
            }
        }
        constexpr double enough = 0.8;
        if (known == 0 || known < enough * possible)
            continue;
        all.units[k].distance = std::sqrt(sum / known);
        if (all.units[k].distance < nearest) {
            nearest = all.units[k].distance;
            all.golden = k;
        }
    }
}

void putLimits(Collection& all, const std::map<std::string, Limits>& limits)
{
    for (const auto& [name, limit] : limits) {
        const auto found = std::find_if(all.quantities.begin(), all.quantities.end(),
                                        [&name = name](const Quantities& q) { return q.name == name; });
        if (found == all.quantities.end()) {
            const auto known = joined(all.quantities, [&](const auto& q) { return q.name; });
            throw Error(Error::Kind::usage,
                        "There is a limit for \"" + name + "\", which no unit has; the quantities are " + known + ".");
        }
        found->limits = limit;
    }
    all.limited = !limits.empty();
    for (auto& q : all.quantities)
        if (q.limited())
            judge(all, q);
    for (const auto& unit : all.units)
        all.passed += all.limited && unit.measured && unit.beyondLimits.empty();
}

UnitResult resultOf(const Unit& unit)
{
    const auto& ladder = unit.file.ladder;
    UnitResult result;
    result.name = unit.name;
    result.verdict = name(ladder.verdict);
    result.sentence = ladder.sentence;
    result.measured = unit.measured();
    if (!result.measured)
        return result;
    result.effects = ladder.model().effectIds();
    std::sort(result.effects.begin(), result.effects.end());
    if (ladder.verdict != Verdict::complete)
        result.remainder = inWords(ladder.rungs.back().diagnosis.remainder);
    return result;
}

}  // namespace

std::vector<std::string> UnitResult::standsOutBy() const
{
    auto words = outlying;
    for (const auto& effect : additional)
        words.push_back("has " + effect);
    for (const auto& effect : absent)
        words.push_back("lacks " + effect);
    if (otherVerdict)
        words.emplace_back("its verdict");
    return words;
}

bool Quantities::drifts() const
{
    // About Student's t of as many degrees of freedom where a normal value has four deviations.
    const double most = known < fewestForOutliers ? std::numeric_limits<double>::infinity()
                                                  : 4.0 * (1.0 + 8.0 / (static_cast<double>(known) - 3.5));
    return std::abs(drift) > most * driftError;
}

const Quantities* Collection::find(const std::string& name) const
{
    const auto found = std::find_if(quantities.begin(), quantities.end(),
                                    [&](const Quantities& q) { return q.name == name; });
    return found == quantities.end() ? nullptr : &*found;
}

Collection collect(const Units& units, const CollectOptions& options)
{
    if (!(options.threshold > 0.0 && std::isfinite(options.threshold)))
        throw Error(Error::Kind::usage, "The threshold of outliers must be a positive number.");
    for (const double place : options.places)
        if (!(place > 0.0 && std::isfinite(place)))
            throw Error(Error::Kind::usage, "The places of laws must be positive numbers in m; both sides are told.");
    Collection all;
    all.unread = units.unread;
    all.threshold = options.threshold;
    Table table(units.units.size());
    std::vector<std::optional<ScaledModel>> models;
    for (std::size_t k = 0; k < units.units.size(); ++k) {
        all.units.push_back(resultOf(units.units[k]));
        models.emplace_back();
        if (!units.units[k].measured())
            continue;
        ++all.measured;
        models[k] = withKnown(units.units[k].file.ladder.model(), {});
        for (const auto& figure : thieleSmall(*models[k]))
            table.put(k, figure.symbol, figure.sheetUnit,
                      {figure.value * figure.perUnit, figure.standardError * figure.perUnit});
        gather(all.laws, k, lawTables(*models[k], 201));
    }
    auto places = options.places;
    std::sort(places.begin(), places.end());
    for (const auto& laws : all.laws)
        for (const auto& figure : figuresOf(laws, places))
            table.put(figure.ofUnit, figure.name, figure.unit, {figure.value, figure.standardError});
    for (std::size_t k = 0; k < models.size(); ++k)
        if (models[k] && !models[k]->motionIsGuessed)
            putStroke(table, k, strokeLimits(models[k]->model));
    for (std::size_t k = 0; k < models.size(); ++k)
        if (models[k])
            putErrors(table, k, units.units[k].file.ladder.rungs.back().comparison);
    all.quantities = std::move(table.rows);
    for (auto& q : all.quantities)
        count(q);
    std::erase_if(all.quantities,
                  [&](const Quantities& q) { return q.known == 0 && !options.limits.contains(q.name); });
    putLimits(all, options.limits);
    findOutliers(all);
    compareFindings(all);
    findGolden(all);
    return all;
}

}  // namespace excursion
