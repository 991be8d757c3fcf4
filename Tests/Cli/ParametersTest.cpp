// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Chain.h"

#include <cmath>
#include <complex>
#include <cstdlib>
#include <sstream>

using namespace excursion::test;

namespace {

using Json = nlohmann::json;

Json parameter(const std::string& name, const std::string& unit, double value, bool free = true)
{
    return {{"name", name}, {"unit", unit}, {"value", value}, {"standardError", nullptr}, {"free", free}};
}

Json effect(const std::string& id, const std::vector<std::tuple<std::string, std::string, double>>& numbers)
{
    Json result {{"id", id},
                 {"operatingRange",
                  {{"displacement", 3e-3},
                   {"velocity", 1.0},
                   {"current", 3.0},
                   {"lowFrequency", 15.0},
                   {"highFrequency", 10000.0},
                   {"degree", 2},
                   {"scale", id == "side-resonance" ? 0.0143 : 1800.0}}}};
    for (const auto& [name, unit, value] : numbers)
        result["parameters"].push_back(parameter(name, unit, value));
    return result;
}

/// A midbass, with those effects; of an impedance alone: the mass is held and the area is not told.
std::string modelFile(const Scratch& scratch, const Json& effects, bool alone = false)
{
    const Json model {
        {"format", "excursion-model"},
        {"version", 1},
        {"name", "midbass"},
        {"base",
         {{"id", "electrodynamic"},
          {"parameters",
           {parameter("Re", "ohm", 3.3), parameter("Le", "H", 66e-6), parameter("Bl", "N/A", 4.95),
            parameter("m", "kg", 0.01435, !alone), parameter("Rms", "N s/m", 0.786), parameter("K", "N/m", 1852.0)}}}},
        {"effects", effects},
        {"path",
         {{"parameters", {parameter("Sd", "m^2", alone ? 0.01 : 0.0132, false), parameter("tau", "s", 0.0, false)}},
          {"microphoneDistance", 1.0}}},
        {"covariance", nullptr},
        {"laws", Json::array()}};
    const auto file = (scratch / "model.json").string();
    std::ofstream(file) << model.dump(2);
    return file;
}

Json everyLinearEffect()
{
    return {effect("eddy-currents", {{"Ks", "ohm s^a", 0.012}, {"a", "1", 0.68}}),
            effect("creep",
                   {{"S", "N/m", 300.0}, {"centre", "log10 Hz", 1.0}, {"width", "decades", 3.0}, {"tilt", "1", 0.1}}),
            effect("vented-box", {{"Kb", "N/m", 900.0},
                                  {"fB", "Hz", 42.0},
                                  {"1/QP", "1", 0.02},
                                  {"1/QL", "1", 0.1},
                                  {"1/QA", "1", 0.03},
                                  {"Kp/Ka", "1", 0.2},
                                  {"port", "1", 0.0}}),
            effect("side-resonance", {{"mu1", "kg", 4e-4},
                                      {"f1", "Hz", 900.0},
                                      {"1/Q1", "1", 0.2},
                                      {"mu2", "kg", 2e-4},
                                      {"f2", "Hz", 2500.0},
                                      {"1/Q2", "1", 0.1},
                                      {"mu3", "kg", 0.0},
                                      {"f3", "Hz", 1000.0},
                                      {"1/Q3", "1", 0.3}}),
            effect("stiffness", {{"c1", "N/m", 0.0}, {"c2", "N/m", 550.0}})};
}

std::vector<std::vector<double>> rowsOf(const std::string& file)
{
    std::ifstream in(file);
    std::vector<std::vector<double>> rows;
    for (std::string line; std::getline(in, line);) {
        std::istringstream text(line);
        std::vector<double> row;
        for (double value = 0.0; text >> value;)
            row.push_back(value);
        if (!row.empty())
            rows.push_back(row);
    }
    return rows;
}

const Json& figure(const Json& document, const std::string& symbol)
{
    for (const auto& f : document.at("thieleSmall"))
        if (f.at("symbol") == symbol)
            return f;
    throw std::out_of_range(symbol);
}

}  // namespace

