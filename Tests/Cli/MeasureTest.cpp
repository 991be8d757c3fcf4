// SPDX-License-Identifier: GPL-3.0-or-later
// What `measure` refuses before it looks for a device; Tests/EndToEnd has what it does with one.
#include "Cli/Chain.h"

using namespace excursion::test;

TEST_CASE("A measurement that cannot become a take is refused before any device is asked", "[cli][bad-input]")
{
    const Scratch s;
    const auto plan = (s / "plan").string(), out = (s / "take").string();
    REQUIRE(runProgram(s.folder(), {"excite", "--out", plan, "--period", "4096", "--realizations", "1", "--quiet"}).code
            == 0);
    const auto refusedOf = [&](int code, const std::string& named, const std::vector<std::string>& more) {
        std::vector<std::string> words {"measure", "--plan", plan, "--out", out};
        words.insert(words.end(), more.begin(), more.end());
        refusedWith(code, words, s, named);
    };
    refusedWith(2, {"measure", "--out", out}, s, "--plan is missing");
    refusedWith(2, {"measure", "--plan", plan}, s, "--out is missing");
    refusedWith(3, {"measure", "--plan", (s / "nowhere").string(), "--out", out}, s, "nowhere");
    // a take of which nobody knows how it was played
    const auto silent = s.file("silent.csv", "time,voltage\n0,1\n0.001,2\n0.002,1\n0.003,2\n").string();
    refusedWith(4, {"measure", "--plan", silent, "--out", out, "--map", "1=voltage:3"}, s, "plan");
    refusedOf(2, "--map", {});
    refusedOf(2, "None of the channels is the voltage", {"--map", "1=current:4"});
    refusedOf(2, "mapped already", {"--map", "1=voltage:4", "--map", "1=current:4"});
    refusedOf(2, "voltage already", {"--map", "1=voltage:4", "--map", "2=voltage:4"});
    refusedOf(2, "--calibration", {"--map", "1=voltage"});
    refusedOf(2, "names a file", {"--map", "rec.wav:1=voltage:3"});
    refusedOf(2, "displacement=3mm", {"--map", "1=voltage:3", "--limit", "voltage"});
    refusedOf(2, "displacement=3mm", {"--map", "1=voltage:3", "--limit", "voltage=-3"});
    refusedOf(2, "displacement=3mm", {"--map", "1=voltage:3", "--limit", "voltage=3mm"});
    refusedOf(2, "no input is the current", {"--map", "1=voltage:3", "--limit", "current=3"});
    refusedOf(2, "--rise", {"--map", "1=voltage:3", "--rise", "0"});
    refusedOf(2, "--output", {"--map", "1=voltage:3", "--output", "0"});
    refusedOf(3, "cannot be written", {"--map", "1=voltage:3", "--recording", (s / "plan").string()});
}

TEST_CASE("The devices are listed, or it is told why there are none", "[cli]")
{
    const Scratch s;
    const auto listed = runProgram(s.folder(), {"measure", "--list", "--json"});
    if (listed.code == 3) {
        WARN("built without PortAudio: what it says is tested, nothing else");
        CHECK_THAT(listed.err, Catch::Contains("without PortAudio") && Catch::Contains("portaudio19-dev"));
        return;
    }
    REQUIRE(listed.code == 0);
    for (const auto& device : documentOf(listed, "excursion-devices").at("devices"))
        CHECK(device.at("inputs").get<int>() + device.at("outputs").get<int>() > 0);
    const auto doctor = documentOf(runProgram(s.folder(), {"doctor", "--json"}), "excursion-doctor");
    const auto& findings = doctor.at("findings");
    const auto audio = std::find_if(findings.begin(), findings.end(),
                                    [](const auto& f) { return f.at("id") == "audio"; });
    REQUIRE(audio != findings.end());
    CHECK_THAT(audio->at("found").get<std::string>(), Catch::Contains("PortAudio") && Catch::Contains("JACK"));
}
