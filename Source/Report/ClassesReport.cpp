// SPDX-License-Identifier: GPL-3.0-or-later
#include "Report/ClassesReport.h"

#include "Engine/Document/Engineering.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace excursion {
namespace {

/// What it is worth to invert the classes; nothing where the ranking does not say.
void addLinearizations(Page& page, const Ranking& ranking)
{
    if (ranking.straightSentence.empty())
        return;
    page.section("Turned around");
    page.paragraph(ranking.straightSentence);
    std::vector<const RankedModel*> inverted;
    std::vector<std::string> troubles;
    for (const auto& model : ranking.models) {
        if (!model.trouble.empty())
            continue;
        if (model.predistortion.trouble.empty())
            inverted.push_back(&model);
        else
            troubles.push_back(model.name + ": " + model.predistortion.trouble);
    }
    std::stable_sort(inverted.begin(), inverted.end(),
                     [](const auto* a, const auto* b) { return a->predistortion.leftDb < b->predistortion.leftDb; });
    std::vector<std::vector<Page::Cell>> cells;
    for (const auto* model : inverted) {
        const auto& told = model->predistortion;
        cells.push_back({model->name, Page::figure(decibelsCell(told.beforeDb)),
                         Page::figure(decibelsCell(told.modelDb)), Page::figure(decibelsCell(told.leftDb)),
                         Page::figure(fixedText(100.0 * told.load, 2) + " %"),
                         Page::figure(fixedText(1e3 * told.latency, 1) + " ms")});
    }
    if (!cells.empty())
        page.table({"class", "distortion dB", "left on the model dB", "left on the take dB", "load", "latency"}, cells);
    for (const auto& trouble : troubles)
        page.note(trouble);
    page.note("Distortion: what is not the linear part's output, over that, under the stimulus of the fit. On the take "
              "what the model does not explain is left as well. The load is the share of a core that one channel "
              "takes.");
}

}  // namespace

std::string decibelsCell(double value) { return std::isfinite(value) ? fixedText(value, 1) : "\u2013"; }

void addRankingOfClasses(Page& page, const Ranking& ranking)
{
    page.headline(ranking.sentence, "good");
    page.paragraph(std::string(name(ranking.output)) + " explained by " + std::string(name(ranking.input))
                   + (ranking.noiseDb ? "; noise at " + decibelsCell(*ranking.noiseDb) + " dB" : ""));
    Plot plot;
    plot.title = "Error on records not seen against parameters";
    plot.x = {"parameters", "", true, 0.0, 0.0, {}};
    plot.y = {"error", "dB", false, 0.0, 0.0, {}};
    Series classes {"a class", Role::error, {}, {}, {}, {}, Series::Shape::pointsAndLine, 0};
    double fewest = std::numeric_limits<double>::infinity(), most = 0.0;
    std::vector<std::vector<Page::Cell>> rows;
    std::vector<std::string> troubles;
    for (const auto& model : ranking.models) {
        if (!model.trouble.empty()) {
            troubles.push_back(model.name + ": " + model.trouble);
            continue;
        }
        const double parameters = model.parameters;
        if (std::isfinite(model.judgedDb())) {
            classes.x.insert(classes.x.end(), {parameters, std::numeric_limits<double>::quiet_NaN()});
            classes.y.insert(classes.y.end(), {model.judgedDb(), std::numeric_limits<double>::quiet_NaN()});
            classes.names.insert(classes.names.end(), {model.name, ""});
            fewest = std::min(fewest, parameters);
            most = std::max(most, parameters);
        } else
            troubles.push_back(model.name + ": it runs away on records that it is judged by, and is not drawn.");
        rows.push_back({model.name, Page::figure(fixedText(parameters, 0)),
                        Page::figure(decibelsCell(model.estimationDb)), Page::figure(decibelsCell(model.validationDb)),
                        Page::figure(fixedText(100.0 * model.load, 2) + " %"), model.stable ? "yes" : "no",
                        model.description});
    }
    plot.series.push_back(std::move(classes));
    const bool drawn = fewest <= most;
    if (ranking.noiseDb && drawn)
        plot.series.push_back({"noise",
                               Role::noise,
                               {fewest, most},
                               {*ranking.noiseDb, *ranking.noiseDb},
                               {},
                               {},
                               Series::Shape::line,
                               0});
    page.section("Side by side");
    page.table({"class", "parameters", "estimation dB", "validation dB", "load", "stable", "what it is"}, rows);
    for (const auto& trouble : troubles)
        page.note(trouble);
    if (drawn)
        page.figures({plot}, 1,
                     "Errors are those of simulations, relative to the output. The load is the time that one core "
                     "simulates for.");
    addLinearizations(page, ranking);
}

}  // namespace excursion