TEST_CASE("parameters writes every file that it is asked for", "[cli]")
{
    const Scratch scratch;
    const auto model = modelFile(scratch, everyLinearEffect());
    const auto at = [&](const char* name) { return (scratch / name).string(); };
    const auto told = runProgram(scratch.folder(), {"parameters", model, "--out", at("ts.csv"), "--laws",
                                                    at("laws.csv"), "--spice", at("woofer.cir"), "--zma", at("z.zma"),
                                                    "--frd", at("p.frd"), "--inductance-band", "200,8000", "--json"});
    INFO(told.err);
    REQUIRE(told.code == 0);
    const auto document = documentOf(told, "excursion-parameters");
    CHECK(document.at("wrote").size() == 5);
    CHECK(figure(document, "Re").at("value") == 3.3);
    CHECK(document.at("inductance").at("band") == Json({200.0, 8000.0}));
    CHECK(document.at("inductance").at("forms").size() == 5);
    CHECK(document.at("laws").size() == 2);
    CHECK_THAT(bytesOf(at("ts.csv")), Catch::StartsWith("symbol,value,standard_error,unit,remark\nRe,3.3,,"));
    CHECK_THAT(bytesOf(at("laws.csv")), Catch::Contains("Cms(x),x,m,0,"));
    // Read back as a take, the impedance is the model's.
    const auto again = runProgram(scratch.folder(), {"compare", at("z.zma"), "--model", model, "--json"});
    INFO(again.err);
    REQUIRE(again.code == 0);
    CHECK(documentOf(again, "excursion-comparison").at("error").at("current").at("db").get<double>() < -100.0);

    REQUIRE(runProgram(scratch.folder(), {"parameters", model, "--out", at("ts.json")}).code == 0);
    const auto written = Json::parse(bytesOf(at("ts.json")));
    CHECK(written.at("format") == "excursion-parameters");
    CHECK(figure(written, "fs") == figure(document, "fs"));
}

TEST_CASE("ngspice plays the netlist with the engine's impedance", "[cli]")
{
    if (std::system("command -v ngspice >/dev/null 2>&1") != 0) {
        WARN("ngspice is not installed (Debian package ngspice): the netlist was not simulated.");
        return;
    }
    const Scratch scratch;
    const auto model = modelFile(scratch, everyLinearEffect());
    REQUIRE(runProgram(scratch.folder(), {"parameters", model, "--spice", (scratch / "woofer.cir").string(), "--zma",
                                          (scratch / "z.zma").string(), "--band", "10,10240"})
                .code
            == 0);
    scratch.file("deck.cir", "The impedance of the subcircuit\n.include woofer.cir\nV1 in 0 AC 1\nX1 in 0 cone "
                             "woofer\n.control\nac oct 48 10 10240\n"
                             "set wr_singlescale\nset numdgt=12\nlet zr=real(-1/i(v1))\nlet zi=imag(-1/i(v1))\nlet "
                             "vr=mag(v(cone))\nwrdata out.txt zr zi vr\nquit\n.endc\n.end\n");
    const auto command = "cd '" + scratch.folder().string() + "' && timeout 60 ngspice -b deck.cir >log.txt 2>&1";
    std::system(command.c_str());  // its exit code does not tell whether it worked
    INFO(bytesOf(scratch / "log.txt"));
    const auto spice = rowsOf((scratch / "out.txt").string()), engine = rowsOf((scratch / "z.zma").string());
    REQUIRE(engine.size() == 481);
    REQUIRE(spice.size() == engine.size());
    double worstDb = 0.0, worstDegrees = 0.0;
    for (std::size_t k = 0; k < engine.size(); ++k) {
        const std::complex<double> Z(spice[k][1], spice[k][2]);
        REQUIRE(spice[k][0] == Approx(engine[k][0]).epsilon(1e-9));
        worstDb = std::max(worstDb, std::abs(20.0 * std::log10(std::abs(Z) / engine[k][1])));
        worstDegrees = std::max(worstDegrees, std::abs(std::arg(Z) * 180.0 / 3.14159265358979 - engine[k][2]));
        CHECK(spice[k][3] > 0.0);  // the cone moves
    }
    INFO(worstDb << " dB, " << worstDegrees << " degrees");
    CHECK(worstDb < 1e-3);
    CHECK(worstDegrees < 0.01);
}

