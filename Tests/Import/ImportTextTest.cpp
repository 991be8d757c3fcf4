// SPDX-License-Identifier: GPL-3.0-or-later
// Layouts of other programs. "Seen" are laid out as files of that program that we have read; "described" are laid out
// as its manual or users of its files describe them. All numbers are our own.
#include "Engine/Import/Export.h"
#include "Engine/Import/ImportText.h"
#include "Engine/Import/PlainText.h"
#include "Engine/Import/ReadTake.h"
#include "Scratch.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

using namespace excursion;
using namespace excursion::test;
using Kind = Error::Kind;

namespace {

using Complex = std::complex<double>;

Spectra responses(const std::string& text, const std::string& name = "a.txt", const ImportOptions& options = {})
{
    return std::get<Spectra>(importText(plainText(text, name), name, options));
}

ImportOptions mapped(std::initializer_list<const char*> mappings)
{
    ImportOptions options;
    for (const char* mapping : mappings)
        addMapping(options, mapping);
    return options;
}

ImportOptions taken(const char* response)
{
    ImportOptions options;
    options.as = responseNamed(response);
    return options;
}

Complex degrees(double size, double angle) { return std::polar(size, angle * std::numbers::pi / 180); }

void checkImpedance(const Spectra& spectra)
{
    REQUIRE(spectra.frequency == std::vector<double> {10.5, 21, 42});
    REQUIRE(spectra.channels.size() == 2);
    REQUIRE(spectra.input() != nullptr);
    CHECK(spectra.input()->quantity == Quantity::current);
    const auto& z = spectra.find(Quantity::voltage)->values;
    CHECK(std::abs(z[0] - degrees(8.25, 45)) < 1e-12);
    CHECK(std::abs(z[1] - degrees(30, -0.5)) < 1e-12);
    CHECK(std::abs(z[2] - degrees(6.5, -30)) < 1e-12);
}

std::string inUtf16(std::string_view ascii, bool bigEndian, bool mark)
{
    std::string bytes = mark ? bigEndian ? "\xFE\xFF" : "\xFF\xFE" : "";
    for (const char c : ascii) {
        const char pair[] {bigEndian ? '\0' : c, bigEndian ? c : '\0'};
        bytes.append(pair, 2);
    }
    return bytes;
}

}  // namespace

