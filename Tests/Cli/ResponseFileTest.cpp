// SPDX-License-Identifier: GPL-3.0-or-later
// An impedance, as other programs export it, in every verb: it needs no option, or the verb says in one sentence why it
// cannot take it.
#include "Cli/Chain.h"

#include <cmath>
#include <complex>
#include <cstdio>
#include <numbers>

using namespace excursion::test;

namespace {

/// R + jw L + Bl^2 / (r + jw m + K/jw): a linear loudspeaker's impedance, in closed form.
std::complex<double> impedanceAt(double f)
{
    const std::complex<double> s(0.0, 2 * std::numbers::pi * f);
    return 6.0 + s * 0.5e-3 + 36.0 / (1.5 + s * 0.015 + 1500.0 / s);
}

std::string impedanceText(const std::string& header)
{
    std::string text = header;
    for (double f = 10.0; f < 10000.0; f *= std::exp2(1.0 / 12)) {
        const auto z = impedanceAt(f);
        char line[100];
        std::snprintf(line, sizeof line, "%.9g\t%.9g\t%.9g\n", f, std::abs(z), std::arg(z) * 180 / std::numbers::pi);
        text += line;
    }
    return text;
}

std::string driver(const Scratch& scratch)
{
    return scratch.file("driver.zma", impedanceText("* Freq(Hz)\tZ(Ohms)\tPhase(degrees)\n")).string();
}

}  // namespace

TEST_CASE("identify and bla take an impedance for what it is, voltage over current", "[cli][response]")
{
    const Scratch scratch;
    for (const auto& file :
         {driver(scratch),
          scratch
              .file("rew.txt",
                    impedanceText("* Measurement data measured by REW V5.31\n* Freq(Hz)\tZ(Ohms)\tPhase(degrees)\n"))
              .string()}) {
        const auto identified = runProgram(scratch.folder(), {"identify", file, "--quick", "--json"});
        REQUIRE(identified.code == 0);
        const auto document = documentOf(identified, "excursion-identification");
        CHECK(document.at("model").at("inputs").at(0) == "current");
        CHECK(document.at("model").at("outputs").at(0) == "voltage");
        CHECK(document.at("orders").size() == 8);
        CHECK(document.at("orders").at(3).at("errorDb") < -60.0);
        const auto shown = runProgram(scratch.folder(),
                                      {"bla", file, "--out", (scratch / "copy.zma").string(), "--json"});
        REQUIRE(shown.code == 0);
        const auto response = documentOf(shown, "excursion-bla");
        CHECK(response.at("input") == "current");
        const auto z = impedanceAt(response.at("frequency").at(20).get<double>());
        CHECK(response.at("re").at(20).get<double>() == Approx(z.real()).epsilon(1e-6));
        CHECK(response.at("im").at(20).get<double>() == Approx(z.imag()).epsilon(1e-6));
        CHECK(runProgram(scratch.folder(), {"bla", (scratch / "copy.zma").string(), "--quiet"}).code == 0);
    }
    const auto mixed = runProgram(scratch.folder(), {"identify", driver(scratch), "--alpha", "1", "--mixed", "--json"});
    CHECK(documentOf(mixed, "excursion-mixed-impedance").at("resistance").at("value").get<double>()
          == Approx(6.0).epsilon(1e-3));
    const auto admittance = runProgram(scratch.folder(),
                                       {"identify", driver(scratch), "--order", "3", "--output", "current", "--json"});
    CHECK(documentOf(admittance, "excursion-identification").at("model").at("inputs").at(0) == "voltage");
    refusedWith(2, {"bla", driver(scratch), "--level", "1"}, scratch, "frequency response already");
}

