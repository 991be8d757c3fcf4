// SPDX-License-Identifier: GPL-3.0-or-later
// How often is the diagnosis right? Random loudspeakers with one hidden effect or several, and controls with none, are
// measured on the virtual bench, improved, and compared with the truth.
#include "Study/CalibrationPlot.h"
#include "Study/OutcomeFile.h"
#include "Study/Summary.h"

#include "Bench/Draw.h"
#include "Bench/Random.h"
#include "Engine/Document/DraftFile.h"
#include "Engine/Document/JsonText.h"
#include "Engine/Error.h"
#include "Report/Draw.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <mutex>
#include <thread>

using namespace excursion;
using namespace excursion::study;

namespace {

/// How many effects a take hides.
struct Several {
    int fewest = 1, most = 1;
};

/// A take that hides one effect gets them in turn, one that hides more draws them from its seed.
std::vector<std::string> hiddenIn(std::uint64_t seed, std::size_t turn, std::vector<std::string> effects,
                                  const Several& several)
{
    if (several.most <= 1)
        return {effects[turn % effects.size()]};
    bench::Random choice(seed, 40);
    const int count = several.fewest + choice.index(several.most - several.fewest + 1);
    std::vector<std::string> hidden;
    while (static_cast<int>(hidden.size()) < count && !effects.empty()) {
        const auto next = effects.begin() + choice.index(static_cast<int>(effects.size()));
        hidden.push_back(*next);
        effects.erase(next);
    }
    return hidden;
}

/// The controls follow with seeds of their own; oddities take turns.
std::vector<Case> cases(const std::vector<std::string>& effects, const Several& several, int takes, int controls,
                        Case first, const std::vector<std::string>& oddities)
{
    std::vector<Case> result;
    for (int n = 0; n < takes + controls; ++n) {
        auto mine = first;
        mine.seed += static_cast<std::uint64_t>(n);
        if (n < takes)
            mine.hidden = hiddenIn(mine.seed, static_cast<std::size_t>(n), effects, several);
        if (!oddities.empty())
            mine.oddity = oddities[static_cast<std::size_t>(n) % oddities.size()];
        result.push_back(std::move(mine));
    }
    return result;
}

}  // namespace

int main(int argc, char** argv)
{
    int takes = 200, controls = 50, jobs = 2;
    Case first;
    std::vector<std::string> channels, oddities;
    Several several;
    std::vector<std::filesystem::path> earlier;
    std::string json, calibration, demand;
    std::vector<std::string> hide = bench::drawnEffects();
    CLI::App app {"Draws random takes of virtual loudspeakers with one hidden effect or several (and controls with "
                  "none), improves each, and "
                  "says how often the diagnosis was right."};
    app.add_option("--takes", takes, "with a hidden effect")->check(CLI::NonNegativeNumber)->capture_default_str();
    app.add_option("--controls", controls, "without one")->check(CLI::NonNegativeNumber)->capture_default_str();
    app.add_option("--hide", hide, "the effects that take turns")
        ->delimiter(',')
        ->check(CLI::IsMember(bench::effectIds()))
        ->capture_default_str();
    app.add_option("--fewest", several.fewest, "effects that a take hides at once")
        ->check(CLI::Range(1, 13))
        ->capture_default_str();
    app.add_option("--most", several.most, "effects that a take hides at once; with more than one they are drawn")
        ->check(CLI::Range(1, 13))
        ->capture_default_str();
    app.add_option("--first-seed", first.seed, "of the first take; the others follow")->capture_default_str();
    app.add_option("--seconds", first.seconds, "about, of each take")
        ->check(CLI::Range(0.5, 120.0))
        ->capture_default_str();
    app.add_option("--channels", channels, "of each take, beside the voltage; drawn when not given")
        ->delimiter(',')
        ->check([](const std::string& word) { return quantityNamed(word) ? "" : "unknown channel: " + word; });
    app.add_option("--beside", oddities, "what no effect describes: these take turns beside what is hidden")
        ->delimiter(',')
        ->check(CLI::IsMember(bench::oddityNames()));
    app.add_option("--jobs", jobs, "takes at once; with more than one, each fit has one thread")
        ->check(CLI::Range(1, 64))
        ->capture_default_str();
    app.add_option("--keep", first.keep, "folder for the takes and what they hide, for other programs to try");
    app.add_option("--json", json, "file for all results, kept up to date while the study runs");
    app.add_option("--with", earlier, "files of earlier studies, whose takes count, too")->delimiter(',');
    app.add_option("--calibration", calibration, "SVG file that shows what confidence means");
    app.add_option(
           "--demand", demand,
           "exit with 1 unless the shares reach their targets: of the diagnosis, or all, the bands of the laws too")
        ->check(CLI::IsMember({"diagnosis", "all"}));
    CLI11_PARSE(app, argc, argv);
    several.most = std::max(several.most, several.fewest);

    first.threads = jobs > 1 ? 1 : 2;
    if (!channels.empty()) {
        first.channels = {Quantity::voltage};
        for (const auto& channel : channels)
            first.channels->push_back(quantityNamed(channel).value());
    }
    std::vector<Outcome> outcomes;
    try {
        for (const auto& file : earlier)
            for (auto& outcome : readOutcomes(file))
                outcomes.push_back(std::move(outcome));
    } catch (const Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
    const auto plan = cases(hide, several, takes, controls, first, oddities);
    std::erase_if(outcomes, [&](const Outcome& o) {  // what runs again counts once
        return std::any_of(plan.begin(), plan.end(), [&](const Case& c) { return c.seed == o.what.seed; });
    });
    std::mutex mutex;
    std::size_t next = 0;
    const auto work = [&] {
        for (;;) {
            Case mine;
            {
                const std::lock_guard lock(mutex);
                if (next == plan.size())
                    return;
                mine = plan[next++];
            }
            auto outcome = run(mine);
            const std::lock_guard lock(mutex);
            std::printf("%s\n", line(outcome).c_str());
            std::fflush(stdout);
            outcomes.push_back(std::move(outcome));
            std::sort(outcomes.begin(), outcomes.end(),
                      [](const Outcome& a, const Outcome& b) { return a.what.seed < b.what.seed; });
            if (!json.empty())
                writeJson(toJson(summarize(outcomes), outcomes), json);
        }
    };
    {
        std::vector<std::jthread> workers;
        for (int n = 1; n < jobs; ++n)
            workers.emplace_back(work);
        work();
    }
    const auto summary = summarize(outcomes);
    if (!json.empty())
        writeJson(toJson(summary, outcomes), json);
    if (!calibration.empty())
        publish(calibration, svgDocument(calibrationPlot(summary.calibration)));
    std::printf("%s", text(summary, outcomes).c_str());
    const bool reached = demand == "all" ? summary.reached() : demand.empty() || summary.diagnosed();
    return reached ? 0 : 1;
}
