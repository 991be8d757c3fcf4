// SPDX-License-Identifier: GPL-3.0-or-later
// Polynomial state-space models from the command line.
#include "Cli/Chain.h"
#include "Engine/Take/TakeFile.h"
#include "Linear/Problem.h"

#include <sstream>

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
    // The linear start is at the distortion: two realizations weigh its lines by a noise that many lines tell together.
    CHECK(history.front().get<double>() < -45.0);
    CHECK(history.back().get<double>() < history.front().get<double>() - 5.0);
    CHECK(history.back().get<double>() < -54.0);
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

TEST_CASE("pnlss of one record arrives at its noise or says that it did not, and sets out from a model that was kept")
{
    const Scratch scratch;
    // A resonance with a hardening spring, from rest, driven by noise, and heard with noise 60 dB below
    std::ostringstream csv;
    csv.precision(12);
    csv << "time,voltage,displacement\n";
    Normal normal(11);
    double x = 0.0, v = 0.0;
    for (int t = 0; t < 1800; ++t) {
        const double u = normal();
        csv << t / 1000.0 << ',' << u << ',' << x + 6e-4 * normal() << '\n';
        const double next = x + 0.3 * v;
        v = 0.8 * v - 0.3 * x - 0.05 * x * x * x + 0.2 * u;
        x = next;
    }
    const auto take = (scratch / "record.csv").string(), kept = (scratch / "kept.json").string();
    std::ofstream(take) << csv.str();

    const auto told = runProgram(scratch.folder(), {"pnlss", take, "--order", "2", "--out", kept, "--json"});
    INFO(told.err);
    REQUIRE(told.code == 0);
    const auto fit = nlohmann::json::parse(told.out);
    INFO(told.out.substr(0, 600));
    CHECK(fit.at("arrived") == true);
    CHECK(fit.at("advice").is_null());
    CHECK(fit.at("noiseFrom") == "residual");
    CHECK(fit.at("estimationDb").get<double>() == Approx(fit.at("noiseDb").get<double>()).margin(3.0));
    CHECK(fit.at("validationDb").get<double>() < fit.at("noiseDb").get<double>() + 5.0);

    const auto judged = runProgram(scratch.folder(), {"pnlss", take, "--model", kept, "--json"});
    REQUIRE(judged.code == 0);
    CHECK(nlohmann::json::parse(judged.out).at("estimationDb").get<double>()
          == Approx(fit.at("estimationDb").get<double>()).margin(0.1));

    // No monomial helps a linear system of order 1 to swing.
    const auto small = runProgram(scratch.folder(), {"pnlss", take, "--order", "1", "--json"});
    INFO(small.err);
    REQUIRE(small.code <= 1);
    const auto missed = nlohmann::json::parse(small.out);
    CHECK(missed.at("arrived") == false);
    CHECK(missed.at("advice").get<std::string>().find("--order") != std::string::npos);
    const auto words = runProgram(scratch.folder(), {"pnlss", take, "--order", "1"});
    CHECK(words.out.find("did not arrive") != std::string::npos);

    const auto kernels = (scratch / "kernels.json").string(), byKernels = (scratch / "by kernels").string(),
               byModel = (scratch / "by model").string();
    REQUIRE(
        runProgram(scratch.folder(), {"pnlss", take, "--model", kept, "--volterra", kernels, "--memory", "200,80,48"})
            .code
        == 0);
    for (const auto& [model, played] : {std::pair {kept, byModel}, {kernels, byKernels}})
        REQUIRE(runProgram(scratch.folder(), {"simulate", model, take, "--out", played}).code == 0);
    const auto exact = excursion::readOwnTake(excursion::headerOf(byModel)).take.channels.at(1).samples,
               series = excursion::readOwnTake(excursion::headerOf(byKernels)).take.channels.at(1).samples;
    double off = 0.0, power = 0.0;
    for (std::size_t t = 0; t < exact.size(); ++t) {
        off += std::pow(series[t] - exact[t], 2);
        power += exact[t] * exact[t];
    }
    CHECK(off < 0.01 * power);  // what a series to order 3 leaves of a cube in a loop
    CHECK(off > 0.0);
    const auto response = runProgram(scratch.folder(), {"bla", take, "--json"});
    INFO(response.err);
    REQUIRE(response.code == 0);
    CHECK(nlohmann::json::parse(response.out).at("rest").at("verdict") == "untold");  // one level all along
    CHECK(nlohmann::json::parse(response.out).at("delay").at("samples") > 1.0);

    const auto again = runProgram(scratch.folder(), {"pnlss", take, "--start", kept, "--json"});
    INFO(again.err);
    REQUIRE(again.code == 0);
    const auto restarted = nlohmann::json::parse(again.out);
    CHECK(restarted.at("history").front().get<double>() == Approx(fit.at("estimationDb").get<double>()).margin(0.5));
    CHECK(restarted.at("arrived") == true);

    const auto linear = (scratch / "linear.json").string();
    REQUIRE(runProgram(scratch.folder(), {"identify", take, "--order", "2", "--discrete", "--out", linear}).code <= 1);
    const auto led = runProgram(scratch.folder(), {"pnlss", take, "--start", linear, "--json"});
    INFO(led.err);
    REQUIRE(led.code == 0);
    CHECK(nlohmann::json::parse(led.out).at("arrived") == true);

    // A block model without a bend is that linear model, and its loop can bend.
    const std::vector<double> straight {0.0, 0.0};
    const nlohmann::json block {{"format", "excursion-block-model"},
                                {"version", 1},
                                {"name", "straight"},
                                {"linear", nlohmann::json::parse(bytesOf(linear))},
                                {"hammerstein", straight},
                                {"wiener", straight},
                                {"feedback", straight},
                                {"offset", 0.0}};
    const auto loop = (scratch / "block.json").string();
    std::ofstream(loop) << block;
    const auto looped = runProgram(scratch.folder(), {"pnlss", take, "--start", loop, "--json"});
    INFO(looped.err);
    REQUIRE(looped.code == 0);
    const auto closed = nlohmann::json::parse(looped.out);
    CHECK(closed.at("history").front().get<double>()
          == Approx(nlohmann::json::parse(led.out).at("history").front().get<double>()).margin(1.0));
    CHECK(closed.at("estimationDb").get<double>() < closed.at("history").front().get<double>() - 10.0);

    refusedWith(2, {"pnlss", take, "--start", loop, "--degree", "3"}, scratch, "leave --degree");
    refusedWith(2, {"pnlss", take, "--start", kept, "--degree", "3"}, scratch, "leave --degree");
    refusedWith(2, {"pnlss", take, "--start", kept, "--order", "3"}, scratch, "leave --order out");
    refusedWith(2, {"pnlss", take, "--start", kept, "--alpha", "0.5"}, scratch, "--alpha");
    refusedWith(3, {"pnlss", take, "--start", (scratch / "none.json").string()}, scratch, "none.json");
    auto other = nlohmann::json::parse(bytesOf(kept));
    other["linear"]["sampleRate"] = 48000.0;
    std::ofstream(scratch / "other.json") << other;
    refusedWith(4, {"pnlss", take, "--start", (scratch / "other.json").string()}, scratch, "48000 Hz");
}

