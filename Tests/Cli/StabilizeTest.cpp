// SPDX-License-Identifier: GPL-3.0-or-later
// Unstable linear models from the command line.
#include "Cli/Chain.h"

using namespace excursion::test;

namespace {

/// The identified model with a small unstable resonance beside it, (lambda - r)^2 + w^2, as noise would put there.
nlohmann::json spoiled(nlohmann::json model, double r, double w)
{
    const auto n = model.at("order").get<std::size_t>();
    for (auto& row : model.at("A"))
        row.insert(row.end(), {0.0, 0.0});
    for (const auto& pair : {std::pair {r, -w}, std::pair {w, r}}) {
        auto row = nlohmann::json::array();
        for (std::size_t k = 0; k < n; ++k)
            row.push_back(0.0);
        row.push_back(pair.first);
        row.push_back(pair.second);
        model.at("A").push_back(row);
    }
    model.at("B").push_back({r});
    model.at("B").push_back({0.0});
    model.at("C").at(0).push_back(0.002);
    model.at("C").at(0).push_back(0.001);
    model.at("order") = n + 2;
    return model;
}

}  // namespace

TEST_CASE("stabilize brings an unstable model back, by each of its methods, and tells every step")
{
    const Scratch scratch;
    const auto& chain = Chain::get();
    const auto identified = (scratch / "identified.json").string(), bad = (scratch / "bad.json").string(),
               out = (scratch / "good.json").string();
    const auto told = runProgram(scratch.folder(),
                                 {"identify", chain.take(), "--order", "3", "--out", identified, "--json"});
    REQUIRE(told.code == 0);
    const double best = nlohmann::json::parse(told.out).at("orders").at(0).at("weightedErrorDb");
    scratch.file("bad.json", spoiled(nlohmann::json::parse(bytesOf(identified)), 200.0, 3000.0).dump());

    for (const std::string method : {"mirror", "project", "delay"}) {
        const auto done = runProgram(
            scratch.folder(), {"stabilize", bad, "--method", method, "--frf", chain.take(), "--out", out, "--json"});
        INFO(method << ": " << done.err);
        REQUIRE(done.code == 0);
        const auto document = nlohmann::json::parse(done.out);
        CHECK(document.at("format") == "excursion-stabilization");
        CHECK(document.at("method") == method);
        CHECK(document.at("stable") == true);
        const auto& steps = document.at("steps");
        REQUIRE(steps.size() == (method == "delay" ? 2u : 3u));
        CHECK(steps.at(0).at("stable") == false);
        CHECK(steps.back().at("stable") == true);
        CHECK(steps.back().at("weightedErrorDb") < steps.at(0).at("weightedErrorDb"));
        // as well as the model that was never spoiled
        CHECK(steps.back().at("weightedErrorDb").get<double>() < best + 0.5);
        CHECK(nlohmann::json::parse(bytesOf(out)) == document.at("model"));
        CHECK(document.at("model").at("order") == (method == "project" ? 3 : 5));
        CHECK(document.at("delayStandardError").is_number() == (method == "delay"));
        if (method != "delay")
            CHECK_FALSE(document.at("model").contains("delay"));
        // What is stable already is left alone.
        const auto again = runProgram(scratch.folder(),
                                      {"stabilize", out, "--out", (scratch / "again.json").string(), "--json"});
        REQUIRE(again.code == 0);
        CHECK(nlohmann::json::parse(again.out).at("steps").size() == 1);
        CHECK(nlohmann::json::parse(again.out).at("model") == document.at("model"));
    }

    // A delay that is asked for is the delay that is kept.
    const auto given = runProgram(scratch.folder(), {"stabilize", bad, "--method", "delay", "--frf", chain.take(),
                                                     "--seconds", "2e-5", "--out", out, "--json"});
    REQUIRE(given.code == 0);
    CHECK(nlohmann::json::parse(given.out).at("delay") == 2e-5);
    CHECK(nlohmann::json::parse(bytesOf(out)).at("delay") == 2e-5);
}