TEST_CASE("fit, compare, diagnose, add and improve take an impedance", "[cli][response]")
{
    const Scratch scratch;
    const auto file = driver(scratch), model = (scratch / "model.json").string();
    const auto fitted = documentOf(runProgram(scratch.folder(), {"fit", file, "--out", model, "--json"}),
                                   "excursion-fit");
    CHECK(nlohmann::json::parse(bytesOf(model)).at("base").at("parameters").at(0).at("value").get<double>()
          == Approx(6.0).epsilon(1e-3));
    CHECK(runProgram(scratch.folder(), {"compare", file, "--model", model}).code == 0);
    CHECK(runProgram(scratch.folder(), {"diagnose", file, "--model", model}).code == 0);
    const auto added = runProgram(
        scratch.folder(), {"add", file, "eddy-currents", "--model", model, "--out", (scratch / "more.json").string()});
    CHECK(added.code == 0);
    CHECK_THAT(added.out, Catch::Contains("impedance"));
    CHECK(runProgram(scratch.folder(), {"improve", file, "--out", (scratch / "ladder").string()}).code == 0);
    CHECK(runProgram(scratch.folder(), {"report", (scratch / "ladder").string()}).code == 0);
}

TEST_CASE("Verbs that need samples say so when they are given an impedance", "[cli][response]")
{
    const Scratch scratch;
    const auto file = driver(scratch), out = (scratch / "out").string();
    const auto model = Chain::get().model();
    refusedWith(4, {"check", file}, scratch, "frequency response");
    refusedWith(4, {"rank", file}, scratch, "frequency response");
    refusedWith(4, {"pnlss", file, "--order", "2", "--out", out + ".json"}, scratch, "frequency response");
    refusedWith(4, {"simulate", model, file, "--out", out}, scratch, "frequency response");
    refusedWith(4, {"whatif", model, file}, scratch, "frequency response");
    refusedWith(2, {"report", file}, scratch, "improve");
    refusedWith(3, {"predistort", model, file, out + ".wav", "--full-scale", "4"}, scratch, "driver.zma");
}

TEST_CASE("import says what a file lacks, and does with --as, --map or --minimum-phase", "[cli][response]")
{
    const Scratch scratch;
    const auto bare = scratch.file("bare.txt", impedanceText("")).string(), csv = (scratch / "z.csv").string();
    refusedWith(3, {"import", bare, "--out", csv}, scratch, "--as impedance");
    refusedWith(3, {"improve", bare, "--out", (scratch / "ladder").string()}, scratch, "excursion import");
    refusedWith(2, {"import", bare, "--as", "colour", "--out", csv}, scratch, "colour");
    REQUIRE(runProgram(scratch.folder(), {"import", bare, "--as", "impedance", "--out", csv}).code == 0);
    const auto shown = documentOf(runProgram(scratch.folder(), {"bla", csv, "--json"}),
                                  "excursion-bla");  // the CSV needs no option, either
    CHECK(shown.at("output") == "voltage");
    CHECK(shown.at("re").at(3).get<double>()
          == Approx(impedanceAt(shown.at("frequency").at(3).get<double>()).real()).epsilon(1e-6));
    const auto mapped = (scratch / "m.zma").string();
    REQUIRE(runProgram(scratch.folder(), {"import", bare, "--map", "1=frequency", "--map", "2=impedance.magnitude:ohm",
                                          "--map", "3=impedance.phase:deg", "--out", mapped})
                .code
            == 0);
    CHECK(runProgram(scratch.folder(), {"bla", mapped}).code == 0);

    std::string qc = "frq\timp\tmax\tmin\n";
    for (double f = 10.0; f < 20000.0; f *= std::exp2(1.0 / 24))
        qc += std::to_string(f) + "\t" + std::to_string(std::abs(impedanceAt(f))) + "\t99\t1\n";
    const auto limits = scratch.file("qc.txt", qc).string();
    refusedWith(4, {"import", limits, "--out", csv}, scratch, "--minimum-phase");
    const auto computed = runProgram(
        scratch.folder(), {"import", limits, "--minimum-phase", "--out", (scratch / "phase.zma").string(), "--json"});
    const auto document = documentOf(computed, "excursion-import");
    CHECK(document.at("remarks").size() == 3);
    const auto phase = documentOf(runProgram(scratch.folder(), {"bla", (scratch / "phase.zma").string(), "--json"}),
                                  "excursion-bla");
    CHECK(phase.at("im").at(60).get<double>()
          == Approx(impedanceAt(phase.at("frequency").at(60).get<double>()).imag()).margin(0.5));
}
