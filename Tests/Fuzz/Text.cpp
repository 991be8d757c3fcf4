// SPDX-License-Identifier: GPL-3.0-or-later
// All text readers: CSV, ZMA, FRD, exports of other programs, impulse responses of REW. The first byte chooses ending
// and options.
#include "Engine/Import/ImportText.h"
#include "Engine/Import/PlainText.h"
#include "Fuzz/Target.h"

#include <array>

using namespace excursion;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    if (size == 0)
        return 0;
    static constexpr std::array endings {".csv", ".txt", ".zma", ".frd"};
    static constexpr std::array<const char*, 4> mappings {"2=voltage:mV", "2=impedance.magnitude:kohm",
                                                          "G_re=impedance.re", "1=time:ms"};
    const unsigned choice = data[0];
    const auto source = std::string("fuzz") + endings[choice % 4];
    ImportOptions options;
    options.minimumPhase = (choice & 4) != 0;
    if ((choice & 0x18) == 0x08)
        options.as = responseNamed("impedance");
    if ((choice & 0x18) == 0x10)
        options.as = responseNamed("displacement/voltage");
    if ((choice & 0x18) == 0x18)
        addMapping(options, mappings[choice >> 6]);
    if ((choice & 0x20) != 0)
        options.sampleRate = 48000;
    try {
        fuzz::demandSound(
            importText(plainText({reinterpret_cast<const char*>(data) + 1, size - 1}, source), source, options));
    } catch (const Error& e) {
        fuzz::demand(std::string(e.what()).size() > 10, "a sentence");
    }
    return 0;
}

std::vector<std::string> fuzz::seeds()
{
    std::string impulse = "* Impulse Response data saved by REW V5.40\n* IR is normalised\n* Response measured over: "
                          "20,1 to 19.999,9 Hz\n"
                          "0.5 // Peak value before normalisation\n10 // Peak index\n80 // Response "
                          "length\n2.0833333333333333E-5 // Sample interval (seconds)\n"
                          "-0.001 // Start time (seconds)\n94.0 // Data offset (dB)\n* Data start\n";
    for (int n = 0; n < 80; ++n)
        impulse += n == 10 ? "1.0\n" : "0.001\n";
    std::vector<std::string> all;
    for (const std::string& text :
         {std::string("* Freq(Hz)\tZ(Ohms)\tPhase(degrees)\n10.5\t8.25\t45\n21\t30\t-0.5\n42\t6.5\t-30\n"),
          std::string("* Freq(Hz) SPL(dB) Phase(degrees)\n20 94.0 -90.0\n1000 100 180\n2000 80 0\n"),
          std::string("10,5;8,25;45\r\n21;30;-0,5\r\n42;6,5;-30\r\n"),
          std::string("10 8 90\n20 4 -45\n30 2 0\n30 2 0\n"),
          std::string("frequency_hz,u_re_v,u_im_v,i_re_a,i_im_a\n1,2,3,4,5\n2,2,3,4,5\n3,2,3,4,5\n"),
          std::string("time [ms],voltage [V],current [mA],x [um]\n0,1,2,3\n1,-1,2,3\n2,1,-2,3\n3,0,0,0\n"),
          std::string(
              "frq\timp\tmax\tmin\n18.750\t3.7263\t4.4030\t3.0445\n23.438\t4.5925\t5.4\t3.1\n28.125\t5.1\t6.4\t3\n"),
          std::string("\"Magnitude of Z(f)\"\n\"Measured\"\t\t\"Fitted\"\n\"Frequency [Hz]\"\t\"[Ohm]\"\t\"Frequency "
                      "[Hz]\"\t\"[Ohm]\"\n10\t6\t11\t6\n20\t9\t21\t9\n"
                      "40\t7\t41\t7\n"),
          std::string("f_hz,G_re,G_im\n10,3,4\n20,-1,0.5\n40,0.25,-7\n"),
          std::string("\xFF\xFE"
                      "1\0 \0"
                      "2\0\n\0",
                      10),
          impulse})
        for (const char choice : {'\0', '\1', '\2', '\3', '\6', '\x0c', '\x10', '\x3a', '\x78', '\xb8', '\xf8'})
            all.push_back(choice + text);
    return all;
}