TEST_CASE("An impedance is recognized by its content, in the layouts of the trade", "[import]")
{
    for (const char* text :
         {// REW, seen
          "* Measurement data measured by REW V5.31.1\n* Source: EXCL: Microphone (USB), no input selected, R, volume: "
          "no control\n"
          "* Format: 256k Log Swept Sine, 1 sweep at 0.0 dBFS, at 48000 Hz\n* Dated: 21:09:24 16/07/2024\n* Sense "
          "Resistor: 100.0\n* Note: \n"
          "* Measurement: Woofer Impedance\n* Smoothing: None\n* Frequency Step: 1/96 octave\n* Start Frequency: "
          "20.145 Hz\n*\n"
          "* "
          "Freq(Hz)\tZ(Ohms)\tPhase(degrees)\n10.500000\t8.250000\t45.0000\n21.0\t30.0\t-0.5000\n42.0\t6.5\t-30.0000\n",
          // REW on a machine with decimal commas, described
          "* Freq(Hz)\tZ(Ohms)\tPhase(degrees)\r\n10,500\t8,250\t45,0\r\n21,0\t30,0\t-0,5\r\n42,0\t6,5\t-30,0\r\n",
          // LIMP, seen (converted by another program)
          "* LIMP binary, 241 points, sample rate 48000 Hz\n* freq(Hz) |Z|(ohm) phase(deg)\n10.5 8.25 45\n21 30 "
          "-0.5\n42 6.5 -30\n",
          // LIMP and ARTA, described
          "Created by LIMP\n\nFreq(Hz)   |Z|(ohm)   Phase(deg)\n10.5   8.25   45\n21   30   -0.5\n42   6.5   -30\n",
          "; VituixCAD\n// a second remark\n# a third\n\"a fourth\"\nFrequency [Hz];Impedance [\xce\xa9];Phase "
          "[\xc2\xb0]\n10,5;8,25;45\n21;30;-0,5\n42;6,5;-30\n",
          // instruments and spreadsheets, described
          "Frequency (Hz),Impedance Magnitude (Ohm),Impedance Phase (deg)\n10.5,8.25,45\n21,30,-0.5\n42,6.5,-30\n",
          "f/kHz\t|Z|/k\xe2\x84\xa6\tphi/"
          "rad\n0.0105\t0.00825\t0.78539816339744830962\n0.021\t0.03\t-0.0087266462599716478846\n0.042\t0.0065\t-0."
          "52359877559829887308\n",
          "Hz\tOhm\tDeg\n10.5\t8.25\t45\n21\t30\t-0.5\n42\t6.5\t-30\n",
          "f\tZ\tphase\n[Hz]\t[Ohm]\t[deg]\n10.5\t8.25\t45\n21\t30\t-0.5\n42\t6.5\t-30\n",
          "freq,mag(Z) [mOhm],phase(Z) [deg]\n10.5,8250,45\n21,30000,-0.5\n42,6500,-30\n",
          // descending, repeated, with a line at 0 Hz
          "f [Hz], Z [Ohm], phase [deg]\n42, 6.5, -30\n42, 6.5, -30\n21, 30, -0.5\n10.5, 8.25, 45\n",
          "f [Hz], Z [Ohm], phase [deg]\n0, 5, 0\n10.5, 8.25, 45\n21, 30, -0.5\n42, 6.5, -30\n"}) {
        INFO(text);
        checkImpedance(responses(text));
    }
    const auto parts = responses("f_hz,Re(Z) [Ohm],Im(Z) [Ohm]\n1,3,4\n2,-1,0.5\n3,0.25,-7\n");
    CHECK(parts.find(Quantity::voltage)->values == std::vector<Complex> {{3, 4}, {-1, 0.5}, {0.25, -7}});
    CHECK(responses("f_hz,z_re_ohm,z_im_ohm\n1,3,4\n2,-1,0.5\n3,0.25,-7\n").find(Quantity::voltage)->values
          == parts.find(Quantity::voltage)->values);
    CHECK(responses("f_hz,zreal,zimag\n1,3,4\n2,-1,0.5\n3,0.25,-7\n").find(Quantity::voltage)->values
          == parts.find(Quantity::voltage)->values);
}

TEST_CASE("Texts are read in the encodings that programs write", "[import]")
{
    const std::string text = "Freq(Hz) Z(Ohms) Phase(degrees)\r\n10.5 8.25 45\r\n21 30 -0.5\r\n42 6.5 -30\r\n";
    checkImpedance(responses("\xEF\xBB\xBF" + text));
    for (const bool bigEndian : {false, true})
        for (const bool mark : {false, true})
            checkImpedance(responses(inUtf16(text, bigEndian, mark)));
    std::string old = text;  // a carriage return alone
    old.erase(std::remove(old.begin(), old.end(), '\n'), old.end());
    checkImpedance(responses(old));
    checkImpedance(responses(
        // Latin-1
        "* gemessen f\xfcr 5 \xb5V\nf [Hz];Z [Ohm];phase [\xb0]\n10.5;8.25;45\n21;30;-0.5\n42;6.5;-30\n"));
    CHECK(plainText("\xb5", "a") == "\u00b5");
    CHECK(plainText(std::string_view("\xff\xfe\x3d\xd8\x00\xde\x00\xd8", 8), "a") == "\U0001F600\uFFFD");
    refused(Kind::input, "zero bytes", [] { plainText(std::string("a\0b", 3), "a"); });
}

