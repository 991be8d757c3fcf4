// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Datasheet/LawTable.h"

#include <limits>
#include <utility>

namespace excursion {

LawTable tableOf(const LawCurve& law)
{
    LawTable table {
        law.info.name, law.info.unit, law.info.argument, law.info.argumentUnit, law.argument, law.value, {}, {},
        law.frequency};
    for (std::size_t k = 0; k < law.value.size(); ++k) {
        table.low95.push_back(law.value[k] - law.halfWidth[k]);
        table.high95.push_back(law.value[k] + law.halfWidth[k]);
    }
    return table;
}

std::vector<LawTable> lawTables(const ScaledModel& given, int points)
{
    std::vector<LawTable> tables;
    for (const auto& law : laws(given.model, points)) {
        if (given.motionIsGuessed && law.info.argument != "i")
            continue;
        auto table = tableOf(law);
        tables.push_back(table);
        if (law.info.base != "K")
            continue;
        table.name = "Cms(" + law.info.argument + ")";
        table.unit = "m/N";
        for (auto* values : {&table.value, &table.low95, &table.high95})
            for (auto& value : *values)
                value = 1.0 / value;
        std::swap(table.low95, table.high95);
        for (std::size_t k = 0; k < table.at.size(); ++k)
            if (!(law.value[k] > law.halfWidth[k])) {  // the band of K holds zero: that of Cms has no end
                table.low95[k] = 1.0 / (law.value[k] + law.halfWidth[k]);
                table.high95[k] = std::numeric_limits<double>::quiet_NaN();
            }
        tables.push_back(std::move(table));
    }
    return tables;
}

}  // namespace excursion
