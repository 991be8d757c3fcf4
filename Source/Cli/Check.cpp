// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/CheckTables.h"
#include "Cli/Terminal.h"
#include "Cli/Verbs.h"
#include "Engine/Import/ReadTake.h"

#include "Engine/Check/PreparedTake.h"
#include "Engine/Check/TakeCheck.h"

#include <nlohmann/json.hpp>

#include <memory>

namespace excursion::cli {

void addCheck(CLI::App& app, Terminal& terminal)
{
    auto* verb = app.add_subcommand("check", "Say whether a take is fit for use, and if not, which channel is at fault")
                     ->group(step::look);
    auto take = std::make_shared<std::string>();
    verb->add_option("TAKE", *take, "the take: a folder, or a .csv of time signals")->required();
    verb->footer("Exit code 0: fit for use; 1: not.");
    verb->callback([take, &terminal] {
        const PreparedTake prepared(readMeasurement(*take));
        const auto& report = prepared.report();
        sayCheck(report, terminal);
        terminal.document(checkJson(report, *take, prepared.measurement().sampleRate));
        if (!report.fitForUse())
            terminal.answer = 1;
    });
}

}  // namespace excursion::cli