TEST_CASE("stabilize decomposes a model into two that add up")
{
    const Scratch scratch;
    const auto& chain = Chain::get();
    const auto identified = (scratch / "identified.json").string(), bad = (scratch / "bad.json").string(),
               out = (scratch / "stable.json").string(), rest = (scratch / "unstable.json").string();
    REQUIRE(
        runProgram(scratch.folder(), {"identify", chain.take(), "--order", "3", "--quick", "--out", identified}).code
        == 0);
    const auto before = nlohmann::json::parse(bytesOf(identified));
    scratch.file("bad.json", spoiled(before, 200.0, 3000.0).dump());
    const auto done = runProgram(scratch.folder(), {"stabilize", bad, "--method", "decompose", "--frf", chain.take(),
                                                    "--unstable", rest, "--out", out, "--json"});
    INFO(done.err);
    REQUIRE(done.code == 0);
    const auto document = nlohmann::json::parse(done.out);
    CHECK(document.at("stable") == true);
    CHECK(document.at("model").at("order") == 3);
    CHECK(document.at("unstable").at("order") == 2);
    CHECK(nlohmann::json::parse(bytesOf(rest)) == document.at("unstable"));
    // The resonance was put beside the model, so its loss leaves the response of that model.
    const auto judged = runProgram(scratch.folder(), {"stabilize", identified, "--frf", chain.take(), "--out",
                                                      (scratch / "same.json").string(), "--json"});
    REQUIRE(judged.code == 0);
    CHECK(document.at("steps").at(1).at("errorDb").get<double>()
          == Approx(nlohmann::json::parse(judged.out).at("steps").at(0).at("errorDb").get<double>()).margin(1e-6));

    CHECK(runProgram(scratch.folder(), {"stabilize", bad, "--unstable", rest, "--out", out}).code == 2);
    CHECK(runProgram(scratch.folder(), {"stabilize", bad, "--seconds", "1e-5", "--out", out}).code == 2);
    CHECK(runProgram(scratch.folder(), {"stabilize", bad, "--method", "pray", "--out", out}).code == 2);
    CHECK(runProgram(scratch.folder(), {"stabilize", bad}).code == 2);
    CHECK(runProgram(scratch.folder(), {"stabilize", chain.model(), "--out", out}).code == 3);
}

TEST_CASE("reduce takes out poles and zeros within a ripple")
{
    const Scratch scratch;
    const auto& chain = Chain::get();
    const auto identified = (scratch / "identified.json").string(), small = (scratch / "small.json").string();
    REQUIRE(
        runProgram(scratch.folder(), {"identify", chain.take(), "--order", "7", "--quick", "--out", identified}).code
        == 0);
    const auto reduced = runProgram(
        scratch.folder(), {"reduce", identified, "--ripple", "6", "--band", "20,5000", "--out", small, "--json"});
    INFO(reduced.err);
    REQUIRE(reduced.code == 0);
    const auto told = nlohmann::json::parse(reduced.out);
    CHECK(told.at("method") == "poles-and-zeros");
    REQUIRE(told.at("steps").size() > 0);
    for (const auto& step : told.at("steps")) {
        CHECK(step.at("boundDb").get<double>() <= 6.0);
        CHECK(step.at("rippleDb").get<double>() <= step.at("boundDb").get<double>());
    }
    CHECK(told.at("order").get<int>() == told.at("steps").back().at("order").get<int>());
    CHECK(told.at("order").get<int>() < 7);
    CHECK(nlohmann::json::parse(bytesOf(small)) == told.at("model"));
    // continuous time, and no band
    CHECK(runProgram(scratch.folder(), {"reduce", identified, "--ripple", "1", "--out", small}).code == 2);
    CHECK(runProgram(scratch.folder(), {"reduce", identified, "--order", "3", "--band", "20,5000", "--out", small}).code
          == 2);
}