TEST_CASE("A sound pressure over frequency is recognized, and what its level means is told", "[import]")
{
    for (const char* text :
         {"* Measurement data measured by REW V5.19\n* Measurement: L\n* Smoothing: 1/24 octave\n* Frequency Step: 1.0 "
          "Hz\n*\n"
          "* Freq(Hz) SPL(dB) Phase(degrees)\n20.000 94.0 -90.0\n1000.000 100 180\n2000 80 0\n",  // REW, seen
          "Frequency,SPL (dBSPL),Phase\n20,94,-90\n1000,100,180\n2000,80,0\n",
          "Frequency [Hz]\tLevel [dB SPL]\tPhase [deg]\n20\t94\t-90\n1000\t100\t180\n2000\t80\t0\n"}) {
        INFO(text);
        const auto spectra = responses(text);
        CHECK(spectra.input()->quantity == Quantity::voltage);
        const auto& p = spectra.find(Quantity::pressure)->values;
        CHECK(std::abs(p[0] - degrees(20e-6 * std::pow(10.0, 4.7), -90)) < 1e-9);
        CHECK(std::abs(p[1] + 2.0) < 1e-12);
        REQUIRE(spectra.remarks.size() == 1);
        CHECK_THAT(spectra.remarks.front(), Catch::Contains("1 V"));
    }
    const Scratch s;
    const auto once = responses("Freq(Hz) SPL(dB) Phase(degrees)\n20 94 -90\n1000 100 180\n2000 80 0\n");
    writeCsv(once, s / "kept.csv");
    const auto kept = std::get<Spectra>(readTake(s / "kept.csv"));
    CHECK(kept.remarks == once.remarks);
    CHECK(kept.find(Quantity::pressure)->values == once.find(Quantity::pressure)->values);
    // ARTA, described: a level whose 0 dB the file does not tell
    const std::string arta = "Frequency(Hz),Magn (dB),Phase (deg)\n20,94,-90\n1000,100,180\n2000,80,0\n";
    refused(Kind::input, "--as", [&] { responses(arta); });
    CHECK(std::abs(responses(arta, "a.txt", taken("response")).find(Quantity::pressure)->values[1] + 2.0) < 1e-12);
    CHECK(std::abs(responses(arta, "a.frd").find(Quantity::pressure)->values[1] + 2.0) < 1e-12);
    // content over ending
    checkImpedance(responses("Freq(Hz) Z(Ohms) Phase(degrees)\n10.5 8.25 45\n21 30 -0.5\n42 6.5 -30\n", "a.frd"));
    CHECK(responses("Freq(Hz) SPL(dB) Phase(degrees)\n10.5 8.25 45\n21 30 -0.5\n42 6.5 -30\n", "a.zma")
              .find(Quantity::pressure));
}

TEST_CASE("Curves of Klippel's programs are read", "[import]")
{
    // QC, seen: a magnitude alone between limits
    const std::string qc = "frq\timp\tmax\tmin\n18.750\t3.7263\t4.4030\t3.0445\n23.438\t4.5925\t5.4223\t3.0645\n28."
                           "125\t5.1249\t6.4649\t3.0831\n";
    refused(Kind::data, "--minimum-phase", [&] { responses(qc); });
    ImportOptions phaseless;
    phaseless.minimumPhase = true;
    const auto z = responses(qc, "Impedance-imp.txt", phaseless);
    CHECK(std::abs(z.find(Quantity::voltage)->values[2]) == Approx(5.1249));
    CHECK(z.remarks.size() == 3);  // limits, unit, phase
    refused(Kind::input, "'resp'", [] {
        responses("frq\tresp\tmax\tmin\n200.00\t91.346\t97.060\t83.701\n206\t91.4\t97\t83\n212\t91.4\t97\t83\n");
    });

    // R&D, described: a title, the curves' names, their units, and a pair of columns for each curve, of different
    // lengths
    const std::string curves = "\"Magnitude of electric impedance Z(f)\"\n\"Measured\"\t\t\"Fitted\"\t\n"
                               "\"Frequency [Hz]\"\t\"Impedance [Ohm]\"\t\"Frequency [Hz]\"\t\"Impedance [Ohm]\"\n"
                               "10\t6\t11\t6.5\n20\t12\t21\t13\n40\t9\t41\t9.5\n80\t7\n";
    const auto first = responses(curves, "a.txt", phaseless);
    CHECK(first.frequency == std::vector<double> {10, 20, 40, 80});
    CHECK(std::abs(first.find(Quantity::voltage)->values[1]) == Approx(12));
    CHECK_THAT(first.remarks.front(), Catch::Contains("several curves"));
    const auto moved = responses(
        "\"Hx (f) Magnitude\"\n\"Measured\"\n\"Frequency [Hz]\"\t\"X(f)/U(f) [mm/V]\"\n10\t0.5\n20\t0.4\n40\t0.1\n",
        "a.txt", phaseless);
    CHECK(std::abs(moved.find(Quantity::displacement)->values[0]) == Approx(0.5e-3));
    CHECK(moved.input()->quantity == Quantity::voltage);
}

