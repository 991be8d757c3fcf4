// SPDX-License-Identifier: GPL-3.0-or-later
#include "Report/ModelReport.h"

#include "Engine/Document/DraftFile.h"
#include "Engine/Document/Engineering.h"
#include "Engine/Fractional/FractionalStateSpaceFile.h"
#include "Plots/HarmonicPlots.h"
#include "Plots/ModelPlots.h"
#include "Plots/VolterraPlots.h"
#include "Report/ClassesReport.h"
#include "Report/Page.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>

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

/// The sweep of an identification, of whole or fractional orders.
void addSweep(Page& page, const JsonField& document)
{
    ErrorsByOrder errors;
    std::vector<std::vector<Page::Cell>> rows;
    std::vector<Plot> plots;
    for (const auto& entry : document.at("orders").items()) {
        errors.order.push_back(entry.at("order").number());
        errors.error.push_back(entry.at("errorDb").numberOrNaN());
        errors.weighted.push_back(entry.at("weightedErrorDb").numberOrNaN());
        errors.validation.push_back(entry.has("validationDb") ? entry.at("validationDb").number()
                                                              : std::numeric_limits<double>::quiet_NaN());
        rows.push_back({Page::figure(fixedText(errors.order.back(), 0)), Page::figure(decibelsIn(entry, "errorDb")),
                        Page::figure(decibelsIn(entry, "weightedErrorDb")),
                        Page::figure(decibelsIn(entry, "validationDb")), entry.at("stable").flag() ? "yes" : "no"});
        if (!entry.has("curve") || entry.at("curve").items().size() < 2)
            continue;
        Plot curve;
        curve.title = "\u03c7\u00b2 against \u03b1, order " + fixedText(errors.order.back(), 0);
        curve.x = {"\u03b1", "", false, 0.0, 0.0, {}};
        curve.y = {"\u03c7\u00b2 over its least", "", true, 0.0, 0.0, {}};
        Series series {"\u03c7\u00b2", Role::model, {}, {}, {}, {}, Series::Shape::pointsAndLine, 0};
        double least = std::numeric_limits<double>::infinity();
        for (const auto& point : entry.at("curve").items()) {
            const auto pair = point.numbers();
            if (pair.size() != 2)
                point.refuse("alpha and chi squared");
            series.x.push_back(pair[0]);
            series.y.push_back(pair[1]);
            least = std::min(least, pair[1]);
        }
        for (auto& value : series.y)
            value /= least;
        curve.series.push_back(std::move(series));
        plots.push_back(std::move(curve));
    }
    page.headline("Order " + fixedText(document.at("chosen").number(), 0), "good");
    if (!document.at("sentence").text().empty())
        page.paragraph(document.at("sentence").text());
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
    addSweep(page, document);
    addRoots(page, stateSpaceFromJson(document.at("model")).model, 1.0);
}

void addFractionalIdentification(Page& page, const JsonField& document)
{
    addSweep(page, document);
    const auto named = fractionalStateSpaceFromJson(document.at("model"));
    addRoots(page, named.model.form, named.model.alpha);
}

void addMotorCone(Page& page, const JsonField& document)
{
    const bool stable = document.at("stable").flag();
    page.headline("Motor and cone: together " + decibelsIn(document, "errorDb") + " dB from the pressure"
                      + (stable ? "" : "; not both stable"),
                  stable ? "good" : "bad");
    page.paragraph(document.at("sentence").text());
    std::vector<std::vector<Page::Cell>> rows;
    std::vector<Plot> plots;
    for (const auto& [key, title, error] :
         {std::tuple {"motor", "Motor", "motorErrorDb"}, {"cone", "Cone", "coneErrorDb"}}) {
        const auto named = stateSpaceFromJson(document.at(key));
        rows.push_back({title, named.inputs.front(), named.outputs.front(),
                        Page::figure(std::to_string(named.model.order())), Page::figure(decibelsIn(document, error))});
        if (named.model.order() == 0)
            continue;
        // Of the motor the displacement: its other outputs are derivatives of that.
        auto first = named.model;
        first.C = named.model.C.topRows(1).eval();
        first.D = named.model.D.topRows(1).eval();
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
    const bool stable = document.at("stable").flag();
    const bool validated = document.has("validationDb") && std::isfinite(document.at("validationDb").numberOrNaN());
    page.headline("Polynomial state space: " + decibelsIn(document, "estimationDb") + " dB on what it was fitted to"
                      + (validated ? ", " + decibelsIn(document, "validationDb") + " dB on what it had not seen" : "")
                      + (stable ? "" : "; its linear part is not stable"),
                  stable ? "good" : "bad");
    if (document.has("laws"))
        page.paragraph(document.at("laws").at("sentence").text());
    Plot fall;
    fall.title = "How the error fell";
    fall.x = {"step", "", false, 0.0, 0.0, {}};
    fall.y = {"error", "dB", false, 0.0, 0.0, {}};
    Series series {"", Role::error, {}, document.at("history").numbers(), {}, {}, Series::Shape::pointsAndLine, 0};
    for (std::size_t k = 0; k < series.y.size(); ++k)
        series.x.push_back(static_cast<double>(k));
    fall.series.push_back(std::move(series));
    fall.key = false;
    if (document.at("history").items().size() > 1) {
        page.section("The fit");
        page.figures({fall}, 1,
                     "On the records that it was fitted to, after each step that was taken; it stopped because "
                         + document.at("stopped").text() + ".");
    }
    if (document.at("model").at("format").text() == "excursion-pnlss")
        addRoots(page, stateSpaceFromJson(document.at("model").at("linear")).model, 1.0);
}

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
    {"excursion-ranking", "Classes of models", addRankingOfClasses}};

}  // namespace

std::string documentHtml(const JsonField& document)
{
    std::vector<std::string> known;
    for (const auto& page : pagesOf)
        known.emplace_back(page.format);
    const auto format = document.at("format").oneOf(known);
    for (const auto& wanted : pagesOf)
        if (format == wanted.format) {
            document.requireFormat(format, 1);
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
