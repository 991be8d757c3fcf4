// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Import/Export.h"
#include "Engine/Import/ImportMat.h"
#include "Engine/Import/ImportText.h"
#include "Engine/Import/ReadTake.h"
#include "Engine/Import/TextTable.h"
#include "Scratch.h"

#include <clocale>
#include <cmath>

using namespace excursion;
using namespace excursion::test;
using Kind = Error::Kind;

namespace {

Measurement signals(const std::filesystem::path& path, const ImportOptions& options = {})
{
    return std::get<Measurement>(importText(path, options));
}

}  // namespace

TEST_CASE("Column names say quantity and unit in the usual ways")
{
    const auto check = [](const char* column, Quantity quantity, const char* unit) {
        INFO(column);
        const auto found = columnNamed(column);
        REQUIRE(found);
        CHECK(found->quantity == quantity);
        CHECK(found->unit == unit);
    };
    check("voltage", Quantity::voltage, "");
    check("Voltage (mV)", Quantity::voltage, "mV");
    check("current [A]", Quantity::current, "A");
    check("displacement_mm", Quantity::displacement, "mm");
    check("acceleration [m/s^2]", Quantity::acceleration, "m/s^2");
    check("u_v", Quantity::voltage, "v");
    check("v_mps", Quantity::velocity, "mps");
    check("v [V]", Quantity::voltage, "V");
    check("i", Quantity::current, "");
    check("excursion (\u00b5m)", Quantity::displacement, "\u00b5m");
    for (const char* column : {"v", "V1", "", "time", "current [V]", "Ovld1", "[A]", "_", "temperature_c"}) {
        INFO(column);
        CHECK_FALSE(columnNamed(column));
    }
}

TEST_CASE("Numbers are read without regard to the locale")
{
    std::setlocale(LC_ALL, "de_DE.UTF-8");  // does nothing where it is not installed
    CHECK(parseNumber("1.5e-3") == 0.0015);
    CHECK(parseNumber("+2.5") == 2.5);
    std::setlocale(LC_ALL, "C");
    for (const char* text : {"", "abc", "1.5x", "1,5", "+-1", "0x10"}) {
        INFO(text);
        CHECK_FALSE(parseNumber(text));
    }
}

TEST_CASE("A CSV of time signals is read, with its sample rate from the time column")
{
    const Scratch s;
    for (const char* text :
         {"time,voltage,displacement_mm,extra\n0,1,2,a\n0.001,-1,4,b\n0.002,3,6,c\n",
          "\xEF\xBB\xBF# a comment\r\n\"t [ms]\";\"u (V)\";\"x [mm]\"\r\n0;1,0;2\r\n1;-1;4,0\r\n2;3;6\r\n\r\n",
          "time\tu\tx_mm\n0\t1\t2\n0.001\t-1\t4\n0.002\t3\t6"}) {
        const auto m = signals(s.file("a.csv", text));
        CHECK(m.sampleRate == Approx(1000));
        REQUIRE(m.channels.size() == 2);
        CHECK(m.channels[0].samples == std::vector<double> {1, -1, 3});
        CHECK(m.channels[1].unit == "m");
        CHECK(m.channels[1].samples[2] == Approx(0.006));
    }
}

TEST_CASE("Columns are mapped, cut and freed of their means on request")
{
    const Scratch s;
    const auto path = s.file("a.csv", "\"Ovld\",\"V1\",\"V2\",\n0,1,10,\n,3,20,\n,5,30,\n,9,50,\n,,,\n\n");
    ImportOptions o;
    o.columns = {parseColumnQuantity("V1=force:V"), parseColumnQuantity("V2=displacement:mm")};
    o.sampleRate = 610.3516;
    o.from = 1;
    o.to = 3;
    o.removeMean = true;
    const auto m = signals(path, o);
    CHECK(m.sampleRate == 610.3516);
    CHECK(m.input().unit == "V");
    CHECK(m.input().samples == std::vector<double> {-1, 1});
    CHECK(m.channels[1].samples[1] == Approx(0.005));
    CHECK(m.channels[0].fullScale > 1.0);

    o.to = 9;
    refused(Kind::usage, "has 4 samples", [&] { importText(path, o); });
    o.to.reset();
    o.from = 4;
    refused(Kind::usage, "cannot be taken", [&] { importText(path, o); });
    o.from = 0;
    o.sampleRate = 0;
    refused(Kind::usage, "--rate", [&] { importText(path, o); });
    o.columns[0].column = "V9";
    refused(Kind::usage, "no column 'V9'", [&] { importText(path, o); });
    refused(Kind::input, "--map", [&] { importText(path, {}); });
    refused(Kind::usage, "COLUMN=QUANTITY", [] { parseColumnQuantity("V1"); });
    refused(Kind::usage, "known quantity", [] { parseColumnQuantity("V1=heat"); });
    refused(Kind::usage, "N, mN or V", [] { parseColumnQuantity("V1=force:lb"); });
}

