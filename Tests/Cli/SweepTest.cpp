// SPDX-License-Identifier: GPL-3.0-or-later
// From a plan of sweeps to curves of harmonics, a page and a model that is played.
#include "Cli/Chain.h"

#include <cmath>
#include <limits>
#include <map>

using namespace excursion;
using namespace excursion::test;
using Json = nlohmann::json;

namespace fs = std::filesystem;

namespace {

/// A plan of short sweeps, and what a virtual loudspeaker whose stiffness bends makes of it: once for all tests.
class Swept {
public:
    static const Swept& get()
    {
        static const Swept swept;
        return swept;
    }
    std::string plan() const { return (scratch_ / "plan").string(); }
    std::string take() const { return (scratch_ / "take").string(); }

private:
    Swept()
    {
        const auto planned = runProgram(scratch_.folder(), {"excite", "--sweep", "--band", "25,2500", "--seconds", "2",
                                                            "--silence", "0.5", "--fades", "0.05,0.005", "--levels",
                                                            "0.5,2", "--rate", "32000", "--out", plan(), "--json"});
        REQUIRE(planned.code == 0);
        const auto document = Json::parse(planned.out);
        CHECK(document.at("kind") == "sweep");
        const auto measured = runProgram(scratch_.folder(),
                                         {"virtual", "--seed", "3", "--driver", "midrange", "--hidden", "stiffness:0.4",
                                          "--noise", "-70", "--channels", "current,displacement", "--plan", plan(),
                                          "--out", take()});
        INFO(measured.err);
        REQUIRE(measured.code == 0);
    }
    Scratch scratch_;
};

/// Of a take, in m.
std::vector<double> displacementOf(const std::string& folder)
{
    const auto header = Json::parse(bytesOf(folder + "/measurement.json"));
    const auto& channels = header.at("channels");
    auto wav = readWav(folder + "/take.wav");
    for (std::size_t c = 0; c < channels.size(); ++c)
        if (channels[c].at("quantity") == "displacement") {
            for (double& x : wav.channels[c])
                x *= channels[c].at("fullScale").get<double>();
            return wav.channels[c];
        }
    return {};
}

/// The first number of a curve that is known, NaN without any.
double anyOf(const Json& curve)
{
    for (const auto& value : curve)
        if (value.is_number())
            return value.get<double>();
    return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

TEST_CASE("A take of sweeps has harmonics, a table, a page and a model that simulate plays", "[cli]")
{
    const auto& swept = Swept::get();
    const Scratch scratch;
    const auto csv = (scratch / "curves.csv").string(), model = (scratch / "model.json").string(),
               said = (scratch / "said.json").string(), played = (scratch / "played").string();
    const auto found = runProgram(scratch.folder(), {"harmonics", swept.take(), "--highest", "3", "--output",
                                                     "displacement", "--out", csv, "--model", model, "--json", said});
    INFO(found.err);
    REQUIRE(found.code == 0);
    CHECK(found.out.find("H3 dB") != std::string::npos);
    const auto document = Json::parse(bytesOf(said));
    CHECK(document.at("format") == "excursion-harmonics");
    REQUIRE(document.at("curves").size() == 2);
    CHECK(document.at("curves")[0].at("channel") == "displacement");
    // The stiffness bends: a louder cone has more harmonics
    const auto& loud = document.at("curves")[1];
    CHECK(anyOf(loud.at("thd").at("db")) > -60.0);
    CHECK(document.at("model").at("errorDb").size() == 2);
    CHECK(document.at("model").at("errorDb")[1].get<double>() < -20.0);
    CHECK(bytesOf(csv).find("displacement,") != std::string::npos);

    const auto simulated = runProgram(scratch.folder(), {"simulate", model, swept.plan(), "--out", played, "--json"});
    INFO(simulated.err);
    REQUIRE(simulated.code == 0);
    const auto header = Json::parse(bytesOf(played + "/measurement.json"));
    CHECK(header.at("excitation").at("kind") == "sweep");
    CHECK(header.at("channels")[1].at("quantity") == "displacement");
    const auto again = runProgram(scratch.folder(), {"harmonics", played, "--highest", "3", "--json"});
    REQUIRE(again.code == 0);
    // The model has the harmonics of what it was made of
    const auto saidAgain = Json::parse(again.out);
    const auto& curves = saidAgain.at("curves");
    const auto &truth = loud.at("harmonics")[1].at("db"), &modelled = curves.back().at("harmonics")[1].at("db");
    int compared = 0;
    for (std::size_t i = 0; i < truth.size(); ++i)
        if (truth[i].is_number() && truth[i].get<double>() > -60.0 && loud.at("frequency")[i].get<double>() > 80.0) {
            ++compared;
            REQUIRE(modelled[i].is_number());
            CHECK(modelled[i].get<double>() == Approx(truth[i].get<double>()).margin(2.0));
        }
    CHECK(compared > 3);

    const auto other = (scratch / "other").string();
    REQUIRE(
        runProgram(scratch.folder(), {"excite", "--sweep", "--seconds", "1", "--rate", "48000", "--out", other}).code
        == 0);
    refusedWith(4, {"simulate", model, other, "--out", (scratch / "no").string()}, scratch, "48000 Hz");
    if (runProgram(scratch.folder(), {"report", said}).code == 0)  // gnuplot may be missing
        CHECK(bytesOf(scratch / "said.html").find("Harmonics of the displacement") != std::string::npos);
}

TEST_CASE("A take of sweeps goes through the other verbs as an aperiodic one", "[cli]")
{
    const auto& swept = Swept::get();
    const Scratch scratch;
    const auto checked = runProgram(scratch.folder(), {"check", swept.take(), "--json"});
    INFO(checked.out << checked.err);
    CHECK(checked.code == 0);
    const auto response = runProgram(scratch.folder(), {"bla", swept.take(), "--json"});
    REQUIRE(response.code == 0);
    CHECK(Json::parse(response.out).at("method") == "welch");
    const auto model = (scratch / "linear.json").string();
    const auto fitted = runProgram(scratch.folder(), {"fit", swept.take(), "--out", model, "--json"});
    INFO(fitted.err);
    CHECK(fitted.code == 0);
}

TEST_CASE("A recording of sweeps becomes a take that knows them", "[cli]")
{
    const auto& swept = Swept::get();
    const Scratch scratch;
    const auto header = Json::parse(bytesOf(swept.take() + "/measurement.json"));
    auto wav = readWav(swept.take() + "/take.wav");
    for (auto& channel : wav.channels) {
        channel.insert(channel.begin(), 4321, 0.0);
        channel.resize(channel.size() + 3000, 0.0);
    }
    const auto recording = (scratch / "rec.wav").string(), out = (scratch / "take").string();
    writeWav(recording, wav.sampleRate, wav.channels, SampleFormat::float32);
    std::vector<std::string> arguments {"import", recording, "--plan", swept.plan(), "--out", out, "--json"};
    for (std::size_t c = 0; c < wav.channels.size(); ++c) {
        const auto& channel = header.at("channels")[c];
        arguments.push_back("--map");
        arguments.push_back(std::to_string(c + 1) + "=" + channel.at("quantity").get<std::string>() + ":"
                            + std::to_string(channel.at("fullScale").get<double>()));
    }
    const auto imported = runProgram(scratch.folder(), arguments);
    INFO(imported.err);
    REQUIRE(imported.code == 0);
    CHECK(Json::parse(imported.out).at("files")[0].at("start").get<double>() == Approx(4321.0).margin(0.01));
    const auto sweeps = Json::parse(bytesOf(out + "/measurement.json")).at("excitation");
    CHECK(sweeps.at("kind") == "sweep");
    CHECK(sweeps.at("levels")[1].get<double>() == Approx(2.0).epsilon(0.01));
    CHECK(sweeps.at("seconds") == header.at("excitation").at("seconds"));
}

TEST_CASE("A take of sweeps that is imported again keeps its sweeps", "[cli]")
{
    const Scratch scratch;
    const auto& swept = Swept::get();
    const auto out = (scratch / "again").string();
    REQUIRE(runProgram(scratch.folder(), {"import", swept.take(), "--name", "another", "--out", out}).code == 0);
    const auto before = Json::parse(bytesOf(swept.take() + "/measurement.json")),
               after = Json::parse(bytesOf(out + "/measurement.json"));
    CHECK(after.at("excitation") == before.at("excitation"));
    CHECK(after.at("driver").at("name") == "another");
}

TEST_CASE("rank keeps the model of each class as its document, which simulate plays", "[cli]")
{
    const Scratch scratch;
    const auto kept = (scratch / "kept").string();
    const auto ranked = runProgram(scratch.folder(),
                                   {"rank", Chain::get().take(), "--output", "displacement", "--classes",
                                    "linear,hammerstein,narx,driver", "--iterations", "3", "--keep", kept, "--json"});
    INFO(ranked.err);
    REQUIRE(ranked.code == 0);
    const auto document = Json::parse(ranked.out);
    CHECK(document.contains("best"));
    CHECK_FALSE(document.at("linearizationSentence").get<std::string>().empty());
    CHECK(document.contains("linearizesBest"));
    const std::map<std::string, std::string> formats {{"linear", "excursion-state-space"},
                                                      {"hammerstein", "excursion-parallel-hammerstein"},
                                                      {"narx", "excursion-narx"},
                                                      {"driver", "excursion-model"}};
    const auto truth = displacementOf(Chain::get().take());
    for (const auto& model : document.at("models")) {
        const auto name = model.at("class").get<std::string>();
        INFO(name);
        REQUIRE_FALSE(model.contains("trouble"));
        const auto& bent = model.at("linearization");
        if (bent.contains("trouble"))
            CHECK_FALSE(bent.at("trouble").get<std::string>().empty());
        else
            CHECK(bent.at("leftDb").get<double>() < bent.at("beforeDb").get<double>() - 3.0);
        const auto path = model.at("kept").get<std::string>();
        CHECK(Json::parse(bytesOf(path)).at("format") == formats.at(name));
        if (!model.at("stable").get<bool>())
            continue;  // it may run away
        const auto out = (scratch / name).string();
        const auto played = runProgram(scratch.folder(), {"simulate", path, Chain::get().take(), "--out", out});
        INFO(played.err);
        REQUIRE(played.code == 0);
        // What it plays is what was measured, as far as it claims to: at the end of the loudest level, which judged it.
        const auto found = displacementOf(out);
        REQUIRE(found.size() == truth.size());
        double error = 0.0, power = 0.0;
        for (std::size_t n = 7 * truth.size() / 8; n < truth.size(); ++n) {
            error += (found[n] - truth[n]) * (found[n] - truth[n]);
            power += truth[n] * truth[n];
        }
        CHECK(10.0 * std::log10(error / power) < model.at("validationDb").get<double>() + 6.0);
    }
}

TEST_CASE("What sweeps cannot do is refused in one sentence", "[cli][bad-input]")
{
    const auto& swept = Swept::get();
    const Scratch scratch;
    const auto out = (scratch / "out").string();
    refusedWith(2, {"excite", "--sweep", "--periods", "3", "--out", out}, scratch, "--periods");
    refusedWith(2, {"excite", "--seconds", "3", "--out", out}, scratch, "--sweep");
    refusedWith(2, {"excite", "--sweep", "--band", "20,30000", "--out", out}, scratch, "half the sample rate");
    refusedWith(2, {"excite", "--sweep", "--full-scale", "1", "--out", out}, scratch, "--full-scale");
    refusedWith(2, {"harmonics", swept.take(), "--output", "torque"}, scratch, "torque");
    refusedWith(2, {"harmonics", swept.take(), "--out", out + ".txt"}, scratch, ".csv");
    refusedWith(2, {"harmonics", swept.take(), "--level", "7"}, scratch, "levels");
    refusedWith(4, {"harmonics", swept.take(), "--highest", "20"}, scratch, "too short");
    refusedWith(4, {"harmonics", Chain::get().take()}, scratch, "--sweep");
    refusedWith(2, {"virtual", "--seed", "1", "--plan", swept.plan(), "--rate", "48000", "--out", out}, scratch,
                "--rate");
}
