// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Document/Words.h"
#include "Engine/Error.h"
#include "Engine/Import/ColumnTitle.h"
#include "Engine/Import/ImportOptions.h"
#include "Engine/Import/ResponseColumns.h"
#include "Engine/Take/Units.h"

#include <algorithm>
#include <utility>

namespace excursion {
namespace {

/// What one title says; what it leaves open is absent.
struct Reading {
    std::optional<ResponseName> response;
    std::optional<ResponsePart> part;
    std::string unit;
};

/// "u_re_v" as "u_v" and the real part: how this program writes spectra.
std::optional<std::pair<std::string, ResponsePart>> withoutPart(const std::string& title)
{
    const auto lower = lowerCase(title);
    for (const auto& [mark, part] : {std::pair {"_re", ResponsePart::real}, std::pair {"_im", ResponsePart::imaginary}})
        for (auto at = lower.find(mark); at != std::string::npos; at = lower.find(mark, at + 1))
            if (at > 0 && (at + 3 == lower.size() || lower[at + 3] == '_' || lower[at + 3] == ' ')) {
                auto plain = title;
                plain.erase(at, 3);
                return std::pair {plain, part};
            }
    return std::nullopt;
}

/// A word that names a response or its part, or both: "zre".
void readWord(const std::string& word, Reading& reading)
{
    if (const auto part = responsePartNamed(word)) {
        if (!reading.part)
            reading.part = part;
        return;
    }
    if (word.size() > 1 && word[0] == 'z')
        if (const auto part = responsePartNamed(word.substr(1))) {
            reading.response = responseNamed("impedance");
            reading.part = part;
            return;
        }
    const auto named = responseNamed(word == "imp" || word == "zin" ? "impedance" : word == "sound" ? "spl" : word);
    if (named && word != "f" && word != "response" && (!reading.response || word.size() > 1))
        reading.response = named;
}

/// "X(f)/U(f)" as "X/U".
std::string withoutArgument(std::string name)
{
    for (const char* argument : {"(f)", "(jw)", "(w)"})
        for (auto at = name.find(argument); at != std::string::npos; at = name.find(argument))
            name.erase(at, std::string_view(argument).size());
    return name;
}

Reading read(const std::string& title)
{
    Reading reading;
    const auto text = columnTitle(title);
    reading.unit = text.unit;
    const auto name = withoutArgument(text.name);
    reading.response = responseNamed(name);
    if (!reading.response)
        for (const auto& word : columnTitle(name).words)
            readWord(word, reading);
    if (angleUnit(text.unit))
        reading.part = ResponsePart::phase;
    else if (isDecibel(text.unit))
        reading.part = ResponsePart::decibels;
    if (text.has("spl") && text.unit.empty())
        reading.part = ResponsePart::decibels;
    if (reading.part == ResponsePart::phase)
        return reading;
    if (resistanceUnit(text.unit))
        reading.response = responseNamed("impedance");
    else if (isSoundLevel(text.unit)
             || (reading.response && !reading.response->input && reading.response->output == Quantity::pressure
                 && reading.part == ResponsePart::decibels))
        reading.response = responseNamed("spl");
    else if (const auto ratio = ratioOfUnit(text.unit))
        reading.response = reading.response && responseScale(*reading.response, ResponsePart::magnitude, text.unit)
                               ? reading.response
                               : ratio;
    return reading;
}

std::string siUnitOf(const ResponseName& response)
{
    if (response.isImpedance())
        return "ohm";
    return std::string(siUnit(response.output))
           + (response.input ? "/" + std::string(siUnit(*response.input)) : std::string());
}

std::string quotedList(const std::vector<std::string>& names)
{
    std::string text;
    for (std::size_t k = 0; k < names.size(); ++k)
        text += (k == 0 ? "'" : k + 1 == names.size() ? " and '" : ", '") + names[k] + "'";
    return text;
}

}  // namespace

ResponseColumns responseColumnsOf(const TextTable& table, const std::optional<ResponseName>& as,
                                  const std::optional<ResponseName>& guess, const std::string& source)
{
    const auto refuse = [&source](const std::string& why) {
        throw Error(Error::Kind::input, "'" + source + "' " + why);
    };
    const auto& titles = table.titles();
    ResponseColumns found;
    found.frequency = "1";
    found.frequencyFactor = frequencyFactor(columnTitle(titles.front())).value_or(1.0);
    if (!table.hasTitles()) {  // frequency, magnitude and phase, as in a ZMA or FRD
        const auto response = as ? as : guess;
        const bool sound = response && response->output == Quantity::pressure;
        found.columns.push_back({"2", response.value(), sound ? ResponsePart::decibels : ResponsePart::magnitude, {}});
        if (titles.size() > 2)
            found.columns.push_back({"3", *response, ResponsePart::phase, "deg"});
        return found;
    }
    std::optional<ResponseName> last;
    std::vector<std::string> left;
    for (std::size_t c = 1; c < titles.size(); ++c) {
        const auto& title = titles[c];
        const auto number = std::to_string(c + 1);  // titles may repeat
        if (frequencyFactor(columnTitle(title))) {
            found.remarks.push_back("'" + source
                                    + "' holds several curves, each with frequencies of its own; the first is taken.");
            break;
        }
        const auto split = withoutPart(title);
        if (split) {
            const auto& [plain, part] = *split;
            if (const auto quantity = columnNamed(plain)) {
                found.columns.push_back({number, {quantity->quantity, std::nullopt}, part, quantity->unit});
                if (quantity->unit.empty())
                    found.remarks.push_back("Column '" + title + "' of '" + source + "' has no unit; it is taken as "
                                            + std::string(siUnit(quantity->quantity)) + ".");
                continue;
            }
        }
        auto reading = read(split ? split->first : title);
        if (split)
            reading.part = split->second;
        const bool bare = !reading.part && reading.unit.empty();
        if (!reading.response && reading.part != ResponsePart::phase && (!bare || (as && found.columns.empty()))) {
            reading.response = as ? as : guess;
            if (reading.response && reading.response->output == Quantity::pressure && reading.unit.empty()
                && reading.part.value_or(ResponsePart::magnitude) == ResponsePart::magnitude) {
                reading.part = ResponsePart::decibels;
                found.remarks.push_back("Column '" + title + "' of '" + source + "' has no unit; it is taken as dB.");
            }
        }
        if (!reading.response && reading.part == ResponsePart::phase)
            reading.response = last;
        if (reading.response && !reading.response->input && reading.part == ResponsePart::phase && last
            && last->output == reading.response->output)
            reading.response = last;
        if (!reading.response) {
            if (split || reading.part == ResponsePart::decibels || reading.part == ResponsePart::magnitude)
                refuse(
                    "has a column '" + title
                    + "' whose quantity and unit are not understood; say what it is, for example with --as impedance "
                      "or --map "
                    + number + "=displacement/voltage." + (split ? "re" : "magnitude") + " of excursion import.");
            left.push_back(title);
            continue;
        }
        const auto part = reading.part.value_or(ResponsePart::magnitude);
        if (!responseScale(*reading.response, part, reading.unit))
            refuse("has a column '" + title + "' whose unit does not suit the " + textOf(*reading.response)
                   + ", expected " + acceptedUnits(*reading.response, part)
                   + "; map it with --map of excursion import.");
        if (reading.unit.empty() && part != ResponsePart::phase && part != ResponsePart::decibels)
            found.remarks.push_back("Column '" + title + "' of '" + source + "' has no unit; it is taken as "
                                    + siUnitOf(*reading.response) + ".");
        found.columns.push_back({number, *reading.response, part, reading.unit});
        last = reading.response;
    }
    if (found.columns.empty())
        refuse("has a column of frequencies, but no other whose title is understood"
               + (left.empty() ? std::string() : " (" + quotedList(left) + ")")
               + "; say what the file is, for example with --as impedance of excursion import, or map its columns with "
                 "--map.");
    if (!left.empty())
        found.remarks.push_back((left.size() == 1 ? "Column " : "Columns ") + quotedList(left) + " of '" + source + "' "
                                + (left.size() == 1 ? "was" : "were") + " left out, as the title is not understood.");
    return found;
}

}  // namespace excursion