TEST_CASE("A bad CSV is refused, naming line and column")
{
    const Scratch s;
    const auto bad = [&](const char* text, const std::string& contains, Kind kind = Kind::input) {
        const auto path = s.file("a.csv", text);
        refused(kind, contains, [&] { readTake(path); });
    };
    bad("", "is empty");
    bad("time,voltage\n", "no rows");
    bad("time,voltage\n0,1\n0.1,nan\n0.2,3\n", "line 3, column 'voltage' is 'nan'");
    bad("time,voltage\n0,1\n0.1,\n0.2,3\n", "line 3, column 'voltage' is empty");
    bad("time,voltage\n0,1\n0.1,1e999\n0.2,3\n", "'1e999'");
    bad("time,voltage,current\n0,1,1\n0.1,1,\n0.2,3,\n", "1 samples in 'current'");
    bad("time,voltage\n0,1\n0.1,2\n0.5,3\n", "not evenly sampled", Kind::data);
    bad("time,voltage\n0,1\n0,2\n0,3\n", "not evenly sampled", Kind::data);
    bad("voltage,current\n1,2\n", "--rate", Kind::usage);
    bad("time,current\n0,1\n0.1,2\n0.2,3\n", "neither a voltage nor a force", Kind::data);
    bad("time,voltage,u\n0,1,1\n0.1,2,2\n0.2,3,3\n", "more than one column for the voltage");
    bad("\x7f"
        "ELF\n\x01\x02\n",
        "no rows of numbers");
    bad("frequency_hz,u_re_v,u_im_v\n1,2,3\n1,2,4\n", "do not ascend");
    bad("frequency_hz,u_re_v\n1,2\n2,2\n3,2\n", "no column for its imaginary part");
    bad("frequency_hz,q_re_v,q_im_v\n1,2,3\n", "not understood");
    bad("frequency_hz,i_re_a,i_im_a\n1,2,3\n2,2,3\n3,2,3\n", "neither voltage nor force", Kind::data);
}

TEST_CASE("Takes and spectra survive the way through a CSV")
{
    const Scratch s;
    Measurement m;
    m.sampleRate = 44100;
    m.channels = {{Quantity::voltage, "V", 4, {1.1, -2.2, 1.0 / 3}},
                  {Quantity::acceleration, "m/s^2", 4, {1e-17, 5, 6}}};
    writeCsv(m, s / "m.csv");
    const auto read = readMeasurement(s / "m.csv");
    CHECK(read.sampleRate == Approx(44100));
    CHECK(read.channels[0].samples == m.channels[0].samples);
    CHECK(read.channels[1].samples == m.channels[1].samples);

    Spectra sp;
    sp.frequency = {10, 20, 30};
    sp.channels = {{Quantity::voltage, "V", {{1, 2}, {3, 4}, {5, 1.0 / 7}}},
                   {Quantity::velocity, "m/s", {{6, 5}, {4, 3}, {2, 1}}}};
    writeCsv(sp, s / "s.csv");
    const auto back = std::get<Spectra>(readTake(s / "s.csv"));
    CHECK(back.frequency == sp.frequency);
    CHECK(back.find(Quantity::voltage)->values == sp.channels[0].values);
    CHECK(back.find(Quantity::velocity)->values == sp.channels[1].values);
    refused(Kind::data, "frequency response", [&] { readMeasurement(s / "s.csv"); });
}