TEST_CASE("pnlss with as many coefficients as samples has not arrived, and a sensor's offset is told to need --offset")
{
    const Scratch scratch;
    const auto record = [&scratch](const char* name, int length, double offset, double noise) {
        std::ostringstream csv;
        csv.precision(12);
        csv << "time,voltage,displacement\n";
        Normal normal(11);
        double x = 0.0, v = 0.0;
        for (int t = 0; t < length; ++t) {
            const double u = normal();
            csv << t / 1000.0 << ',' << u << ',' << x + offset + noise * normal() << '\n';
            const double next = x + 0.3 * v;
            v = 0.8 * v - 0.3 * x - 0.05 * x * x * x + 0.2 * u;
            x = next;
        }
        const auto path = (scratch / name).string();
        std::ofstream(path) << csv.str();
        return path;
    };
    const auto fitted = [&scratch](const std::vector<std::string>& arguments) {
        const auto told = runProgram(scratch.folder(), arguments);
        INFO(told.err);
        REQUIRE(told.code <= 1);
        return nlohmann::json::parse(told.out);
    };
    for (int length = 51; length <= 75; length += 3) {
        const auto few = fitted({"pnlss", record("few.csv", length, 0.0, 0.05), "--order", "2", "--json"});
        CAPTURE(length, few.at("estimationDb"), few.at("validationDb"));
        CHECK(few.at("arrived") != true);
    }
    const auto shifted = record("shifted.csv", 1800, 0.3, 6e-4);
    const auto without = fitted({"pnlss", shifted, "--order", "2", "--json"});
    CHECK(without.at("arrived") != true);
    CHECK(without.at("advice").get<std::string>().find("--offset") == 4);
    const auto with = fitted({"pnlss", shifted, "--order", "2", "--offset", "--json"});
    CHECK(with.at("arrived") == true);
}

TEST_CASE("pnlss sets out from a driver")
{
    const Scratch scratch;
    const auto& chain = Chain::get();
    const auto told = runProgram(scratch.folder(), {"pnlss", chain.take(), "--output", "displacement", "--start",
                                                    chain.model(), "--iterations", "2", "--json"});
    INFO(told.err);
    REQUIRE(told.code <= 1);
    const auto document = nlohmann::json::parse(told.out);
    CHECK(document.at("noiseFrom") == "periods");
    CHECK(document.at("history").front().get<double>() < 0.0);
    CHECK(document.at("model").at("linear").at("A").size() == 3);
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
