// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Destination.h"
#include "Cli/Terminal.h"
#include "Cli/Verbs.h"

#include "Engine/Batch/CollectionFile.h"
#include "Engine/Document/DraftFile.h"
#include "Engine/Document/JsonText.h"
#include "Engine/Document/TextFile.h"
#include "Engine/Document/Words.h"
#include "Engine/Error.h"
#include "Report/BatchReport.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <memory>

namespace excursion::cli {
namespace {

struct CollectArguments {
    std::vector<std::string> places, out;
    std::string limits, order = "name";
    std::vector<double> at;
    double threshold = 3.5;
    bool goOn = false;
};

std::string known(double value, int digits = 4)
{
    return std::isfinite(value) ? significant(value, digits) : std::string("-");
}

void printUnits(const Collection& all, Terminal& terminal)
{
    std::vector<std::vector<std::string>> rows;
    for (std::size_t k = 0; k < all.units.size(); ++k) {
        const auto& unit = all.units[k];
        rows.push_back({unit.name + (all.golden == k ? " (golden)" : ""), unit.verdict, joined(unit.effects),
                        !all.limited                ? ""
                        : !unit.measured            ? "not measured"
                        : unit.beyondLimits.empty() ? "within"
                                                    : joined(unit.beyondLimits),
                        joined(unit.standsOutBy())});
    }
    terminal.table({"unit", "verdict", "effects", all.limited ? "limits" : "", "stands out by"}, rows);
}

void printQuantities(const Collection& all, Terminal& terminal)
{
    std::vector<std::vector<std::string>> rows;
    for (const auto& q : all.quantities) {
        // As many digits as show a tenth of the spread.
        const double scatter = q.spread > 0.0 ? std::abs(q.median) / q.spread : 0.0;
        const int digits = scatter > 0.0 ? std::clamp(static_cast<int>(std::ceil(std::log10(scatter))) + 2, 4, 8) : 4;
        const bool limits = q.limited();
        rows.push_back({q.name, q.unit, std::to_string(q.known), known(q.median, digits), known(q.spread, 2),
                        known(q.least, digits), known(q.most, digits),
                        limits ? std::to_string(q.within) + " of " + std::to_string(all.measured) : "",
                        q.Cpk    ? fixed(*q.Cpk, 2)
                        : limits ? "-"
                                 : "",
                        std::isfinite(q.drift)
                            ? known(q.drift, 2) + " \u00b1 " + known(q.driftError, 2) + (q.drifts() ? " *" : "")
                            : "-"});
    }
    terminal.say("");
    terminal.table({"quantity", "unit", "units", "median", "spread", "least", "most", all.limited ? "within" : "",
                    all.limited ? "Cpk" : "", "drift per unit"},
                   rows);
    terminal.say("Spread: 1.4826 times the median distance from the median. * drift that is none of chance.");
}

void run(const CollectArguments& options, Terminal& terminal)
{
    for (const auto& file : options.out) {
        if (const auto ending = endingOf(file); ending != ".csv" && ending != ".html" && ending != ".json")
            throw Error(Error::Kind::usage, "The file \"" + file + "\" should end in .csv, .html or .json.");
        requireFilePlace(file);
    }
    CollectOptions collecting {options.at, options.threshold, {}};
    if (!options.limits.empty())
        collecting.limits = readLimits(options.limits);
    const auto units = readUnits({options.places.begin(), options.places.end()},
                                 {options.order == "name" ? UnitOrder::byName : UnitOrder::asGiven, options.goOn});
    const auto all = collect(units, collecting);
    const auto document = toJson(all);
    for (const auto& file : options.out) {
        const auto ending = endingOf(file);
        if (ending == ".csv")
            publish(file, collectionCsv(all));
        else if (ending == ".html")
            writeBatchReport(all, file);
        else
            writeJson(document, file);
    }
    printUnits(all, terminal);
    printQuantities(all, terminal);
    for (const auto& unread : all.unread)
        terminal.say(wrapped("not in the table: " + unread.name + ": " + unread.why));
    if (all.limited)
        terminal.say(std::to_string(all.passed) + " of " + std::to_string(all.measured)
                     + " measured units are within all limits"
                     + (all.measured < all.units.size()
                            ? "; " + std::to_string(all.units.size() - all.measured) + " more are not measured."
                            : "."));
    if (!options.out.empty())
        terminal.say("Wrote " + joined(options.out) + ".");
    terminal.document(document);
    if (all.limited && all.passed < all.units.size())
        terminal.answer = 1;
}

}  // namespace

void addCollect(CLI::App& app, Terminal& terminal)
{
    const auto [verb, o] = addVerb<CollectArguments>(
        app, terminal, step::batch, "collect",
        "The ladders of a batch in one table and on one page: yield, Cpk, drift, outliers, the golden unit", run);
    verb->add_option("DIR", o->places, "folders that improve --out has written, or folders of such folders")
        ->required();
    verb->add_option("--out", o->out,
                     "the table, a .csv; the page, a .html; the document, a .json; may be given several times")
        ->type_name("FILE")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    verb->add_option("--limits", o->limits,
                     "limits of quantities in the units of the table, a .json: {\"fs\": {\"min\": 45, \"max\": 55}}")
        ->type_name("FILE");
    verb->add_option("--order", o->order, "of the batch: by name, digits as numbers, or as given")
        ->check(CLI::IsMember({"name", "given"}))
        ->capture_default_str();
    verb->add_option("--at", o->at,
                     "displacements in m, to either side, at which the table has the laws over x, separated by commas; "
                     "by default half and all of what every unit visited")
        ->delimiter(',');
    verb->add_option("--outlier", o->threshold,
                     "distance from the median, in spreads, from which on a unit of a large batch is an outlier")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    verb->add_flag("--skip-unreadable", o->goOn,
                   "list ladders that cannot be read beside the table, instead of stopping");
    verb->footer("Exit code 1: a unit is outside the limits or was not measured.");
}

}  // namespace excursion::cli