TEST_CASE("ZMA and FRD are read in the forms that programs write")
{
    const Scratch s;
    for (const char* text :
         {"* REW\n; x\n# y\nFreq(Hz) Z(Ohms) Phase\n10 8 90\n20 4 -45\n30 2 0\n30 2 0\n",
          "10,8.0,90\r\n20,4,-45\r\n30,2,0\r\n", "10, 8, 90\n20, 4, -45\n30, 2, 0",
          "\"Hz\";\"Ohm\"\n10;8;90\n20;4;-45\n30;2;0\n", "  10,0\t8,00\t90\n\n  20,0\t+4,00\t-45\n  30,0\t2,00\t0\n",
          "1e1 8.0e+00 9e1 7\n2e1 4 -45 7\n3e1 2 0 7\n"}) {
        const auto z = std::get<Spectra>(readTake(s.file("a.ZMA", text)));
        INFO(text);
        REQUIRE(z.frequency == std::vector<double> {10, 20, 30});
        CHECK(std::abs(z.find(Quantity::voltage)->values[0] - std::complex<double>(0, 8)) < 1e-12);
        CHECK(z.find(Quantity::current)->values[1] == 1.0);
    }
    const auto frd = std::get<Spectra>(readTake(s.file("a.frd", "10 20 180\n20 0 0\n30 -20 0\n")));
    CHECK(frd.find(Quantity::voltage)->values[2] == 1.0);
    CHECK(std::abs(frd.find(Quantity::pressure)->values[0] + 10.0 * 20e-6) < 1e-12);
    CHECK(frd.find(Quantity::pressure)->values[2].real() == Approx(2e-6));
    CHECK(frd.remarks.size() == 1);  // the voltage
}

TEST_CASE("A bad ZMA is refused, naming the line")
{
    const Scratch s;
    const auto bad = [&](std::string_view text, const std::string& contains) {
        const auto path = s.file("a.zma", text);
        refused(Kind::input, contains, [&] { readTake(path); });
    };
    bad("", "is empty");
    bad("* nothing\n", "no rows of numbers");
    bad("10 8 0\n20 8 0\n", "has 2 lines");
    bad("10 8 0\n20 8 0\n15 8 0\n", "line 3");
    bad("10 8 0\n10 9 0\n20 8 0\n", "line 2");
    bad("10 8 0\n20 nan 0\n30 8 0\n", "line 2");
    bad("10 8 0\n20 8 0\n30\n", "2 numbers");
    bad("10 8 0\n20 8 0\ntext\n30 8 0\n", "line 3");
    bad("-1 8 0\n20 8 0\n30 8 0\n", "line 1");
    bad("10 -8 0\n20 8 0\n30 8 0\n", "not positive");
    bad(std::string_view("\0\1\2\3\n\xff\xfe\n", 8), "zero bytes");
}

TEST_CASE("ZMA and FRD survive being written and read")
{
    const Scratch s;
    Frf z {{10, 20, 30}, {{3, 4}, {-1, 0.5}, {1.0 / 3, -7}}, {}, {}};
    writeZma(z, s / "z.zma");
    writeFrd(z, s / "z.frd");
    const auto zma = std::get<Spectra>(readTake(s / "z.zma"));
    const auto frd = std::get<Spectra>(readTake(s / "z.frd"));
    for (std::size_t k = 0; k < 3; ++k) {
        CHECK(std::abs(zma.find(Quantity::voltage)->values[k] - z.value[k]) < 1e-13);
        CHECK(std::abs(frd.find(Quantity::pressure)->values[k] / 20e-6 - z.value[k]) < 1e-12);
    }
    z.noiseVariance = {1, 2, 3};
    writeCsv(z, s / "z.csv");
    CHECK(bytesOf(s / "z.csv").starts_with("frequency_hz,re,im,noise_variance\n10,3,4,1\n"));
}

TEST_CASE("A file that is no MAT is refused")
{
    const Scratch s;
    refused(Kind::input, "does not exist", [&] { importMat(s / "no.mat", {}); });
    refused(Kind::input, "is empty", [&] { importMat(s.file("e.mat", ""), {}); });
    refused(Kind::input, "g.mat", [&] { importMat(s.file("g.mat", std::string(500, 'x')), {}); });
}
