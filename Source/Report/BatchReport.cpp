// SPDX-License-Identifier: GPL-3.0-or-later
#include "Report/BatchReport.h"

#include "Engine/Document/DraftFile.h"
#include "Engine/Document/Engineering.h"
#include "Engine/Document/Words.h"
#include "Plots/BatchPlots.h"
#include "Plots/Words.h"
#include "Report/Page.h"
#include "Report/Chapters.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

constexpr auto dash = "\u2013";

std::string effectTitles(const std::vector<std::string>& ids)
{
    return joined(ids, [](const auto& id) { return effectTitle(id); });
}

/// With decimals down to a hundredth of the spread within the batch.
std::string numberOf(const Quantities& q, double value)
{
    if (!std::isfinite(value))
        return dash;
    const double size = std::max(q.spread, 1e-4 * std::abs(q.median));
    if (!(size > 0.0))  // all are zero
        return fixedText(value, value == 0.0 ? 0 : 8);
    return fixedText(value, std::clamp(static_cast<int>(std::ceil(1.0 - std::log10(size))), 0, 8));
}

std::string titleOfQuantity(const Quantities& q) { return q.name + (q.unit.empty() ? "" : " in " + q.unit); }

void addHeadline(Page& page, const Collection& all)
{
    const auto count = all.units.size();
    const auto of = [](std::size_t n, std::size_t all) { return std::to_string(n) + " of " + std::to_string(all); };
    const auto outliers = static_cast<std::size_t>(
        std::count_if(all.units.begin(), all.units.end(), [](const UnitResult& u) { return u.outlier(); }));
    if (all.limited)
        page.headline(of(all.passed, all.measured) + " measured units are within all limits ("
                          + fixedText(all.measured > 0
                                          ? 100.0 * static_cast<double>(all.passed) / static_cast<double>(all.measured)
                                          : 0.0,
                                      1)
                          + " %)",
                      all.passed == count ? "good"
                      : all.passed > 0    ? "warn"
                                          : "bad");
    else
        page.headline(of(all.measured, count) + (count == 1 ? " unit is measured" : " units are measured")
                          + (outliers > 0
                                 ? ", " + std::to_string(outliers) + (outliers == 1 ? " stands out" : " stand out")
                                 : ""),
                      all.measured == count && outliers == 0 ? "good" : "warn");
    std::vector<std::pair<std::string, std::string>> facts {{"units", std::to_string(count)},
                                                            {"measured", std::to_string(all.measured)},
                                                            {"outliers", std::to_string(outliers)}};
    if (all.golden)
        facts.emplace_back("golden unit", all.units[*all.golden].name);
    std::map<std::string, std::size_t> verdicts;
    for (const auto& unit : all.units)
        ++verdicts[unit.verdict];
    for (const auto& [verdict, times] : verdicts)
        facts.emplace_back(verdict, std::to_string(times));
    page.facts(facts);
    for (const auto& unread : all.unread)
        page.paragraph("Not in the table: " + unread.name + ": " + unread.why);
}

void addUnits(Page& page, const Collection& all)
{
    page.section("Units");
    std::vector<std::string> header {"Unit", "Verdict", "Effects found"};
    if (all.limited)
        header.emplace_back("Beyond limits");
    header.emplace_back("Stands out by");
    header.emplace_back("Distance");
    std::vector<std::vector<Page::Cell>> rows;
    for (std::size_t k = 0; k < all.units.size(); ++k) {
        const auto& unit = all.units[k];
        std::vector<Page::Cell> row {unit.name + (all.golden == k ? " (golden)" : ""), unit.verdict,
                                     effectTitles(unit.effects)};
        if (all.limited)
            row.emplace_back(!unit.measured              ? "not measured"
                             : unit.beyondLimits.empty() ? "none"
                                                         : joined(unit.beyondLimits));
        auto out = unit.outlying;
        if (!unit.additional.empty())
            out.push_back("has " + effectTitles(unit.additional));
        if (!unit.absent.empty())
            out.push_back("lacks " + effectTitles(unit.absent));
        if (unit.otherVerdict)
            out.emplace_back("its verdict");
        row.emplace_back(joined(out));
        row.push_back(Page::figure(std::isfinite(unit.distance) ? fixedText(unit.distance, 2) : dash));
        rows.push_back(std::move(row));
    }
    page.table(header, rows);
    page.note("Distance: rms over the quantities of the loudspeaker of how far the unit is from the median, in units "
              "of the spread; the golden unit is the nearest.");
}

