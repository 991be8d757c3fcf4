// SPDX-License-Identifier: GPL-3.0-or-later
// Polynomial state-space models from the command line.
#include "Cli/Chain.h"

using namespace excursion::test;

TEST_CASE("pnlss explains more than its linear start, keeps the model, and judges and plays it again")
{
    const Scratch scratch;
    const auto& chain = Chain::get();
    const auto model = (scratch / "pnlss.json").string(), played = (scratch / "played").string();
    const auto told = runProgram(
        scratch.folder(), {"pnlss", chain.take(), "--order", "3", "--iterations", "8", "--out", model, "--json"});
    INFO(told.err);
    REQUIRE(told.code == 0);
    const auto document = nlohmann::json::parse(told.out);
    CHECK(document.at("format") == "excursion-pnlss-fit");
    CHECK(document.at("stable") == true);
    const auto& history = document.at("history");
    CHECK(history.back().get<double>() < history.front().get<double>() - 10.0);
    CHECK(nlohmann::json::parse(bytesOf(model)) == document.at("model"));

    const auto judged = runProgram(scratch.folder(),
                                   {"pnlss", chain.take(), "--model", model, "--played", played, "--json"});
    REQUIRE(judged.code == 0);
    CHECK(nlohmann::json::parse(judged.out).at("estimationDb").get<double>()
          == Approx(document.at("estimationDb").get<double>()).epsilon(1e-9));
    CHECK(nlohmann::json::parse(judged.out).at("validationDb").get<double>()
          == Approx(document.at("validationDb").get<double>()).epsilon(1e-9));
    CHECK(runProgram(scratch.folder(), {"check", played}).code <= 1);  // a take that can be read

    const auto few = runProgram(scratch.folder(), {"pnlss", chain.take(), "--order", "3", "--iterations", "2",
                                                   "--terms", "x1^2,x1^3,1", "--json"});
    REQUIRE(few.code == 0);
    const auto terms = nlohmann::json::parse(few.out).at("model").at("terms");
    REQUIRE(terms.size() == 3);
    CHECK(terms.at(1).at("exponents") == nlohmann::json({3, 0, 0, 0}));
    CHECK(runProgram(scratch.folder(), {"pnlss", chain.take(), "--order", "3", "--terms", "x4^2"}).code == 2);
    CHECK(runProgram(scratch.folder(), {"pnlss", chain.take(), "--order", "3", "--terms", "x1^2", "--mask", "diagonal"})
              .code
          == 2);

    CHECK(runProgram(scratch.folder(), {"pnlss", chain.take()}).code == 2);
    CHECK(runProgram(scratch.folder(), {"pnlss", chain.take(), "--order", "3", "--mask", "odd"}).code == 2);
    CHECK(runProgram(scratch.folder(), {"pnlss", chain.take(), "--order", "3", "--level", "7"}).code == 2);
    CHECK(runProgram(scratch.folder(), {"pnlss", chain.take(), "--model", chain.model()}).code == 3);
}

TEST_CASE("pnlss of fractional order explains a take, keeps the model with its order, and judges and plays it again")
{
    const Scratch scratch;
    const auto& chain = Chain::get();
    const auto model = (scratch / "fractional.json").string(), played = (scratch / "played").string();
    const auto told = runProgram(scratch.folder(),
                                 {"pnlss", chain.take(), "--output", "current", "--alpha", "0.95", "--mixed", "--mask",
                                  "states-only", "--iterations", "4", "--out", model, "--json"});
    INFO(told.err);
    REQUIRE(told.code == 0);
    const auto document = nlohmann::json::parse(told.out);
    CHECK(document.at("history").back().get<double>() < document.at("history").front().get<double>() - 6.0);
    CHECK(nlohmann::json::parse(bytesOf(model)) == document.at("model"));
    CHECK(document.at("model").at("alpha") == 0.95);

    const auto judged = runProgram(scratch.folder(),
                                   {"pnlss", chain.take(), "--model", model, "--played", played, "--json"});
    REQUIRE(judged.code == 0);
    CHECK(nlohmann::json::parse(judged.out).at("estimationDb").get<double>()
          == Approx(document.at("estimationDb").get<double>()).epsilon(1e-9));
    CHECK(runProgram(scratch.folder(), {"check", played}).code <= 1);

    auto broken = nlohmann::json::parse(bytesOf(model));
    broken["alpha"] = 1.5;
    std::ofstream(scratch / "broken.json") << broken;
    CHECK(runProgram(scratch.folder(), {"pnlss", chain.take(), "--model", (scratch / "broken.json").string()}).code
          == 3);
    broken = nlohmann::json::parse(bytesOf(model));
    broken["fractional"] = {true, true};
    std::ofstream(scratch / "broken.json") << broken;
    CHECK(runProgram(scratch.folder(), {"pnlss", chain.take(), "--model", (scratch / "broken.json").string()}).code
          == 3);
    // This driver's coil is one of whole order.
    const auto whole = runProgram(scratch.folder(),
                                  {"pnlss", chain.take(), "--output", "current", "--alpha", "free", "--mixed"});
    CHECK(whole.code == 4);
    CHECK(whole.err.find("integer order") != std::string::npos);
    CHECK(runProgram(scratch.folder(), {"pnlss", chain.take(), "--mixed"}).code == 2);
    CHECK(runProgram(scratch.folder(), {"pnlss", chain.take(), "--mixed", "--alpha", "much"}).code == 2);
    CHECK(runProgram(scratch.folder(), {"pnlss", chain.take(), "--order", "3", "--alpha", "1.2"}).code == 2);
}
