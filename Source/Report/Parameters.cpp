// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Document/Engineering.h"
#include "Engine/Loudspeaker/Summary.h"
#include "Plots/Words.h"
#include "Report/Chapters.h"

#include <cmath>

namespace excursion {
namespace {

void addRows(std::vector<std::vector<Page::Cell>>& rows, const std::string& of,
             const std::vector<Parameter>& parameters, const std::vector<Parameter>* atStart)
{
    for (std::size_t k = 0; k < parameters.size(); ++k) {
        const auto& p = parameters[k];
        std::vector<Page::Cell> row {
            k == 0 ? of : std::string(), p.name,
            Page::figure(p.free ? withError(p.value, p.standardError, p.unit) : engineering(p.value, p.unit)),
            Page::figure(atStart && k < atStart->size() ? engineering((*atStart)[k].value, p.unit) : "")};
        row.emplace_back(!p.free                          ? "held, this take cannot see it"
                         : std::isfinite(p.standardError) ? ""
                                                          : "error unknown");
        rows.push_back(std::move(row));
    }
}

/// What the parameters of one component come to, ahead of them.
void addRows(std::vector<std::vector<Page::Cell>>& rows, const std::string& of, const std::vector<Figure>& figures)
{
    for (std::size_t k = 0; k < figures.size(); ++k) {
        const auto& f = figures[k];
        rows.push_back({k == 0 ? of : std::string(), f.name, Page::figure(withError(f.value, f.standardError, f.unit)),
                        Page::figure(""), "summary of the spectrum"});
    }
}

}  // namespace

void addParameters(Page& page, const LadderFile& file)
{
    const auto& model = file.ladder.model();
    const auto& first = file.ladder.rungs.front().model;
    page.section("Parameters");
    std::vector<std::vector<Page::Cell>> rows;
    for (std::size_t k = 0; k < model.components.size(); ++k) {
        const auto& component = model.components[k];
        addRows(rows, component.effect->title(), figuresOf(model, k));
        const auto* start = k == 0 ? &first.base() : first.find(component.effect->id());
        addRows(rows, component.effect->title(), component.parameters, start ? &start->parameters : nullptr);
    }
    addRows(rows, model.path.effect->title(), model.path.parameters, &first.path.parameters);
    page.table({"", "Parameter", "Final model", "First model", ""}, rows);
    page.note("Values with their standard errors; those of a law are the coefficients of its expansion over the "
              "visited range.");
}

}  // namespace excursion