TEST_CASE("parameters of an impedance alone say what they rest on", "[cli]")
{
    const Scratch scratch;
    const auto model = modelFile(scratch, Json::array(), true);
    const auto alone = documentOf(runProgram(scratch.folder(), {"parameters", model, "--json"}),
                                  "excursion-parameters");
    CHECK(figure(alone, "Mms").at("value").is_null());
    CHECK_THAT(figure(alone, "Mms").at("why").get<std::string>(), Catch::Contains("moving mass"));
    CHECK(figure(alone, "Qts").at("value").is_number());
    CHECK(alone.at("stroke").is_null());
    const auto known = documentOf(
        runProgram(scratch.folder(), {"parameters", model, "--mass", "0.02", "--cone-area", "0.0133", "--json"}),
        "excursion-parameters");
    CHECK(figure(known, "Mms").at("sheetValue").get<double>() == Approx(20.0));
    CHECK(figure(known, "Qts").at("value").get<double>() == Approx(figure(alone, "Qts").at("value").get<double>()));
    CHECK(figure(known, "Vas").at("value").get<double>()
          == Approx(1.2 * 343.0 * 343.0 * 0.0133 * 0.0133 / (1852.0 * 0.02 / 0.01435)));
    refusedWith(4, {"parameters", model, "--frd", (scratch / "p.frd").string()}, scratch, "mass");
    refusedWith(2, {"parameters", model, "--mass", "0.02", "--bl", "5"}, scratch, "one of the two");
    refusedWith(2, {"parameters", model, "--mass", "0"}, scratch, "positive");
    refusedWith(2, {"parameters", model, "--mass", "nan"}, scratch, "positive");
}

TEST_CASE("parameters of a measured model, a ladder's folder, and of a take", "[cli]")
{
    const Scratch scratch;
    const auto& chain = Chain::get();
    const auto measured = documentOf(runProgram(scratch.folder(), {"parameters", chain.model(), "--json"}),
                                     "excursion-parameters");
    CHECK(figure(measured, "fs").at("standardError").get<double>() > 0.0);
    CHECK(figure(measured, "Mms").at("standardError").get<double>() > 0.0);
    CHECK(figure(measured, "Mms").at("value").get<double>() > 0.0);

    const auto zma = (scratch / "z.zma").string();
    const auto text = runProgram(scratch.folder(), {"parameters", chain.take(), "--zma", zma});
    INFO(text.err);
    REQUIRE(text.code == 0);
    CHECK(rowsOf(zma).size() > 20);
    refusedWith(4, {"parameters", chain.take(), "--frd", (scratch / "p.frd").string()}, scratch, "pressure");
    refusedWith(4, {"parameters", chain.take(), "--zma", (scratch / "a.zma").string(), "--level", "1000"}, scratch,
                "it has");
    refusedWith(2, {"parameters", chain.take()}, scratch, "is a take");
    refusedWith(2, {"parameters", chain.take(), "--spice", (scratch / "a.cir").string()}, scratch, "is a take");
}

TEST_CASE("parameters refuses what it cannot use", "[cli]")
{
    const Scratch scratch;
    const auto model = modelFile(scratch, Json::array());
    const auto at = [&](const char* name) { return (scratch / name).string(); };
    scratch.file("empty.json", "");
    scratch.file("cut.json", bytesOf(model).substr(0, 400));
    scratch.file("other.json", R"({"format": "excursion-comparison", "version": 1})");
    scratch.file("newer.json", R"({"format": "excursion-ladder", "version": 2})");
    refusedWith(3, {"parameters", at("none.json")}, scratch, "none.json");
    refusedWith(3, {"parameters", at("empty.json")}, scratch, "empty.json");
    refusedWith(3, {"parameters", at("cut.json")}, scratch, "cut.json");
    refusedWith(3, {"parameters", at("other.json")}, scratch, "excursion-model");
    refusedWith(3, {"parameters", at("newer.json")}, scratch, "version");
    refusedWith(2, {"parameters", model, "--out", at("ts.txt")}, scratch, ".csv or .json");
    refusedWith(3, {"parameters", model, "--out", "/proc/none/ts.csv"}, scratch, "/proc");
    refusedWith(2, {"parameters", model, "--mass", "0.02"}, scratch, "shown the moving mass");
    refusedWith(2, {"parameters", model, "--level", "2"}, scratch, "--zma");
    refusedWith(2, {"parameters", model, "--zma", at("z.zma"), "--band", "1000,10"}, scratch, "band");
}
