// SPDX-License-Identifier: GPL-3.0-or-later
#include "Report/ClassesReport.h"

#include "Engine/Document/Engineering.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace excursion {
namespace {

/// What it is worth to invert the classes; nothing where the document does not say.
void addLinearizations(Page& page, const JsonField& document)
{
    if (!document.has("linearizationSentence"))
        return;
    page.section("Turned around");
    page.paragraph(document.at("linearizationSentence").text());
    std::vector<std::pair<double, std::vector<Page::Cell>>> rows;
    std::vector<std::string> troubles;
    for (const auto& model : document.at("models").items()) {
        if (!model.has("linearization"))
            continue;
        const auto told = model.at("linearization");
        const auto name = model.at("class").text();
        if (told.has("trouble")) {
            troubles.push_back(name + ": " + told.at("trouble").text());
            continue;
        }
        rows.push_back({told.at("leftDb").number(),
                        {name, Page::figure(decibelsIn(told, "beforeDb")), Page::figure(decibelsIn(told, "modelDb")),
                         Page::figure(decibelsIn(told, "leftDb")),
                         Page::figure(fixedText(100.0 * told.at("load").number(), 2) + " %"),
                         Page::figure(fixedText(1e3 * told.at("latency").number(), 1) + " ms")}});
    }
    std::stable_sort(rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<std::vector<Page::Cell>> cells;
    for (auto& row : rows)
        cells.push_back(std::move(row.second));
    if (!cells.empty())
        page.table({"class", "distortion dB", "left on the model dB", "left on the take dB", "load", "latency"}, cells);
    for (const auto& trouble : troubles)
        page.note(trouble);
    page.note("Distortion: what is not the linear part's output, over that, under the stimulus of the fit. On the take "
              "what the model does not explain is left as well. The load is the share of a core that one channel "
              "takes.");
}

}  // namespace

std::string decibelsIn(const JsonField& object, const char* key)
{
    const double value = object.has(key) ? object.at(key).numberOrNaN() : std::numeric_limits<double>::quiet_NaN();
    return std::isfinite(value) ? fixedText(value, 1) : "\u2013";
}

void addRankingOfClasses(Page& page, const JsonField& document)
{
    page.headline(document.at("sentence").text(), "good");
    page.paragraph(document.at("output").text() + " explained by " + document.at("input").text()
                   + (document.has("noiseDb") ? "; noise at " + decibelsIn(document, "noiseDb") + " dB" : ""));
    Plot plot;
    plot.title = "Error on records not seen against parameters";
    plot.x = {"parameters", "", true, 0.0, 0.0, {}};
    plot.y = {"error", "dB", false, 0.0, 0.0, {}};
    Series classes {"a class", Role::error, {}, {}, {}, {}, Series::Shape::pointsAndLine, 0};
    double fewest = std::numeric_limits<double>::infinity(), most = 0.0;
    std::vector<std::vector<Page::Cell>> rows;
    std::vector<std::string> troubles;
    for (const auto& model : document.at("models").items()) {
        const auto name = model.at("class").text();
        if (model.has("trouble")) {
            troubles.push_back(name + ": " + model.at("trouble").text());
            continue;
        }
        const double judged = model.has("validationDb") ? model.at("validationDb").number()
                                                        : model.at("estimationDb").numberOrNaN();
        const double parameters = model.at("parameters").number();
        classes.x.insert(classes.x.end(), {parameters, std::numeric_limits<double>::quiet_NaN()});
        classes.y.insert(classes.y.end(), {judged, std::numeric_limits<double>::quiet_NaN()});
        classes.names.insert(classes.names.end(), {name, ""});
        fewest = std::min(fewest, parameters);
        most = std::max(most, parameters);
        rows.push_back({name, Page::figure(fixedText(parameters, 0)), Page::figure(decibelsIn(model, "estimationDb")),
                        Page::figure(decibelsIn(model, "validationDb")),
                        Page::figure(fixedText(100.0 * model.at("load").number(), 2) + " %"),
                        model.at("stable").flag() ? "yes" : "no", model.at("description").text()});
    }
    plot.series.push_back(std::move(classes));
    if (document.has("noiseDb") && !rows.empty()) {
        const double noise = document.at("noiseDb").number();
        plot.series.push_back({"noise", Role::noise, {fewest, most}, {noise, noise}, {}, {}, Series::Shape::line, 0});
    }
    page.section("Side by side");
    page.table({"class", "parameters", "estimation dB", "validation dB", "load", "stable", "what it is"}, rows);
    for (const auto& trouble : troubles)
        page.note(trouble);
    if (!rows.empty())
        page.figures({plot}, 1,
                     "Errors are those of simulations, relative to the output. The load is the time that one core "
                     "simulates for.");
    addLinearizations(page, document);
}

}  // namespace excursion
