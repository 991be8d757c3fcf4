// SPDX-License-Identifier: GPL-3.0-or-later
// The verbs one after the other on a virtual take, as a user would run them.
#include "Cli/Chain.h"

#include "Engine/Take/WavFile.h"

using namespace excursion::test;

namespace fs = std::filesystem;

TEST_CASE("fit writes a linear model and tells its errors", "[cli]")
{
    const auto& chain = Chain::get();
    const auto document = documentOf(chain.fit(), "excursion-fit");
    CHECK(document.at("effects").empty());
    CHECK(document.at("error").at("current").at("db").get<double>() > -50.0);
    CHECK(document.at("parameters").at(0).at("name") == "Re");
    const auto model = nlohmann::json::parse(bytesOf(chain.model()));
    CHECK(model.at("format") == "excursion-model");
    CHECK(model.at("version") == 1);
}

TEST_CASE("compare tells the error by channel and level, for a person and for a program", "[cli]")
{
    const auto& chain = Chain::get();
    const Scratch scratch;
    const auto file = (scratch / "comparison.json").string();
    const auto told = runProgram(scratch.folder(), {"compare", chain.take(), "--model", chain.model(), "--json", file});
    CHECK(told.code == 0);
    CHECK(told.err.empty());
    for (const auto* text :
         {"channel", "V rms", "current", "displacement", "noise dB", "odd dB", "octave Hz", "force over x"})
        CHECK_THAT(told.out, Catch::Contains(text));
    const auto document = nlohmann::json::parse(bytesOf(file));
    CHECK(document.at("format") == "excursion-comparison");
    CHECK(document.at("version") == 1);
    CHECK(document.at("channels").size() == 2);
    CHECK(document.at("levels").size() == 2);
}

TEST_CASE("diagnose names the hidden effect", "[cli]")
{
    const auto& chain = Chain::get();
    const Scratch scratch;
    const auto told = runProgram(scratch.folder(), {"diagnose", chain.take(), "--model", chain.model(), "--json"});
    CHECK(told.code == 0);
    CHECK(told.err.empty());
    const auto document = documentOf(told, "excursion-diagnosis");
    CHECK(document.at("verdict") == "missing-effect");
    const auto& first = document.at("ranking").at(0);
    CHECK(first.at("effect") == "stiffness");
    CHECK(first.at("confidence").get<double>() > 0.9);
    CHECK(first.at("confirmedErrorDb").at("current").get<double>()
          < document.at("error").at("current").at("db").get<double>() - 10.0);
    CHECK_FALSE(first.at("reason").get<std::string>().empty());
}

TEST_CASE("add puts an effect into the model; simulate plays it; the two agree", "[cli]")
{
    const auto& chain = Chain::get();
    const Scratch scratch;
    const auto model = (scratch / "better.json").string(), played = (scratch / "played").string();
    const auto added = runProgram(
        scratch.folder(), {"add", chain.take(), "--model", chain.model(), "stiffness", "--out", model, "--json"});
    REQUIRE(added.code == 0);
    const auto document = documentOf(added, "excursion-add");
    CHECK(document.at("effects") == nlohmann::json {"stiffness"});
    const auto error = document.at("error").at("current");
    CHECK(error.at("db").get<double>() < error.at("noiseFloorDb").get<double>() + 1.0);

    const auto simulated = runProgram(scratch.folder(), {"simulate", model, chain.take(), "--out", played, "--json"});
    REQUIRE(simulated.code == 0);
    const auto summary = documentOf(simulated, "excursion-simulate");
    CHECK(summary.at("converged") == true);
    CHECK(summary.at("accuracy").get<double>() <= summary.at("tolerance").get<double>());
    const auto take = nlohmann::json::parse(bytesOf(fs::path(played) / "measurement.json"));
    CHECK(take.at("channels").size() == 6);
    CHECK(take.at("excitation").at("realizations") == 2);
}

TEST_CASE("whatif tells the distortion that was measured, and whose it is", "[cli]")
{
    const auto& chain = Chain::get();
    const Scratch scratch;
    const auto model = (scratch / "better.json").string();
    REQUIRE(
        runProgram(scratch.folder(), {"add", chain.take(), "--model", chain.model(), "stiffness", "--out", model}).code
        == 0);
    const auto told = runProgram(scratch.folder(), {"whatif", model, chain.take(), "--json"});
    REQUIRE(told.code == 0);
    const auto document = documentOf(told, "excursion-whatif");
    const auto measured = documentOf(
        runProgram(scratch.folder(), {"bla", chain.take(), "--output", "current", "--json"}), "excursion-bla");
    for (const auto& channel : document.at("whole"))
        // which holds little below the band, where detection lines do not reach
        if (channel.at("channel") == "current") {
            CHECK(channel.at("oddDb").get<double>() == Approx(measured.at("odd").at("db").get<double>()).margin(1.0));
            CHECK(channel.at("evenDb").get<double>() == Approx(measured.at("even").at("db").get<double>()).margin(1.0));
        }
    REQUIRE(document.at("effects").size() == 1);
    for (const auto& channel : document.at("effects").at(0).at("without"))
        CHECK(channel.at("oddDb") == -120.0);
    CHECK_THAT(document.at("advice").get<std::string>(), Catch::Contains("All of it is made by: Stiffness K(x)"));

    const auto person = runProgram(scratch.folder(), {"whatif", model, chain.take()});
    for (const auto* text :
         {"Stimulus: the loudest", "without stiffness", "compliance 1/K(x) falls to 75 %", "All of it"})
        CHECK_THAT(person.out, Catch::Contains(text));
}