TEST_CASE("Columns are mapped to parts of responses, by title or number", "[import]")
{
    const std::string g = "f_hz,G_re,G_im\n10,3,4\n20,-1,0.5\n40,0.25,-7\n";
    refused(Kind::input, "'G_re'", [&] { responses(g); });
    const std::vector<Complex> values {{3, 4}, {-1, 0.5}, {0.25, -7}};
    CHECK(responses(g, "a.csv", mapped({"G_re=impedance.re", "G_im=impedance.im"})).find(Quantity::voltage)->values
          == values);
    CHECK(responses(g, "a.csv", taken("impedance")).find(Quantity::voltage)->values == values);
    CHECK(responses(g, "a.csv", taken("displacement/voltage")).find(Quantity::displacement)->values == values);
    const auto bare = "10 3 4\n20 -1 0.5\n40 0.25 -7\n";
    CHECK(responses(bare, "a.dat",
                    mapped({"1=frequency", "2=velocity/voltage.re:mm/s/V", "3=velocity/voltage.im:mm/s/V"}))
              .find(Quantity::velocity)
              ->values[0]
          == Complex(3e-3, 4e-3));
    refused(Kind::usage, "--map 1=frequency", [&] {
        responses(bare, "a.dat", mapped({"2=impedance.re", "3=impedance.im"}));
    });
    refused(Kind::input, "--as impedance", [&] { responses(bare); });
    const auto polar = responses(
        "0.01;-40;1.5707963267948966\n0.02;-20;0\n0.04;0;0\n", "a.txt",
        mapped({"1=frequency:kHz", "2=displacement/voltage.dB:mm/V", "3=displacement/voltage.phase:rad"}));
    CHECK(polar.frequency[2] == 40.0);
    CHECK(std::abs(polar.find(Quantity::displacement)->values[0] - Complex(0, 1e-5)) < 1e-18);

    // An impedance beside responses to the voltage becomes the current.
    const auto both = responses(
        "f_hz,Z [Ohm],phase [deg],x/u [mm/V],phase [deg]\n10,8,90,2,0\n20,8,0,1,-90\n40,8,0,0.5,180\n");
    CHECK(both.input()->quantity == Quantity::voltage);
    CHECK(std::abs(both.find(Quantity::current)->values[0] - Complex(0, -0.125)) < 1e-15);
    CHECK(std::abs(both.find(Quantity::displacement)->values[1] - Complex(0, -1e-3)) < 1e-15);
    refused(Kind::input, "responses to the same",
            [] { responses("f_hz,x/u [mm/V],phase [deg],p/i [Pa/A],phase [deg]\n1,1,1,1,1\n2,1,1,1,1\n3,1,1,1,1\n"); });

    for (const char* wrong :
         {"", "=", "G=impedance", "G=impedance.size", "=impedance.re", "G=heat.re", "G=voltage/voltage.re",
          "G=impedance.re:mm", "G=displacement/voltage.dB", "1=time:Hz", "1=frequency:s", "=time"}) {
        INFO(wrong);
        ImportOptions options;
        refused(Kind::usage, std::string("'") + wrong + "'", [&] { addMapping(options, wrong); });
    }
    refused(Kind::usage, "no column 'H'", [&] {
        responses(g, "a.csv", mapped({"H=impedance.re", "G_im=impedance.im"}));
    });
    refused(Kind::usage, "not both", [&] { responses(g, "a.csv", mapped({"G_re=impedance.re", "G_im=current"})); });
    refused(Kind::input, "imaginary part", [&] { responses(g, "a.csv", mapped({"G_re=impedance.re"})); });
    refused(Kind::input, "more than one", [&] {
        responses(g, "a.csv", mapped({"G_re=impedance.re", "G_im=impedance.re"}));
    });
}

