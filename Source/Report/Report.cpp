// SPDX-License-Identifier: GPL-3.0-or-later
#include "Report/Report.h"

#include "Engine/Document/DraftFile.h"
#include "Report/Chapters.h"

namespace excursion {

std::string reportHtml(const LadderFile& file)
{
    Page page("Excursion report" + (file.take.driver.empty() ? "" : " \u00b7 " + file.take.driver));
    addVerdict(page, file);
    addProblems(page, file);
    if (!file.ladder.rungs.empty()) {
        addRungs(page, file);
        addEffects(page, file);
        addWhatIf(page, file);
        addResponses(page, file);
        addSpectra(page, file);
        addResiduals(page, file);
        addRanking(page, file);
        addParameters(page, file);
    }
    return page.html();
}

void writeReport(const LadderFile& file, const std::filesystem::path& path) { publish(path, reportHtml(file)); }

}  // namespace excursion
