// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace excursion {

/// A table of numbers in a text, in the ways that programs write one:
///  - tabs, semicolons, commas or blanks between the cells, whichever makes the most numbers of the first row; quotes
///    are taken off;
///  - decimal points, or decimal commas where no comma separates; a text that has both is refused;
///  - lines that begin with * # % ! ; or // are remarks, as is all text above the numbers and below them;
///  - titles of the columns: the nearest line above the numbers that has as many cells, with a line of units below it
///    taken into them ("name [unit]"). A remark line counts when its first cell is a frequency or a time.
class TextTable {
public:
    /// @param text    as of plainText()
    /// @param source  for sentences; throws Error (input) when there is no row of numbers
    TextTable(std::string text, std::string source);

    bool hasTitles() const { return hasTitles_; }
    /// One a column; the columns' numbers where the file has none.
    const std::vector<std::string>& titles() const { return titles_; }
    /// The lines above the numbers, without their marks.
    const std::vector<std::string>& remarks() const { return remarks_; }
    std::size_t rows() const { return rows_.size(); }
    std::size_t lineOf(std::size_t row) const { return rows_[row].line; }

    /// A column by its exact title, else by its number from 1.
    std::optional<std::size_t> find(std::string_view column) const;

    /// The numbers of a column. It may end early (empty cells to the end), but an empty cell before a number, a text
    /// and a number that is not finite throw Error (input) naming line and column.
    std::vector<double> column(std::size_t index) const;

private:
    struct Row {
        std::size_t line;  ///< in the file, from 1
        std::size_t first, length;
    };
    std::string_view textOf(const Row& row) const { return std::string_view(text_).substr(row.first, row.length); }
    void findTitles(const std::vector<Row>& above, std::size_t columns);

    std::string text_, source_;
    char separator_ = ',';  ///< ' ' stands for any run of blanks and tabs
    bool hasTitles_ = false;
    std::vector<std::string> titles_, remarks_;
    std::vector<Row> rows_;
    mutable bool points_ = false, commas_ = false;  ///< seen as decimal marks
};

/// The number that the whole text is, without regard to the locale and with a leading plus allowed; nullopt when it is
/// something else.
/// @param decimalComma  whether a comma may be the decimal mark, too
std::optional<double> parseNumber(std::string_view, bool decimalComma = false);

}  // namespace excursion
