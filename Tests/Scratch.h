// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Error.h"

#include <catch2/catch.hpp>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace excursion::test {

/// A folder of its own for one test, with a non-ASCII name, gone at its end.
class Scratch {
public:
    Scratch()
    {
        static int count = 0;
        do
            folder_ = std::filesystem::temp_directory_path()
                      / ("excursion m\u00e4\u00df \u97f3 " + std::to_string(++count));
        while (!std::filesystem::create_directory(folder_));
    }
    ~Scratch()
    {
        std::error_code ignored;
        std::filesystem::remove_all(folder_, ignored);
    }
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;

    std::filesystem::path operator/(const std::string& name) const { return folder_ / name; }
    const std::filesystem::path& folder() const { return folder_; }

    std::filesystem::path file(const std::string& name, std::string_view bytes) const
    {
        std::ofstream(folder_ / name, std::ios::binary) << bytes;
        return folder_ / name;
    }

private:
    std::filesystem::path folder_;
};

inline std::string bytesOf(const std::filesystem::path& path)
{
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// Runs something that must throw Error of a kind, with a sentence that contains a text.
template <class Work>
void refused(Error::Kind kind, const std::string& contains, Work work)
{
    try {
        work();
        FAIL("nothing was refused, expected: " << contains);
    } catch (const Error& e) {
        INFO(e.what());
        CHECK(e.kind() == kind);
        CHECK_THAT(e.what(), Catch::Contains(contains));
    }
}

/// The folder of real data; empty, with a visible warning, where it is absent.
inline std::filesystem::path dataFolder(const std::string& set)
{
    const char* given = std::getenv("EXCURSION_DATA");
    const auto folder = std::filesystem::path(given ? given : "../shared/data") / set;
    if (std::filesystem::is_directory(folder))
        return folder;
    WARN("skipped: there is no real data in '" << folder.string() << "'; set EXCURSION_DATA");
    return {};
}

}  // namespace excursion::test
