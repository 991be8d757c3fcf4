// SPDX-License-Identifier: GPL-3.0-or-later
#include "Study/Tables.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace excursion::study {
namespace {

/// The interval of such a width that a value lies in, in words.
std::string interval(double dB, double width)
{
    const double from = width * std::floor(dB / width);
    char buffer[60];
    std::snprintf(buffer, sizeof buffer, "%4.0f to %3.0f dB", from, from + width);
    return buffer;
}

std::string row(const std::string& what, const Share& share)
{
    char buffer[120];
    std::snprintf(buffer, sizeof buffer, "    %-36s %4d of %4d  %5.1f %%\n", what.c_str(), share.count, share.of,
                  100.0 * share.value());
    return buffer;
}

std::string channelSet(const Outcome& outcome)
{
    std::string all;
    for (const auto& channel : outcome.channels)
        all += (all.empty() ? "" : ", ") + channel;
    return all.empty() ? "none" : all;
}

bool has(const std::vector<std::string>& effects, const std::string& id)
{
    return std::find(effects.begin(), effects.end(), id) != effects.end();
}

}  // namespace

Tables tabulate(const std::vector<Outcome>& outcomes)
{
    constexpr double strengthStep = 12.0, noiseStep = 10.0;
    Tables tables;
    for (const auto& o : outcomes) {
        std::vector<std::string> wrong;
        std::copy_if(o.added.begin(), o.added.end(), std::back_inserter(wrong),
                     [&](const auto& id) { return !o.isThere(id); });
        bool missed = false;
        for (std::size_t n = 0; n < std::min(o.what.hidden.size(), o.showDb.size());
             ++n) {  // none of a take that failed
            if (!o.shows(n))
                continue;
            const auto& id = o.what.hidden[n];
            const bool found = has(o.added, id);
            for (auto* share :
                 {&tables.byChannels[channelSet(o)], &tables.byStrength[interval(o.showDb[n], strengthStep)],
                  &tables.byNoise[interval(o.noiseDb, noiseStep)], &tables.byDriver[o.driver]})
                share->add(found);
            missed = missed || !found;
            auto& told = tables.confusion[id];
            if (found || wrong.empty())
                ++told[found ? id : nothing];
            else
                for (const auto& other : wrong)
                    ++told[other];
        }
        if (!missed)
            for (const auto& id : wrong)
                ++tables.confusion[nothing][id];
    }
    return tables;
}

std::string text(const Tables& tables)
{
    std::string result;
    const auto add = [&](const char* title, const Tables::Shares& shares) {
        result += std::string("  shown effects that were added, by ") + title + "\n";
        for (const auto& [what, share] : shares)
            result += row(what, share);
    };
    add("channels", tables.byChannels);
    add("what they show", tables.byStrength);
    add("noise", tables.byNoise);
    add("driver", tables.byDriver);
    result += "  told as another\n";
    for (const auto& [there, told] : tables.confusion)
        for (const auto& [as, count] : told)
            if (there != as)
                result += "    " + there + " as " + as + ": " + std::to_string(count) + "\n";
    return result;
}

nlohmann::ordered_json toJson(const Tables& tables)
{
    using Json = nlohmann::ordered_json;
    Json document;
    const auto add = [&](const char* title, const Tables::Shares& shares) {
        for (const auto& [what, share] : shares)
            document[title][what.substr(what.find_first_not_of(' '))] = {{"found", share.count}, {"of", share.of}};
    };
    add("byChannels", tables.byChannels);
    add("byStrength", tables.byStrength);
    add("byNoise", tables.byNoise);
    add("byDriver", tables.byDriver);
    for (const auto& [there, told] : tables.confusion)
        for (const auto& [as, count] : told)
            document["confusion"][there][as] = count;
    return document;
}

}  // namespace excursion::study
