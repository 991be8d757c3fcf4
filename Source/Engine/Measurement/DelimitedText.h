// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace excursion {

/// A text table with a header row: comma, semicolon or tab between the cells, whichever the header has.
/// Quotes around cells are taken off. With semicolons or tabs, a decimal comma is understood as well.
/// Lines of blanks, and those that begin with '#', are left out.
class DelimitedText {
public:
    /// @param source  for sentences; throws Error (input) when there is no header row or no row below it
    DelimitedText(std::string text, std::string source);

    const std::vector<std::string>& header() const { return header_; }
    std::optional<std::size_t> find(std::string_view name) const;   ///< a column, by its exact name

    /// The numbers of a column. It may end early (empty cells to the end), but an empty cell before a
    /// number, a text and a number that is not finite throw Error (input) naming line and column.
    std::vector<double> column(std::size_t index) const;

private:
    struct Row {
        std::size_t line;   ///< in the file, from 1
        std::size_t first, length;
    };
    std::string_view cell(const Row&, std::size_t index) const;

    std::string text_, source_;
    char separator_ = ',';
    std::vector<std::string> header_;
    std::vector<Row> rows_;
};

/// The number that the whole text is, without regard to the locale and with a leading plus allowed;
/// nullopt when it is something else.
std::optional<double> parseNumber(std::string_view);

} // namespace excursion