TEST_CASE("Time signals need no titles, and their units are understood", "[import]")
{
    const auto measured = [](const std::string& text, const ImportOptions& options) {
        return std::get<Measurement>(importText(text, "a.txt", options));
    };
    const auto bare = measured("0\t1\t20\n1\t-1\t40\n2\t3\t60\n",
                               mapped({"1=time:ms", "2=voltage", "3=displacement:um"}));
    CHECK(bare.sampleRate == Approx(1000));
    CHECK(bare.find(Quantity::displacement)->samples[2] == Approx(60e-6));
    const auto titled = measured("Time (us)\tU/mV\tx / \xc2\xb5m\ta [g]\n0\t1\t20\t1\n10\t-1\t40\t0\n20\t3\t60\t0\n",
                                 {});
    CHECK(titled.sampleRate == Approx(1e5));
    CHECK(titled.input().samples[2] == Approx(3e-3));
    CHECK(titled.find(Quantity::displacement)->samples[0] == Approx(20e-6));
    CHECK(titled.find(Quantity::acceleration)->samples[0] == Approx(9.80665));
    CHECK(titled.remarks.empty());
    CHECK(measured("t,voltage\n0,1\n1,2\n2,3\n", {}).remarks.size() == 1);
    refused(Kind::input, "--map 1=voltage", [&] { measured("1 2\n3 4\n5 6\n", {}); });
    refused(Kind::usage, "no column '4'", [&] { measured("1 2\n3 4\n5 6\n", mapped({"4=voltage"})); });
    refused(Kind::usage, "N, mN or V", [] { mapped({"1=force:MN"}); });  // mega is not milli
}

TEST_CASE("An impulse response of REW becomes the frequency response from its time zero", "[import]")
{
    // Header as REW 5.40 writes it, seen. A pulse at sample 100.5 - 20 = 80.5 after time zero, low-pass of first order.
    constexpr int samples = 4096;
    constexpr double rate = 48000, corner = 2000, start = -20.0 / rate;
    std::string text =
        "* Impulse Response data saved by REW V5.40\n* IR is not normalised\n* IR window has not been applied\n* IR is "
        "not the min phase version\n"
        "* Dated: Jun 15, 2026, 2:47:02 PM\n* Measurement: w-L_01 (sw)\n"
        "* Excitation: 512k Log Swept Sine, 1 sweep at -10.0 dBFS using a loopback as a timing reference\n"
        "* Response measured over: 50.5 to 19,999.9 Hz\n0.5 // Peak value before normalisation\n100 // Peak "
        "index\n4096 // Response length\n"
        "2.0833333333333333E-5 // Sample interval (seconds)\n-4.1666666666666669E-4 // Start time (seconds)\n";
    const auto level = std::string("94.0 // Data offset (dB)\n");
    std::string body = "* Data start\n";
    const double pole = std::exp(-2 * std::numbers::pi * corner / rate);
    for (int n = 0; n < samples; ++n) {
        char number[40];
        std::snprintf(number, sizeof number, "%.17g\n", n < 100 ? 0.0 : 0.25 * std::pow(pole, n - 100));
        body += number;
    }
    const auto truth = [&](double f) {
        return 0.25 / (1.0 - pole * std::polar(1.0, -2 * std::numbers::pi * f / rate))
               * std::polar(1.0, -2 * std::numbers::pi * f * (100 / rate + start));
    };
    const auto spectra = responses(text + body);
    CHECK(spectra.frequency.front() >= 50.5);
    CHECK(spectra.frequency.back() <= 20000.0);
    CHECK(spectra.frequency.size() < 900);
    const auto& p = spectra.find(Quantity::pressure)->values;
    for (std::size_t k = 0; k < p.size(); ++k)
        CHECK(std::abs(p[k] - truth(spectra.frequency[k])) < 1e-9 * std::abs(truth(spectra.frequency[k])));
    CHECK(spectra.remarks.size() == 1);
    const auto loud = responses(text + level + body);
    CHECK(std::abs(loud.find(Quantity::pressure)->values[5] / p[5] - 20e-6 * std::pow(10.0, 4.7)) < 1e-9);

    auto normalised = text;
    normalised.replace(normalised.find("is not normalised"), 17, "is normalised");
    CHECK(std::abs(responses(normalised + body).find(Quantity::pressure)->values[5] / p[5] - 0.5) < 1e-12);
    refused(Kind::input, "has 4095 samples",
            [&] { responses(text + body.substr(0, body.rfind('\n', body.size() - 2) + 1)); });
    refused(Kind::input, "expected a finite sample", [&] { responses(text + body + "nan\n"); });
    refused(Kind::input, "sample interval", [&] { responses("* Impulse Response data saved by REW\n" + body); });
    refused(Kind::usage, "--map", [&] { responses(text + body, "a.txt", mapped({"1=voltage"})); });
    for (const auto ask :
         {+[](ImportOptions& o) { o.removeMean = true; }, +[](ImportOptions& o) { o.minimumPhase = true; },
          +[](ImportOptions& o) { o.as = responseNamed("impedance"); }}) {
        ImportOptions options;
        ask(options);
        refused(Kind::usage, "leave --map", [&] { responses(text + body, "a.txt", options); });
    }
}