void addOutliers(Page& page, const Collection& all)
{
    if (std::none_of(all.units.begin(), all.units.end(), [](const UnitResult& u) { return u.outlier(); }))
        return;
    page.section("What stands out");
    for (std::size_t k = 0; k < all.units.size(); ++k) {
        const auto& unit = all.units[k];
        if (!unit.outlier())
            continue;
        page.subsection(unit.name);
        std::string text;
        for (const auto& name : unit.outlying) {
            const auto& q = *all.find(name);
            text += (text.empty() ? "" : "; ") + name + " is " + numberOf(q, q.value[k])
                    + (q.unit.empty() ? "" : " " + q.unit) + " where the batch has " + numberOf(q, q.median)
                    + " \u00b1 " + numberOf(q, q.spread);
        }
        if (!text.empty())
            page.paragraph(text + ".");
        if (!unit.additional.empty())
            page.paragraph("It has what most others do not have: " + effectTitles(unit.additional) + ".");
        if (!unit.absent.empty())
            page.paragraph("It has not what most others have: " + effectTitles(unit.absent) + ".");
        if (unit.otherVerdict || unit.outlying.empty())
            page.paragraph("Its ladder ends: " + unit.sentence);
        if (!unit.remainder.empty())
            page.paragraph("What its model leaves: " + unit.remainder + ".");
    }
    page.note("A value stands out where it is farther from the median than " + fixedText(all.threshold, 1)
              + " (1 + 10/(n \u2212 3.5)) times the spread, 1.4826 times the median distance from the median; fewer "
                "than five units tell no outlier.");
}

void addQuantities(Page& page, const Collection& all)
{
    page.section("Quantities");
    std::vector<std::string> header {"Quantity", "Units", "Median", "Spread", "Least", "Most"};
    if (all.limited)
        for (const char* title : {"Limits", "Within", "Cpk"})
            header.emplace_back(title);
    header.emplace_back("Drift per unit");
    std::vector<std::vector<Page::Cell>> rows;
    for (const auto& q : all.quantities) {
        std::vector<Page::Cell> row {titleOfQuantity(q),
                                     Page::figure(std::to_string(q.known)),
                                     Page::figure(numberOf(q, q.median)),
                                     Page::figure(numberOf(q, q.spread)),
                                     Page::figure(numberOf(q, q.least)),
                                     Page::figure(numberOf(q, q.most))};
        if (all.limited) {
            const auto end = [](const std::optional<double>& v) { return v ? nominal(*v, "1") : std::string(); };
            row.push_back(Page::figure(q.limited() ? end(q.limits.least) + " .. " + end(q.limits.most) : ""));
            row.push_back(
                Page::figure(q.limited() ? std::to_string(q.within) + " of " + std::to_string(all.measured) : ""));
            row.push_back(Page::figure(q.Cpk ? fixedText(*q.Cpk, 2) : q.limited() ? dash : ""));
        }
        row.push_back(Page::figure(
            std::isfinite(q.drift) ? withError(q.drift, q.driftError, "1") + (q.drifts() ? " *" : "") : dash));
        rows.push_back(std::move(row));
    }
    page.table(header, rows);
    page.note(std::string("Spread: 1.4826 times the median distance from the median. Drift: slope over the order of "
                          "the batch and its standard error; a star where it exceeds 4 (1 + 8/(n \u2212 3.5)) of them.")
              + (all.limited ? " Cpk: the nearer limit's distance from the mean over three standard deviations." : ""));
}

void addPictures(Page& page, const Collection& all)
{
    std::vector<Plot> plots;
    constexpr std::size_t most = 18;
    for (const auto& q : all.quantities) {
        const bool off = std::any_of(all.units.begin(), all.units.end(), [&](const UnitResult& u) {
            return std::find(u.outlying.begin(), u.outlying.end(), q.name) != u.outlying.end();
        });
        const bool always = q.name == "fs" || q.name == "Qts" || q.name == "Re" || q.name == "Bl";
        if (q.known >= 2 && plots.size() < most && (always || off || q.limited() || q.drifts()))
            plots.push_back(quantityPlot(all, q));
    }
    if (!plots.empty()) {
        page.section("Over the batch");
        page.figures(std::move(plots),
                     "Units in the order of the batch; the shade is the 95 % of each value's standard error. Drawn is "
                     "what has limits, drifts or stands out.");
    }
    plots.clear();
    for (const auto& laws : all.laws)
        plots.push_back(lawsPlot(all, laws));
    if (plots.empty())
        return;
    page.section("Laws of all units");
    page.figures(std::move(plots), "Each law over what its unit visited.");
}

void addValues(Page& page, const Collection& all)
{
    page.section("All values");
    std::vector<std::string> header {"Unit"};
    for (const auto& q : all.quantities)
        header.push_back(titleOfQuantity(q));
    std::vector<std::vector<Page::Cell>> rows;
    for (std::size_t k = 0; k < all.units.size(); ++k) {
        std::vector<Page::Cell> row {all.units[k].name};
        for (const auto& q : all.quantities)
            row.push_back(Page::figure(numberOf(q, q.value[k])));
        rows.push_back(std::move(row));
    }
    page.table(header, rows);
}

}  // namespace

std::string batchHtml(const Collection& all)
{
    Page page("Excursion \u00b7 Batch");
    addHeadline(page, all);
    addUnits(page, all);
    addOutliers(page, all);
    addQuantities(page, all);
    addPictures(page, all);
    addValues(page, all);
    return page.html();
}

void writeBatchReport(const Collection& all, const std::filesystem::path& path) { publish(path, batchHtml(all)); }

}  // namespace excursion
