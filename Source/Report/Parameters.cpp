// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Document/Engineering.h"
#include "Engine/Loudspeaker/SensorResponse.h"
#include "Engine/Loudspeaker/Summary.h"
#include "Plots/Words.h"
#include "Report/Chapters.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

const Parameter* named(const std::vector<Parameter>& parameters, const std::string& name)
{
    const auto found = std::find_if(parameters.begin(), parameters.end(),
                                    [&](const auto& p) { return p.name == name; });
    return found == parameters.end() ? nullptr : &*found;
}

void addRows(std::vector<std::vector<Page::Cell>>& rows, const std::string& of,
             const std::vector<Parameter>& parameters, const std::vector<Parameter>* atStart)
{
    for (std::size_t k = 0; k < parameters.size(); ++k) {
        const auto& p = parameters[k];
        const auto* first = atStart ? named(*atStart, p.name) : nullptr;
        std::vector<Page::Cell> row {
            k == 0 ? of : std::string(), p.name,
            Page::figure(p.free ? withError(p.value, p.standardError, p.unit) : engineering(p.value, p.unit)),
            Page::figure(first ? engineering(first->value, p.unit) : "")};
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
    const auto atStart = toldOfPath(first);
    addRows(rows, model.path.effect->title(), toldOfPath(model), &atStart);
    page.table({"", "Parameter", "Final model", "First model", ""}, rows);
    page.note("Values with their standard errors; those of a law are the coefficients of its expansion over the "
              "visited range.");
}

}  // namespace excursion
