// SPDX-License-Identifier: GPL-3.0-or-later
// How far the work is, for a program that reads it.
#include "Cli/Program.h"
#include "Scratch.h"

#include <nlohmann/json.hpp>

#include <regex>
#include <sstream>

using namespace excursion::test;

namespace {

Outcome measured(const Scratch& scratch, const std::vector<std::string>& options)
{
    std::vector<std::string> words {"virtual",
                                    "--seed",
                                    "1",
                                    "--hidden",
                                    "none",
                                    "--rate",
                                    "32000",
                                    "--seconds",
                                    "1",
                                    "--channels",
                                    "current",
                                    "--out",
                                    (scratch / "take").string(),
                                    "--json"};
    words.insert(words.end(), options.begin(), options.end());
    return runProgram(scratch.folder(), words);
}

}  // namespace

TEST_CASE("--progress tells the share that is done in lines, beside the document and with --quiet too", "[cli]")
{
    const Scratch scratch;
    const auto told = measured(scratch, {"--quiet", "--progress"});
    CHECK(told.code == 0);
    CHECK(nlohmann::json::parse(told.out).at("format") == "excursion-virtual");

    const std::regex form("progress ([01]\\.[0-9]{2}) (.+)");
    std::istringstream lines(told.err);
    std::string line, before;
    double share = 0.0;
    int count = 0;
    while (std::getline(lines, line)) {
        std::smatch parts;
        REQUIRE(std::regex_match(line, parts, form));
        CHECK(line != before);
        CHECK(std::stod(parts[1]) >= share);
        share = std::stod(parts[1]);
        before = line;
        ++count;
    }
    CHECK(count > 10);
    CHECK(share > 0.9);
}

TEST_CASE("Without --progress a program that reads stderr gets nothing there", "[cli]")
{
    const Scratch scratch;
    const auto told = measured(scratch, {});
    CHECK(told.code == 0);
    CHECK(told.err.empty());
}