TEST_CASE("simulate plays a WAV at a full scale", "[cli]")
{
    const auto& chain = Chain::get();
    const Scratch scratch;
    const auto plan = (scratch / "plan").string(), played = (scratch / "played").string();
    REQUIRE(runProgram(scratch.folder(), {"excite", "--out", plan, "--period", "2048", "--rate", "16000", "--band",
                                          "30,5000", "--levels", "1"})
                .code
            == 0);
    const auto wav = plan + "/excitation.wav";
    const auto unscaled = runProgram(scratch.folder(), {"simulate", chain.model(), wav, "--out", played});
    CHECK(unscaled.code == 2);
    CHECK_THAT(unscaled.err, Catch::Contains("--full-scale"));
    const auto told = runProgram(scratch.folder(),
                                 {"simulate", chain.model(), wav, "--full-scale", "4", "--out", played});
    CHECK(told.code == 0);
    for (const auto* text : {"displacement", "pressure", "a sample", "Wrote the take"})
        CHECK_THAT(told.out, Catch::Contains(text));
    CHECK(runProgram(scratch.folder(), {"check", played}).code == 0);
}

TEST_CASE("improve shows the ladder while it grows, and keeps it", "[cli]")
{
    const auto& chain = Chain::get();
    const Scratch scratch;
    const auto folder = (scratch / "ladder").string();
    const auto told = runProgram(scratch.folder(), {"improve", chain.take(), "--out", folder}, "linear model");
    REQUIRE(told.code == 0);
    CHECK(told.err.empty());  // no bar where stderr is no terminal
    CHECK(told.spokeEarly);
    std::size_t at = 0;
    for (const auto* text :
         {"noise floor", "0  linear model", "missing: stiffness", "1  + stiffness", "verdict  complete", "Wrote"}) {
        INFO(text << " in\n" << told.out);
        at = told.out.find(text, at);
        REQUIRE(at != std::string::npos);
    }
    const auto ladder = nlohmann::json::parse(bytesOf(fs::path(folder) / "ladder.json"));
    CHECK(ladder.at("format") == "excursion-ladder");
    CHECK(ladder.at("verdict") == "complete");
    REQUIRE(ladder.at("rungs").size() == 2);
    CHECK(ladder.at("rungs").at(0).at("added").is_null());
    CHECK(ladder.at("rungs").at(1).at("added") == "stiffness");
    CHECK(nlohmann::json::parse(bytesOf(fs::path(folder) / "model.json")).at("format") == "excursion-model");

    const auto page = fs::path(folder) / "report.html";
    const auto before = bytesOf(page);
    fs::remove(page);
    const auto again = runProgram(scratch.folder(), {"report", folder, "--json"});
    CHECK(again.code == 0);
    CHECK(documentOf(again, "excursion-report").at("verdict") == "complete");
    CHECK((bytesOf(page) == before));  // without printing both when not
}

TEST_CASE("effects lists the catalogue, and help is a tour", "[cli]")
{
    const Scratch scratch;
    const auto document = documentOf(runProgram(scratch.folder(), {"effects", "--json"}), "excursion-effects");
    CHECK(document.at("effects").size() >= 6);
    for (const auto& effect : document.at("effects")) {
        CHECK_FALSE(effect.at("physics").get<std::string>().empty());
        CHECK_FALSE(effect.at("parameters").empty());
    }
    CHECK_THAT(runProgram(scratch.folder(), {"effects", "stiffness"}).out,
               Catch::StartsWith("stiffness") && Catch::Contains("K(x) in N/m"));

    const auto help = runProgram(scratch.folder(), {"--help"});
    CHECK(help.code == 0);
    std::size_t at = 0;
    for (const auto* verb : {"\n  excite ", "\n  import ", "\n  virtual ", "\n  check ", "\n  bla ", "\n  fit ",
                             "\n  compare ", "\n  diagnose ", "\n  add ", "\n  improve ", "\n  report ", "\n  effects ",
                             "\n  simulate ", "\n  predistort "}) {
        INFO(verb);
        at = help.out.find(verb, at);
        REQUIRE(at != std::string::npos);
    }
}

TEST_CASE("A take at fault is refused by name, and the answer is no", "[cli]")
{
    const auto& chain = Chain::get();
    const Scratch scratch;
    const auto take = (scratch / "dead").string(), out = (scratch / "model.json").string(),
               folder = (scratch / "ladder").string();
    fs::copy(chain.take(), take, fs::copy_options::recursive);
    auto wav = excursion::readWav(take + "/take.wav");
    for (auto& sample : wav.channels[2])
        sample = 0.0;
    excursion::writeWav(take + "/take.wav", wav.sampleRate, wav.channels, excursion::SampleFormat::float32);

    const auto fitted = runProgram(scratch.folder(), {"fit", take, "--out", out, "--json"});
    CHECK(fitted.code == 1);
    const auto document = documentOf(fitted, "excursion-fit");
    CHECK(document.at("verdict") == "bad-measurement");
    CHECK(document.at("problems").at(0).at("channel") == "displacement");
    CHECK_FALSE(fs::exists(out));
    CHECK(runProgram(scratch.folder(), {"add", take, "--model", chain.model(), "stiffness", "--out", out}).code == 1);
    CHECK_FALSE(fs::exists(out));

    const auto diagnosed = runProgram(scratch.folder(), {"diagnose", take, "--model", chain.model(), "--json"});
    CHECK(diagnosed.code == 1);
    CHECK(documentOf(diagnosed, "excursion-diagnosis").at("verdict") == "bad-measurement");
    const auto improved = runProgram(scratch.folder(), {"improve", take, "--out", folder, "--json"});
    CHECK(improved.code == 1);
    CHECK(documentOf(improved, "excursion-ladder").at("rungs").empty());
    CHECK(fs::exists(folder + "/report.html"));
    CHECK_FALSE(fs::exists(folder + "/model.json"));
}
