// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Batch/Units.h"

#include "Engine/Error.h"

#include <algorithm>
#include <map>

namespace excursion {
namespace {

namespace fs = std::filesystem;

constexpr auto ladderName = "ladder.json";

bool isDigit(char c) { return c >= '0' && c <= '9'; }

/// The digits from there on without zeros ahead, and where they end.
std::string_view numberAt(std::string_view text, std::size_t& at)
{
    auto end = at;
    while (end < text.size() && isDigit(text[end]))
        ++end;
    while (at + 1 < end && text[at] == '0')
        ++at;
    const auto digits = text.substr(at, end - at);
    at = end;
    return digits;
}

/// Folder of a ladder by any way of writing its path.
std::string nameOf(const fs::path& ladder)
{
    std::error_code ignored;
    auto folder = fs::absolute(ladder, ignored).lexically_normal().parent_path();
    return folder.filename().string();
}

std::vector<fs::path> foldersIn(const fs::path& place)
{
    std::vector<fs::path> folders;
    std::error_code error;
    for (fs::directory_iterator it(place, error), end; !error && it != end; it.increment(error))
        if (it->is_directory(error) && !error)
            folders.push_back(it->path());
    if (error)
        throw Error(Error::Kind::input, "'" + place.string() + "' cannot be read (" + error.message() + ").");
    std::sort(folders.begin(), folders.end(),
              [](const auto& a, const auto& b) { return nameBefore(a.filename().string(), b.filename().string()); });
    return folders;
}

}  // namespace

bool nameBefore(const std::string& a, const std::string& b)
{
    std::size_t i = 0, j = 0;
    while (i < a.size() && j < b.size()) {
        if (isDigit(a[i]) && isDigit(b[j])) {
            const auto one = numberAt(a, i), two = numberAt(b, j);
            if (one != two)
                return one.size() != two.size() ? one.size() < two.size() : one < two;
        } else if (a[i] != b[j]) {
            return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[j]);
        } else {
            ++i;
            ++j;
        }
    }
    if ((i == a.size()) != (j == b.size()))
        return i == a.size();
    return a < b;  // the same but for zeros ahead of a number
}

Units readUnits(const std::vector<fs::path>& places, const ReadUnitsOptions& options)
{
    Units result;
    std::vector<fs::path> ladders;
    for (const auto& place : places) {
        std::error_code ignored;
        if (fs::is_regular_file(place, ignored)) {
            ladders.push_back(place);
        } else if (!fs::is_directory(place, ignored)) {
            throw Error(Error::Kind::input, "'" + place.string() + "' is neither a folder nor a ladder.json.");
        } else if (fs::exists(place / ladderName, ignored)) {
            ladders.push_back(place / ladderName);
        } else {
            const auto before = ladders.size();
            const auto folders = foldersIn(place);
            for (const auto& folder : folders) {
                if (fs::exists(folder / ladderName, ignored))
                    ladders.push_back(folder / ladderName);
                else
                    result.unread.push_back({folder.filename().string(), "the folder has no ladder.json"});
            }
            if (options.goOn && folders.empty())
                result.unread.push_back({nameOf(place / ladderName), "the folder has no ladder.json"});
            else if (ladders.size() == before)
                throw Error(Error::Kind::input, "'" + place.string()
                                                    + "' holds no ladder.json, and neither does a folder in it; give "
                                                      "folders that excursion improve --out has "
                                                      "written.");
        }
    }
    if (options.order == UnitOrder::byName)
        std::stable_sort(ladders.begin(), ladders.end(),
                         [](const auto& a, const auto& b) { return nameBefore(nameOf(a), nameOf(b)); });
    std::map<std::string, fs::path> known;
    for (const auto& ladder : ladders) {
        const auto name = nameOf(ladder);
        if (const auto [other, isNew] = known.emplace(name, ladder); !isNew)
            throw Error(Error::Kind::input,
                        "Two units are named '" + name + "': '" + other->second.parent_path().string() + "' and '"
                            + ladder.parent_path().string() + "'; rename one, or give one of them alone.");
        try {
            result.units.push_back({name, readLadder(ladder)});
        } catch (const Error& e) {
            if (!options.goOn)
                throw;
            result.unread.push_back({name, e.what()});
        }
    }
    if (result.units.empty())
        throw Error(Error::Kind::data,
                    "None of the ladders could be read; the first: "
                        + (result.unread.empty() ? std::string("there is none") : result.unread.front().why));
    return result;
}

}  // namespace excursion