TEST_CASE("Tables that cannot be understood for certain are refused", "[import]")
{
    const auto bad = [](const char* text, Kind kind, const std::string& contains) {
        INFO(text);
        refused(kind, contains, [&] { responses(text); });
    };
    bad("f,Z,phase\n10,5,8,2,45,0\n20,5,8,2,45,0\n30,5,8,2,45,0\n", Kind::input, "commas are decimal");
    bad("f\tZ\tphase\n10,5\t8.2\t45\n20,5\t8.2\t45\n30\t8\t4\n", Kind::input, "both points and commas");
    bad("f,Z [mm],phase\n1,2,3\n2,2,3\n3,2,3\n", Kind::input, "does not suit");
    bad("f [Hz],Z [Ohm]\n1,2\n2,2\n3,2\n", Kind::data, "not its phase");
    bad("f [Hz],Z [Ohm],phase\n1,2,1.5\n2,2,0.1\n3,2,-1.5\n", Kind::input, "radians");
    bad("f [Hz],phase(Z) [deg]\n1,2\n2,2\n3,2\n", Kind::input, "not its magnitude");
    bad("f [Hz],Z [Ohm],phase [deg]\n1,2,0\n2,0,0\n3,2,0\n", Kind::input, "not positive");
    bad("f [Hz],x [mm],phase [deg]\n1,2,0\n2,1,0\n3,2,0\n", Kind::data, "what drove");
    bad("f [Hz],SPL [dB],phase [deg]\n1,2000,0\n2,1,0\n3,2,0\n", Kind::input, "1000 dB");
    bad("f [Hz],Z [Ohm],phase [deg]\n1,2,0\n2,1,0\n", Kind::input, "expected at least 3");
    bad("f [Hz],Z [Ohm],phase [deg]\n1,2,0\n3,1,0\n2,1,0\n", Kind::input, "line 4");
    bad("f [Hz],Z [Ohm],Z [Ohm],phase [deg]\n1,2,0,1\n2,1,0,1\n3,1,0,1\n", Kind::input, "more than one column");
    bad("f [Hz],temperature [C]\n1,2\n2,2\n3,2\n", Kind::input, "'temperature [C]'");
    ImportOptions rate;
    rate.sampleRate = 48000;
    refused(Kind::usage, "--rate",
            [&] { responses("f [Hz],Z [Ohm],phase [deg]\n1,2,0\n2,1,0\n3,1,0\n", "a.txt", rate); });
    bad("what is this\n", Kind::input, "no rows of numbers");
    bad("frequency\n1\n2\n3\n", Kind::input, "one column");
    bad("f [Hz],Z [Ohm],phase [deg]\n1,1e308,0\n2,1,0\n3,inf,0\n", Kind::input, "'inf'");
}
