// SPDX-License-Identifier: GPL-3.0-or-later
#include "Report/ModelReport.h"

#include "Engine/Document/DocumentFormat.h"
#include "Engine/Document/DraftFile.h"
#include "Engine/Document/Engineering.h"
#include "Engine/Fractional/FractionalIdentificationFile.h"
#include "Engine/GreyBox/MotorConeFile.h"
#include "Engine/Linear/IdentificationFile.h"
#include "Engine/Ranking/PolynomialFitFile.h"
#include "Engine/Ranking/RankingFile.h"
#include "Engine/Signal/Level.h"
#include "Plots/HarmonicPlots.h"
#include "Plots/ModelPlots.h"
#include "Plots/VolterraPlots.h"
#include "Report/ClassesReport.h"
#include "Report/Page.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>
#include <optional>
#include <tuple>

namespace excursion {
namespace {

void addRoots(Page& page, const StateSpace& model, double alpha)
{
    page.section("The model");
    page.figures({rootsPlot(model, alpha), gainSurfacePlot(model, alpha)}, 2,
                 "Left: a pole or zero by its frequency and its angle from the positive real axis; poles above the "
                 "border decay. Right: the gain along rays in the "
                 "plane of s; the one at 90\u00b0 is the frequency response, and the closer a pole is to a ray the "
                 "more it stands out on it.");
}

void addStateSpace(Page& page, const JsonField& document)
{
    const auto named = stateSpaceFromJson(document);
    page.headline(named.name + ": " + std::to_string(named.model.order()) + " states, "
                      + (isStable(named.model) ? "stable" : "not stable"),
                  isStable(named.model) ? "good" : "bad");
    addRoots(page, named.model, 1.0);
}

void addFractionalStateSpace(Page& page, const JsonField& document)
{
    const auto named = fractionalStateSpaceFromJson(document);
    const bool stable = isStable(named.model);
    page.headline(named.name + ": " + std::to_string(named.model.form.order()) + " states of order "
                      + fixedText(named.model.alpha, 4) + ", " + (stable ? "stable" : "not stable"),
                  stable ? "good" : "bad");
    addRoots(page, named.model.form, named.model.alpha);
}

/// One order of an identification, of whole or fractional order.
struct TriedOrder {
    int order = 0;
    double errorDb = 0.0, weightedDb = 0.0;
    std::optional<double> validationDb;
    bool stable = false;
    std::vector<AlphaChiSquared> curve;
};

Plot curvePlot(const TriedOrder& tried)
{
    Plot plot;
    plot.title = "\u03c7\u00b2 against \u03b1, order " + std::to_string(tried.order);
    plot.x = {"\u03b1", "", false, 0.0, 0.0, {}};
    plot.y = {"\u03c7\u00b2 over its least", "", true, 0.0, 0.0, {}};
    Series series {"\u03c7\u00b2", Role::model, {}, {}, {}, {}, Series::Shape::pointsAndLine, 0};
    double least = std::numeric_limits<double>::infinity();
    for (const auto& point : tried.curve)
        least = std::min(least, point.chiSquared);
    for (const auto& point : tried.curve) {
        series.x.push_back(point.alpha);
        series.y.push_back(point.chiSquared / least);
    }
    plot.series.push_back(std::move(series));
    return plot;
}

void addSweep(Page& page, const std::vector<TriedOrder>& orders, int chosen, const std::string& sentence)
{
    ErrorsByOrder errors;
    std::vector<std::vector<Page::Cell>> rows;
    std::vector<Plot> plots;
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    for (const auto& tried : orders) {
        errors.order.push_back(tried.order);
        errors.error.push_back(tried.errorDb);
        errors.weighted.push_back(tried.weightedDb);
        errors.validation.push_back(tried.validationDb.value_or(unknown));
        rows.push_back({Page::figure(std::to_string(tried.order)), Page::figure(decibelsCell(tried.errorDb)),
                        Page::figure(decibelsCell(tried.weightedDb)),
                        Page::figure(decibelsCell(tried.validationDb.value_or(unknown))), tried.stable ? "yes" : "no"});
        if (tried.curve.size() > 1)
            plots.push_back(curvePlot(tried));
    }
    page.headline("Order " + std::to_string(chosen), "good");
    if (!sentence.empty())
        page.paragraph(sentence);
    if (errors.order.size() > 1)
        plots.insert(plots.begin(), orderPlot(errors));
    page.section("The error against the order");
    page.table({"order", "error dB", "weighted dB", "validation dB", "stable"}, rows);
    if (!plots.empty())
        page.figures(plots, plots.size() == 1 ? 1 : 2,
                     "Errors are relative; the weighted one counts each line by what its noise allows.");
}

void addIdentification(Page& page, const JsonField& document)
{
    const auto identified = identificationFromJson(document);
    const auto& entries = identified.sweep.entries;
    std::vector<TriedOrder> orders;
    for (const auto& e : entries)
        orders.push_back({e.order, e.found.errorDb, decibelsOf(e.found.cost), e.validationDb, e.found.stable, {}});
    addSweep(page, orders, entries[identified.sweep.chosen].order, identified.sweep.sentence);
    addRoots(page, identified.model.model, 1.0);
}

void addFractionalIdentification(Page& page, const JsonField& document)
{
    const auto identified = fractionalIdentificationFromJson(document);
    const auto& entries = identified.sweep.entries;
    std::vector<TriedOrder> orders;
    for (const auto& e : entries)
        orders.push_back(
            {e.order, e.found.errorDb, decibelsOf(e.found.cost), std::nullopt, e.found.stable, e.found.curve});
    addSweep(page, orders, entries[identified.sweep.chosen].order, identified.sweep.sentence);
    addRoots(page, identified.model.model.form, identified.model.model.alpha);
}

void addMotorCone(Page& page, const JsonField& document)
{
    const auto found = motorConeFromJson(document);
    page.headline("Motor and cone: together " + decibelsCell(found.errorDb) + " dB from the pressure"
                      + (found.stable ? "" : "; not both stable"),
                  found.stable ? "good" : "bad");
    page.paragraph(found.sentence);
    std::vector<std::vector<Page::Cell>> rows;
    std::vector<Plot> plots;
    for (const auto& [half, title, error] :
         {std::tuple {&found.motor, "Motor", found.motorErrorDb}, {&found.cone, "Cone", found.coneErrorDb}}) {
        rows.push_back({title, half->inputs.front(), half->outputs.front(),
                        Page::figure(std::to_string(half->model.order())), Page::figure(decibelsCell(error))});
        if (half->model.order() == 0)
            continue;
        // Of the motor the displacement: its other outputs are derivatives of that.
        auto first = half->model;
        first.C = half->model.C.topRows(1).eval();
        first.D = half->model.D.topRows(1).eval();
        plots.push_back(rootsPlot(first, 1.0));
        plots.back().title = title + std::string(": ") + plots.back().title;
    }
    page.section("The halves");
    page.table({"", "from", "to", "order", "error dB"}, rows);
    if (!plots.empty())
        page.figures(
            plots, static_cast<int>(plots.size()),
            "A pole or zero by its frequency and its angle from the positive real axis; poles above the border decay.");
}

void addPnlssFit(Page& page, const JsonField& document)
{
    const auto fit = polynomialFitFromJson(document);
    const bool validated = std::isfinite(fit.validationDb);
    page.headline("Polynomial state space: " + decibelsCell(fit.estimationDb) + " dB on what it was fitted to"
                      + (validated ? ", " + decibelsCell(fit.validationDb) + " dB on what it had not seen" : "")
                      + (fit.stable ? "" : "; its linear part is not stable")
                      + (fit.arrived ? (*fit.arrived ? "" : "; the fit did not arrive at the noise")
                                     : "; it is not known whether that is the noise"),
                  !fit.stable                   ? "bad"
                  : fit.arrived.value_or(false) ? "good"
                                                : "warn");
    if (!fit.advice.empty())
        page.paragraph(fit.advice);
    if (fit.laws)
        page.paragraph(fit.laws->sentence);
    if (fit.history.size() > 1) {
        Plot fall;
        fall.title = "How the error fell";
        fall.x = {"step", "", false, 0.0, 0.0, {}};
        fall.y = {"error", "dB", false, 0.0, 0.0, {}};
        Series series {"", Role::error, {}, fit.history, {}, {}, Series::Shape::pointsAndLine, 0};
        for (std::size_t k = 0; k < series.y.size(); ++k)
            series.x.push_back(static_cast<double>(k));
        fall.series.push_back(std::move(series));
        fall.key = false;
        page.section("The fit");
        page.figures({fall}, 1,
                     "On the records that it was fitted to, after each step that was taken; it stopped because "
                         + fit.stopped + ".");
    }
    if (const auto model = document.at("model"); model.at("format").text() == "excursion-pnlss")
        addRoots(page, stateSpaceFromJson(model.at("linear")).model, 1.0);
}

void addRanking(Page& page, const JsonField& document) { addRankingOfClasses(page, rankingFromJson(document)); }

void addHarmonicCurves(Page& page, const JsonField& document)
{
    double most = -std::numeric_limits<double>::infinity(), mostAt = 0.0;
    std::string mostOf;
    std::vector<std::pair<std::string, std::vector<Plot>>> channels;
    for (const auto& curve : document.at("curves").items()) {
        const auto channel = curve.at("channel").text();
        const auto frequency = curve.at("frequency").numbers();
        const auto sized = [&](const JsonField& field) {
            auto values = field.numbers();
            if (values.size() != frequency.size())
                field.refuse("a number for each frequency");
            return values;
        };
        std::vector<HarmonicLine> harmonics;
        for (const auto& harmonic : curve.at("harmonics").items())
            harmonics.push_back({harmonic.at("order").count(2, 100), sized(harmonic.at("db"))});
        const auto thd = sized(curve.at("thd").at("db")), floor = sized(curve.at("thd").at("floorDb"));
        for (std::size_t i = 0; i < thd.size(); ++i)
            if (thd[i] > most) {
                most = thd[i];
                mostAt = frequency[i];
                mostOf = channel;
            }
        if (channels.empty() || channels.back().first != channel)
            channels.push_back({channel, {}});
        const auto level = nominal(curve.at("level").number(), "V") + " rms";
        auto plot = harmonicPlot(level, frequency, harmonics, thd, floor);
        plot.facets = {{"level", level}};
        if (!plot.series.empty())
            channels.back().second.push_back(std::move(plot));
    }
    if (std::isfinite(most))
        page.headline("At most " + fixedText(100.0 * std::pow(10.0, most / 20.0), 2) + " % of harmonics, in the "
                          + mostOf + " at " + fixedText(mostAt, 0) + " Hz",
                      "good");
    else
        page.headline("No harmonic rises above the noise", "good");
    for (const auto& remark : document.at("remarks").items())
        page.paragraph(remark.text());
    for (auto& [channel, plots] : channels) {
        page.section("Harmonics of the " + channel);
        if (plots.empty()) {
            page.paragraph("Nothing of it rises above the noise.");
            continue;
        }
        const int columns = plots.size() == 1 ? 1 : 2;
        page.figures(std::move(plots), columns,
                     "Level of each harmonic over that of the fundamental whose frequency is on the axis; a line ends "
                     "where the harmonic leaves the band or does not rise above what noise may look like. THD is the "
                     "root of the sum of squares of what does.");
    }
}

Eigen::VectorXd vectorIn(const JsonField& list)
{
    const auto numbers = list.numbers();
    return Eigen::Map<const Eigen::VectorXd>(numbers.data(), static_cast<Eigen::Index>(numbers.size()));
}

void addVolterraSeries(Page& page, const JsonField& document)
{
    const double rate = document.at("sampleRate").number();
    if (!(rate > 0.0))
        document.at("sampleRate").refuse("a sample rate above 0 Hz");
    const auto first = vectorIn(document.at("first"));
    const auto rows = static_cast<Eigen::Index>(document.at("second").items().size());
    const auto second = matrixFrom(document.at("second"), rows, rows);
    page.headline(document.at("name").text() + ": " + document.at("output").text() + " under "
                      + document.at("input").text() + ", kernels of " + std::to_string(first.size()) + ", "
                      + std::to_string(rows) + " and " + std::to_string(document.at("third").items().size())
                      + " samples",
                  "good");
    page.section("The kernels");
    std::vector<Plot> plots {firstKernelPlot(first, rate, "")};
    if (rows > 0)
        plots.push_back(secondKernelPlot(second, rate, ""));
    const int columns = static_cast<int>(plots.size());
    page.figures(std::move(plots), columns,
                 "The first kernel answers one impulse, by output unit over input unit. The second is a surface, drawn "
                 "along its diagonals: half of what an impulse, s after another, adds to both answers, by output unit "
                 "over the square of the input's.");
}

struct PageOf {
    const char* format;
    const char* title;
    void (*add)(Page&, const JsonField&);
};

constexpr PageOf pagesOf[] {
    {"excursion-state-space", "Linear model", addStateSpace},
    {"excursion-fractional-state-space", "Fractional model", addFractionalStateSpace},
    {"excursion-identification", "Identification", addIdentification},
    {"excursion-fractional-identification", "Fractional identification", addFractionalIdentification},
    {"excursion-motor-cone", "Motor and cone", addMotorCone},
    {"excursion-pnlss-fit", "Polynomial model", addPnlssFit},
    {"excursion-harmonics", "Harmonic distortion", addHarmonicCurves},
    {"excursion-volterra-series", "Volterra series", addVolterraSeries},
    {"excursion-ranking", "Classes of models", addRanking}};

}  // namespace

std::string documentHtml(const JsonField& document)
{
    std::vector<std::string> known;
    for (const auto& page : pagesOf)
        known.emplace_back(page.format);
    const auto format = document.at("format").oneOf(known);
    for (const auto& wanted : pagesOf)
        if (format == wanted.format) {
            DocumentFormat {format}.require(document);
            Page page(std::string("Excursion \u00b7 ") + wanted.title);
            wanted.add(page, document);
            return page.html();
        }
    document.at("format").refuse("a document that has a page");
}

void writeDocumentPage(const JsonField& document, const std::filesystem::path& path)
{
    publish(path, documentHtml(document));
}

}  // namespace excursion
