// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Cli/Program.h"
#include "Engine/Take/WavFile.h"
#include "Scratch.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace excursion::test {

/// A folder with a short virtual take of a loudspeaker whose stiffness bends, and a linear model of it: made once for
/// all tests, which read it only.
class Chain {
public:
    static const Chain& get()
    {
        static const Chain chain;
        return chain;
    }

    const std::filesystem::path& folder() const { return scratch_.folder(); }
    std::string take() const { return (scratch_ / "take").string(); }
    std::string model() const { return (scratch_ / "model.json").string(); }
    const Outcome& fit() const { return fit_; }

private:
    Chain()
    {
        const auto measured = runProgram(folder(), {"virtual", "--seed", "3", "--driver", "midrange", "--hidden",
                                                    "stiffness:0.4", "--rate", "32000", "--noise", "-60", "--seconds",
                                                    "2", "--channels", "current,displacement", "--out", take()});
        REQUIRE(measured.code == 0);
        shorten();
        fit_ = runProgram(folder(), {"fit", take(), "--out", model(), "--json"});
        REQUIRE(fit_.code == 0);
    }

    /// Keeps the two louder levels and two realizations of each, as the tests have to be quick.
    void shorten()
    {
        const auto json = take() + "/measurement.json", audio = take() + "/take.wav";
        auto header = nlohmann::json::parse(bytesOf(json));
        auto& plan = header.at("excitation");
        const auto realizations = plan.at("realizations").get<std::size_t>(), levels = plan.at("levels").size();
        const auto block = plan.at("period").get<std::size_t>()
                           * (plan.at("settlePeriods").get<std::size_t>() + plan.at("periods").get<std::size_t>());
        auto wav = readWav(audio);
        for (auto& channel : wav.channels) {
            std::vector<double> kept;
            for (std::size_t level = levels - 2; level < levels; ++level) {
                const auto begin = channel.begin() + static_cast<std::ptrdiff_t>(level * realizations * block);
                kept.insert(kept.end(), begin, begin + static_cast<std::ptrdiff_t>(2 * block));
            }
            channel = std::move(kept);
        }
        writeWav(audio, wav.sampleRate, wav.channels, SampleFormat::float32);
        plan["levels"].erase(plan["levels"].begin(), plan["levels"].end() - 2);
        plan["realizations"] = 2;
        std::ofstream(json) << header.dump(2);
    }

    Scratch scratch_;
    Outcome fit_;
};

/// The document on stdout; it must name its format and be of version 1.
inline nlohmann::json documentOf(const Outcome& outcome, const std::string& format)
{
    INFO(outcome.err);
    const auto document = nlohmann::json::parse(outcome.out);
    CHECK(document.at("format") == format);
    CHECK(document.at("version") == 1);
    return document;
}

/// One sentence on stderr, nothing on stdout, nothing written.
inline void refusedWith(int code, const std::vector<std::string>& arguments, const Scratch& scratch,
                        const std::string& named)
{
    std::string line;
    for (const auto& argument : arguments)
        line += argument + " ";
    INFO(line);
    const auto before = contents(scratch.folder());
    const auto told = runProgram(scratch.folder(), arguments);
    INFO("stderr: " << told.err);
    CHECK(told.code == code);
    CHECK(told.out.empty());
    CHECK_THAT(told.err, Catch::StartsWith("excursion: ") && Catch::EndsWith("\n") && Catch::Contains(named));
    CHECK(std::count(told.err.begin(), told.err.end(), '\n') == 1);
    CHECK(contents(scratch.folder()) == before);
}

}  // namespace excursion::test
