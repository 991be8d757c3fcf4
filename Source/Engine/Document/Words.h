// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <concepts>
#include <string>
#include <string_view>
#include <vector>

namespace excursion {

/// "a, b, c".
std::string joined(const std::vector<std::string>& words, std::string_view between = ", ");

/// The same of what `word` makes of each element.
template <class Range, class Word>
requires std::invocable<Word, typename Range::const_reference> std::string joined(const Range& range, Word word,
                                                                                  std::string_view between = ", ")
{
    std::vector<std::string> words;
    for (const auto& element : range)
        words.push_back(word(element));
    return joined(words, between);
}

/// Without the blanks, tabs and line breaks at both ends.
std::string_view trimmed(std::string_view);

/// ASCII letters in lower case; other bytes as they are.
std::string lowerCase(std::string_view);

}  // namespace excursion
