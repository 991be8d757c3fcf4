// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Measurement/DelimitedText.h"

#include "Engine/Error.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace excursion {
namespace {

std::string_view trimmed(std::string_view text)
{
    constexpr std::string_view blanks = " \t\r\v\f";
    const auto first = text.find_first_not_of(blanks);
    if (first == std::string_view::npos)
        return {};
    return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::string_view unquoted(std::string_view text)
{
    text = trimmed(text);
    if (text.size() >= 2 && text.front() == '"' && text.back() == '"')
        text = trimmed(text.substr(1, text.size() - 2));
    return text;
}

std::string_view nthCell(std::string_view line, char separator, std::size_t index)
{
    for (std::size_t i = 0; i < index; ++i) {
        const auto at = line.find(separator);
        if (at == std::string_view::npos)
            return {};
        line.remove_prefix(at + 1);
    }
    return unquoted(line.substr(0, line.find(separator)));
}

} // namespace

DelimitedText::DelimitedText(std::string text, std::string source) : text_(std::move(text)), source_(std::move(source))
{
    std::size_t lineNumber = 0;
    for (std::size_t first = 0; first < text_.size();) {
        const auto end = std::min(text_.find('\n', first), text_.size());
        const auto line = std::string_view(text_).substr(first, end - first);
        ++lineNumber;
        const bool counts = !trimmed(line).empty() && line.front() != '#';
        if (counts && header_.empty()) {
            for (const char candidate : {'\t', ';', ','})   // a comma may belong to a name
                if (line.find(candidate) != std::string_view::npos) {
                    separator_ = candidate;
                    break;
                }
            const auto cells = static_cast<std::size_t>(std::count(line.begin(), line.end(), separator_)) + 1;
            for (std::size_t c = 0; c < cells; ++c)
                header_.emplace_back(nthCell(line, separator_, c));
        } else if (counts) {
            rows_.push_back({lineNumber, first, line.size()});
        }
        first = end + 1;
    }
    if (rows_.empty())
        throw Error(Error::Kind::input, "'" + source_ + "' has no rows of numbers below a header row that names its columns.");
}

std::optional<std::size_t> DelimitedText::find(std::string_view name) const
{
    const auto found = std::find(header_.begin(), header_.end(), name);
    if (found == header_.end())
        return std::nullopt;
    return static_cast<std::size_t>(found - header_.begin());
}

std::string_view DelimitedText::cell(const Row& row, std::size_t index) const
{
    return nthCell(std::string_view(text_).substr(row.first, row.length), separator_, index);
}

std::vector<double> DelimitedText::column(std::size_t index) const
{
    const auto refuse = [&](std::size_t line, const std::string& found) {
        throw Error(Error::Kind::input, "'" + source_ + "': line " + std::to_string(line) + ", column '" + header_[index] + "' " + found
                                            + ", expected a finite number.");
    };
    std::vector<double> values;
    values.reserve(rows_.size());
    std::size_t firstEmpty = 0;
    std::string decimal;
    for (const auto& row : rows_) {
        auto text = cell(row, index);
        if (text.empty()) {
            firstEmpty = firstEmpty == 0 ? row.line : firstEmpty;
            continue;
        }
        if (firstEmpty != 0)
            refuse(firstEmpty, "is empty");
        if (separator_ != ',' && text.find(',') != std::string_view::npos) {
            decimal = text;
            std::replace(decimal.begin(), decimal.end(), ',', '.');
            text = decimal;
        }
        const auto value = parseNumber(text);
        if (!value || !std::isfinite(*value))
            refuse(row.line, "is '" + std::string(text.substr(0, 40)) + "'");
        values.push_back(*value);
    }
    return values;
}

std::optional<double> parseNumber(std::string_view text)
{
    if (text.size() > 1 && text.front() == '+' && text[1] != '-')
        text.remove_prefix(1);
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size())
        return std::nullopt;
    return value;
}

} // namespace excursion
