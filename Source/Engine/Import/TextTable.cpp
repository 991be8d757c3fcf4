// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Import/TextTable.h"

#include "Engine/Document/Words.h"
#include "Engine/Error.h"
#include "Engine/Import/ColumnTitle.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

namespace excursion {
namespace {

std::string_view unquoted(std::string_view text)
{
    text = trimmed(text);
    if (text.size() >= 2 && text.front() == '"' && text.back() == '"')
        text = trimmed(text.substr(1, text.size() - 2));
    return text;
}

/// Calls visit(index, cell) for each cell of a line until it returns false.
template <class Visit>
void eachCell(std::string_view line, char separator, Visit visit)
{
    for (std::size_t index = 0;; ++index) {
        if (separator == ' ') {
            line = trimmed(line);
            if (line.empty())
                return;
        }
        const auto end = separator == ' ' ? line.find_first_of(" \t\v\f") : line.find(separator);
        if (!visit(index, unquoted(line.substr(0, end))) || end == std::string_view::npos)
            return;
        line.remove_prefix(end + 1);
    }
}

std::vector<std::string> cellsOf(std::string_view line, char separator)
{
    std::vector<std::string> cells;
    eachCell(line, separator, [&cells](std::size_t, std::string_view cell) {
        cells.emplace_back(cell);
        return true;
    });
    return cells;
}

struct Count {
    std::size_t cells = 0, filled = 0, numbers = 0;
    bool firstIsNumber = false;
};

Count countOf(std::string_view line, char separator)
{
    Count count;
    eachCell(line, separator, [&](std::size_t, std::string_view cell) {
        ++count.cells;
        if (cell.empty())
            return true;
        const bool number = parseNumber(cell, separator != ',').has_value();
        count.firstIsNumber = count.firstIsNumber || (count.filled == 0 && number);
        ++count.filled;
        count.numbers += number;
        return true;
    });
    return count;
}

bool mostlyNumbers(const Count& count) { return count.firstIsNumber && 2 * count.numbers >= count.filled; }

/// The separator that makes the most numbers of a line.
char separatorFor(std::string_view line)
{
    char best = ',';
    std::size_t most = 0;
    for (const char candidate : {'\t', ';', ',', ' '})
        if (const auto numbers = countOf(line, candidate).numbers; numbers > most) {
            most = numbers;
            best = candidate;
        }
    return best;
}

/// What stands after the mark of a remark; nullopt when the line is none.
std::optional<std::string_view> afterMark(std::string_view line)
{
    line = trimmed(line);
    const auto end = line.starts_with("//") ? 2 : line.find_first_not_of("*#%!;");
    if (end == 0 || line.empty())
        return std::nullopt;
    return trimmed(line.substr(std::min(end, line.size())));
}

/// Words between blanks, with a unit in brackets taken to the word before it.
std::vector<std::string> wordsOf(std::string_view line)
{
    std::vector<std::string> words;
    int depth = 0;
    for (auto& cell : cellsOf(line, ' ')) {
        const bool joins = !words.empty() && (depth > 0 || cell.front() == '(' || cell.front() == '[');
        for (const char c : cell)
            depth += c == '(' || c == '[' ? 1 : (c == ')' || c == ']') && depth > 0 ? -1 : 0;
        if (joins)
            words.back() += " " + cell;
        else
            words.push_back(std::move(cell));
    }
    return words;
}

bool isAxis(const std::string& title)
{
    const auto read = columnTitle(title);
    return frequencyFactor(read) || timeFactor(read);
}

bool onlyUnits(const std::vector<std::string>& cells)
{
    return std::any_of(cells.begin(), cells.end(), [](const auto& cell) { return !cell.empty(); })
           && std::all_of(cells.begin(), cells.end(),
                          [](const auto& cell) { return cell.empty() || isUnit(withoutBrackets(cell)); });
}

}  // namespace

TextTable::TextTable(std::string text, std::string source) : text_(std::move(text)), source_(std::move(source))
{
    std::vector<Row> above;
    bool begun = false;
    std::size_t lineNumber = 0;
    const auto nextLine = [this](std::size_t after) {
        while (after < text_.size()) {
            const auto end = std::min(text_.find('\n', after), text_.size());
            const auto line = std::string_view(text_).substr(after, end - after);
            if (!trimmed(line).empty() && !afterMark(line))
                return line;
            after = end + 1;
        }
        return std::string_view();
    };
    for (std::size_t first = 0; first < text_.size();) {
        const auto end = std::min(text_.find('\n', first), text_.size());
        const Row row {++lineNumber, first, end - first};
        const auto line = textOf(row);
        first = end + 1;
        if (trimmed(line).empty())
            continue;
        const bool marked = afterMark(line) && !(begun && separator_ == ';' && line.front() == ';');
        if (!begun && !marked) {
            const char candidate = separatorFor(line);
            const auto count = countOf(line, candidate);
            const auto next = nextLine(first);
            // A heading such as "5 kHz" is half a number; what follows it is not.
            if (mostlyNumbers(count)
                && (count.numbers == count.filled || next.empty() || mostlyNumbers(countOf(next, candidate)))) {
                begun = true;
                separator_ = candidate;
            }
        }
        if (!begun)
            above.push_back(row);
        else if (!marked && !(line.front() == '"' && countOf(line, separator_).numbers == 0))
            rows_.push_back(row);
    }
    while (!rows_.empty() && countOf(textOf(rows_.back()), separator_).numbers == 0)
        rows_.pop_back();
    if (rows_.empty())
        throw Error(Error::Kind::input, "'" + source_ + "' has no rows of numbers.");
    std::size_t columns = 0;
    for (std::size_t k = 0; k < std::min<std::size_t>(rows_.size(), 20); ++k)
        columns = std::max(columns, countOf(textOf(rows_[k]), separator_).cells);
    for (const auto& row : above) {
        const auto line = textOf(row);
        remarks_.emplace_back(unquoted(afterMark(line).value_or(line)));
    }
    findTitles(above, columns);
    for (std::size_t c = titles_.size(); c < columns; ++c)
        titles_.push_back(std::to_string(c + 1));
}

void TextTable::findTitles(const std::vector<Row>& above, std::size_t columns)
{
    const auto inUse = [](std::vector<std::string> cells) {
        while (!cells.empty() && cells.back().empty())
            cells.pop_back();
        return cells;
    };
    const auto filled = [&] {
        std::size_t most = 0;
        for (std::size_t k = 0; k < std::min<std::size_t>(rows_.size(), 20); ++k)
            most = std::max(most, inUse(cellsOf(textOf(rows_[k]), separator_)).size());
        return most;
    }();
    std::vector<std::string> units;
    std::size_t looked = 0;
    for (auto row = above.rbegin(); row != above.rend() && looked < 8; ++row, ++looked) {
        const auto line = textOf(*row);
        const auto mark = afterMark(line);
        const auto inner = mark.value_or(line);
        std::vector<std::string> cells;
        if (!mark) {
            cells = cellsOf(inner, separator_);
            if (separator_ == ' ')
                cells = wordsOf(inner);
        }
        const auto fits = [&](const std::vector<std::string>& c) {
            return c.size() == columns || inUse(c).size() == filled;
        };
        bool found = !mark && cells.size() >= filled && (separator_ != ' ' || fits(cells));
        for (const char other : {'\t', ';', ','})
            if (!found && inner.find(other) != std::string_view::npos) {
                cells = inUse(cellsOf(inner, other));
                found = cells.size() == filled && (isAxis(cells.front()) || onlyUnits(cells));
            }
        if (!found) {
            cells = wordsOf(inner);
            found = cells.size() == filled && (isAxis(cells.front()) || onlyUnits(cells));
        }
        if (!found) {
            if (!mark && separator_ == ',' && looked == 0 && inUse(cellsOf(inner, ',')).size() > 1
                && 2 * inUse(cellsOf(inner, ',')).size() <= filled)
                throw Error(Error::Kind::input,
                            "'" + source_ + "': line " + std::to_string(rows_.front().line) + " has "
                                + std::to_string(filled) + " cells below "
                                + std::to_string(inUse(cellsOf(inner, ',')).size())
                                + " titles; where commas are decimal, cells need semicolons or tabs between them.");
            continue;
        }
        if (units.empty() && onlyUnits(cells) && row + 1 != above.rend()) {
            units = cells;
            units.resize(std::max(units.size(), columns));
            continue;
        }
        titles_ = cells;
        break;
    }
    if (titles_.empty())
        titles_ = std::exchange(units, {});
    hasTitles_ = !titles_.empty();
    for (std::size_t c = 0; c < std::min(units.size(), titles_.size()); ++c)
        if (!units[c].empty() && columnTitle(titles_[c]).unit.empty())
            titles_[c] += " [" + withoutBrackets(units[c]) + "]";
}

std::optional<std::size_t> TextTable::find(std::string_view column) const
{
    const auto found = std::find(titles_.begin(), titles_.end(), column);
    if (found != titles_.end())
        return static_cast<std::size_t>(found - titles_.begin());
    std::size_t number = 0;
    const auto [end, error] = std::from_chars(column.data(), column.data() + column.size(), number);
    if (error != std::errc() || end != column.data() + column.size() || number == 0 || number > titles_.size())
        return std::nullopt;
    return number - 1;
}

std::vector<double> TextTable::column(std::size_t index) const
{
    const auto refuse = [&](std::size_t line, const std::string& found) {
        throw Error(Error::Kind::input, "'" + source_ + "': line " + std::to_string(line) + ", column '"
                                            + titles_[index] + "' " + found + ", expected a finite number.");
    };
    std::vector<double> values;
    values.reserve(rows_.size());
    std::size_t firstEmpty = 0;
    for (const auto& row : rows_) {
        std::string_view text;
        eachCell(textOf(row), separator_, [&](std::size_t c, std::string_view cell) {
            text = c == index ? cell : std::string_view();
            return c != index;
        });
        if (text.empty()) {
            firstEmpty = firstEmpty == 0 ? row.line : firstEmpty;
            continue;
        }
        if (firstEmpty != 0)
            refuse(firstEmpty, "is empty");
        const auto value = parseNumber(text, separator_ != ',');
        if (!value || !std::isfinite(*value))
            refuse(row.line, "is '" + std::string(text.substr(0, 40)) + "'");
        points_ = points_ || text.find('.') != std::string_view::npos;
        commas_ = commas_ || (separator_ != ',' && text.find(',') != std::string_view::npos);
        if (points_ && commas_)
            refuse(row.line, "is '" + std::string(text.substr(0, 40))
                                 + "', in a table that has both points and commas in its numbers");
        values.push_back(*value);
    }
    return values;
}

std::optional<double> parseNumber(std::string_view text, bool decimalComma)
{
    if (decimalComma && text.size() <= 64 && text.find('.') == std::string_view::npos
        && std::count(text.begin(), text.end(), ',') == 1) {
        std::string decimal(text);
        std::replace(decimal.begin(), decimal.end(), ',', '.');
        return parseNumber(decimal);
    }
    if (text.size() > 1 && text.front() == '+' && text[1] != '-')
        text.remove_prefix(1);
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size())
        return std::nullopt;
    return value;
}

}  // namespace excursion
