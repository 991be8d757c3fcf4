// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Import/ColumnTitle.h"

#include "Engine/Document/Words.h"
#include "Engine/Import/ResponseName.h"
#include "Engine/Take/Units.h"

#include <algorithm>
#include <utility>

namespace excursion {
namespace {

bool isOneOf(std::string_view text, std::initializer_list<std::string_view> words)
{
    return std::find(words.begin(), words.end(), text) != words.end();
}

std::vector<std::string> wordsOf(std::string_view text)
{
    std::vector<std::string> words;
    std::string word;
    for (const char c : lowerCase(text) + " ") {
        const bool inside = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || static_cast<unsigned char>(c) >= 0x80;
        if (inside)
            word += c;
        else if (!word.empty())
            words.push_back(std::exchange(word, {}));
    }
    return words;
}

/// Whether a title that is nothing but this text is a unit rather than a name: "Hz" is, "V" is not.
bool standsAlone(std::string_view text)
{
    return frequencyUnit(text) || resistanceUnit(text) || angleUnit(text) || isDecibel(text);
}

}  // namespace

bool ColumnTitle::has(std::string_view word) const
{
    return std::find(words.begin(), words.end(), word) != words.end();
}

bool isUnit(std::string_view text)
{
    if (text.empty())
        return false;
    if (frequencyUnit(text) || timeUnit(text) || angleUnit(text) || resistanceUnit(text) || isDecibel(text)
        || ratioOfUnit(text))
        return true;
    return std::any_of(quantities.begin(), quantities.end(),
                       [text](Quantity quantity) { return unitNamed(quantity, text).has_value(); });
}

ColumnTitle columnTitle(std::string_view title)
{
    ColumnTitle read;
    auto text = trimmed(title);
    read.name = std::string(text);
    const auto consider = [&](std::string_view name, std::string_view unit) {
        read.name = std::string(trimmed(name));
        read.unit = std::string(trimmed(unit));
    };
    if (standsAlone(text)) {
        consider({}, text);
    } else if (!text.empty() && (text.back() == ']' || text.back() == ')')) {
        // A bracket at the end that holds no unit, as in Re(Z), belongs to the name.
        const auto open = text.rfind(text.back() == ']' ? '[' : '(');
        if (open != std::string_view::npos) {
            const auto inner = trimmed(text.substr(open + 1, text.size() - open - 2));
            if (text.back() == ']' || isUnit(inner))
                consider(text.substr(0, open), inner);
        }
    } else {
        // "f/Hz", "x / mm": the first stroke behind which a unit stands; but "X/U" is a ratio of quantities.
        const auto stroke = text.find('/');
        if (stroke != std::string_view::npos && stroke > 0 && isUnit(trimmed(text.substr(stroke + 1)))
            && !responseNamed(lowerCase(text))) {
            consider(text.substr(0, stroke), text.substr(stroke + 1));
        } else {
            for (const char separator : {'_', ' ', ','}) {
                const auto at = text.rfind(separator);
                if (at != std::string_view::npos && at > 0 && isUnit(trimmed(text.substr(at + 1)))) {
                    consider(text.substr(0, at), text.substr(at + 1));
                    break;
                }
            }
        }
    }
    read.words = wordsOf(read.name);
    return read;
}

std::optional<double> frequencyFactor(const ColumnTitle& title)
{
    const bool named = title.words.size() == 1
                       && isOneOf(title.words[0], {"f", "freq", "frq", "frequency", "frequencies", "frequenz"});
    if (named && title.unit.empty())
        return 1.0;
    const bool omega = title.words.size() == 1 && isOneOf(title.words[0], {"omega", "w", "\u03c9"});
    return named || omega || title.words.empty() ? frequencyUnit(title.unit) : std::nullopt;
}

std::optional<double> timeFactor(const ColumnTitle& title)
{
    if (title.words.size() != 1 || !isOneOf(title.words[0], {"t", "time", "zeit"}))
        return std::nullopt;
    return title.unit.empty() ? std::optional(1.0) : timeUnit(title.unit);
}

}  // namespace excursion
