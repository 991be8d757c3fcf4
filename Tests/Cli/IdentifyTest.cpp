// SPDX-License-Identifier: GPL-3.0-or-later
// Linear models from the command line.
#include "Cli/Chain.h"

using namespace excursion::test;

TEST_CASE("identify chooses an order, keeps the model, and reads what bla wrote")
{
    const Scratch scratch;
    const auto& chain = Chain::get();
    const auto model = (scratch / "linear.json").string(), response = (scratch / "bla.json").string();
    const auto told = runProgram(scratch.folder(),
                                 {"identify", chain.take(), "--order", "2,3,4", "--out", model, "--json"});
    REQUIRE(told.code == 0);
    const auto document = nlohmann::json::parse(told.out);
    CHECK(document.at("format") == "excursion-identification");
    CHECK(document.at("orders").size() == 3);
    const auto& third = document.at("orders").at(1);
    CHECK(third.at("order") == 3);
    CHECK(third.at("weightedErrorDb") < document.at("orders").at(0).at("weightedErrorDb"));
    CHECK(third.at("stable") == true);
    const auto kept = nlohmann::json::parse(bytesOf(model));
    CHECK(kept == document.at("model"));
    CHECK(kept.at("A").size() == document.at("chosen"));

    REQUIRE(runProgram(scratch.folder(), {"bla", chain.take(), "--out", response}).code == 0);
    const auto again = runProgram(scratch.folder(), {"identify", response, "--order", "2,3,4", "--json"});
    REQUIRE(again.code == 0);
    CHECK(nlohmann::json::parse(again.out).at("model").at("A") == kept.at("A"));

    CHECK(runProgram(scratch.folder(), {"identify", response, "--order", "3", "--discrete"}).code == 2);
    CHECK(runProgram(scratch.folder(), {"identify", chain.take(), "--order", "3", "--output", "pressure"}).code == 2);
    CHECK(runProgram(scratch.folder(), {"identify", chain.take(), "--order", "3", "--band", "100,101"}).code == 4);
}

TEST_CASE("reduce truncates a model within its bound, and prunes one by a response")
{
    const Scratch scratch;
    const auto& chain = Chain::get();
    const auto large = (scratch / "large.json").string(), small = (scratch / "small.json").string();
    REQUIRE(runProgram(scratch.folder(), {"identify", chain.take(), "--order", "7", "--quick", "--out", large}).code
            == 0);
    const auto truncated = runProgram(scratch.folder(), {"reduce", large, "--order", "3", "--out", small, "--json"});
    INFO(truncated.err);
    REQUIRE(truncated.code == 0);
    const auto told = nlohmann::json::parse(truncated.out);
    CHECK(told.at("order") == 3);
    CHECK(told.at("stable") == true);
    CHECK(told.at("bound").get<double>() > 0.0);
    CHECK(nlohmann::json::parse(bytesOf(small)) == told.at("model"));
    const auto pruned = runProgram(
        scratch.folder(), {"reduce", large, "--order", "3", "--response", chain.take(), "--out", small, "--json"});
    REQUIRE(pruned.code == 0);
    CHECK(nlohmann::json::parse(pruned.out).at("order") == 3);
    CHECK(nlohmann::json::parse(pruned.out).at("steps").size() == 3);

    CHECK(runProgram(scratch.folder(), {"reduce", large, "--out", small}).code == 2);
    CHECK(runProgram(scratch.folder(), {"reduce", chain.model(), "--order", "2", "--out", small}).code == 3);
}

TEST_CASE("identify --cone tells motor and cone apart, the sound's way taken off")
{
    const Scratch scratch;
    const auto take = (scratch / "take").string(), kept = (scratch / "halves.json").string();
    const auto run = [&](std::vector<std::string> options) {
        options.insert(options.begin(), {"identify", take, "--order", "3", "--quick"});
        return runProgram(scratch.folder(), options);
    };
    REQUIRE(runProgram(scratch.folder(),
                       {"virtual", "--seed", "5", "--driver", "midbass", "--hidden", "none", "--rate", "32000",
                        "--noise", "-70", "--seconds", "2", "--channels", "displacement,pressure", "--out", take})
                .code
            == 0);
    const auto told = run({"--cone", "0", "--out", kept, "--json"});
    REQUIRE(told.code == 0);
    const auto document = nlohmann::json::parse(told.out);
    CHECK(document == nlohmann::json::parse(bytesOf(kept)));
    CHECK(document.at("format") == "excursion-motor-cone");
    // A piston's pressure is density area / (2 pi distance) times its acceleration.
    const auto header = nlohmann::json::parse(bytesOf(take + "/measurement.json"));
    const double area = header.at("driver").at("coneArea"), distance = header.at("driver").at("microphoneDistance");
    CHECK(document.at("delay") == Approx(distance / 343.0));
    CHECK(document.at("cone").at("D").at(0).at(0)
          == Approx(1.2 * area / (2.0 * 3.14159265358979 * distance)).epsilon(0.01));
    CHECK(document.at("motor").at("outputs").size() == 3);
    CHECK(document.at("motor").at("order") == 3);
    CHECK(document.at("cascade").at("delay") == Approx(-distance / 343.0));
    CHECK(document.at("errorDb") < -40.0);
    CHECK(document.at("stable") == true);

    const auto late = run({"--cone", "0", "--delay", "0", "--json"});
    REQUIRE(late.code == 0);
    CHECK(nlohmann::json::parse(late.out).at("errorDb") > document.at("errorDb").get<double>() + 10.0);
    REQUIRE(runProgram(scratch.folder(), {"report", kept}).code == 0);
    CHECK(bytesOf((scratch / "halves.html").string()).find("Motor and cone") != std::string::npos);

    CHECK(run({"--cone", "0", "--discrete"}).code == 2);
    CHECK(run({"--cone", "0", "--order", "4"}).code == 2);
    CHECK(run({"--delay", "0.001"}).code == 2);
    // without pressure
    CHECK(runProgram(scratch.folder(), {"identify", Chain::get().take(), "--order", "3", "--cone", "0"}).code == 2);
}
