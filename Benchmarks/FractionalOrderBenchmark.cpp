// SPDX-License-Identifier: GPL-3.0-or-later
// Measured impedances (EXCURSION_DATA, else ../shared/data) by models of integer order 1 .. 10, of order 1/2 and of
// free order, and by a resonance with R + L s or R + L s^alpha: error over the number of parameters, and with how many
// each comes within 1 dB of the best. A file name as argument receives all as CSV.
#include "RealData/OrderComparison.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>

int main(int argc, char** argv)
{
    using namespace excursion::test;
    const char* given = std::getenv("EXCURSION_DATA");
    const std::filesystem::path data = given ? given : "../shared/data";
    std::ofstream csv;
    if (argc > 1) {
        csv.open(argv[1]);
        csv << "driver,family,parameters,alpha,errorDb,stable\n";
    }
    for (const auto& driver : measuredDrivers()) {
        if (!std::filesystem::exists(data / driver)) {
            std::printf("%s is not at hand in %s\n", driver.c_str(), data.c_str());
            continue;
        }
        const auto families = compareOrders(measuredImpedance(data / driver), 10, 6);
        std::printf("\n%s\n%-14s", driver.c_str(), "parameters");
        for (int P = 3; P <= 21; ++P)
            std::printf("%7d", P);
        double best = 0.0;
        for (const auto& family : families) {
            std::printf("\n%-14s", family.name.c_str());
            for (int P = 3; P <= 21; ++P) {
                const auto member = std::find_if(family.members.begin(), family.members.end(),
                                                 [P](const auto& m) { return m.parameters == P; });
                if (member != family.members.end())
                    std::printf("%7.1f", member->errorDb);
                else
                    std::printf("%7s", "");
            }
            for (const auto& member : family.members) {
                best = std::min(best, member.errorDb);
                if (csv)
                    csv << driver.stem().string() << ',' << family.name << ',' << member.parameters << ','
                        << member.alpha << ',' << member.errorDb << ',' << member.stable << '\n';
            }
        }
        std::printf("\nwithin 1 dB of the best, %.1f dB:", best);
        for (const auto& family : families)
            if (const int fewest = family.fewestFor(best + 1.0))
                std::printf("  %s with %d parameters", family.name.c_str(), fewest);
        std::printf("\n");
        std::fflush(stdout);
    }
    return 0;
}
