// SPDX-License-Identifier: GPL-3.0-or-later
// Measured impedances by models of integer, fractional and mixed order: what an order that is no integer is worth in
// parameters.
#include "RealData/OrderComparison.h"
#include "Scratch.h"

#include <algorithm>
#include <iterator>

using namespace excursion;
using namespace excursion::test;

namespace {

/// The error in dB that was reached with so many parameters at most: by the families integer, order 1/2, free order,
/// and R + L s^alpha.
struct Reached {
    const char* file;
    double integer7, integer9, integer21, half9, free10, mixed6;
};

constexpr Reached reached[] {
    {"novak", -18.6, -27.4, -32.8, -25.4, -29.4, -26.1},
    {"L16RNX_0g_242_27mV", -19.8, -28.5, -45.8, -34.5, -35.1, -28.1},
    {"L16RNX_8_017g_242_27mV", -19.6, -26.9, -43.1, -32.6, -34.1, -28.9},
    {"L16RNX_16_048g_242_27mV", -19.3, -26.9, -45.2, -33.4, -34.5, -29.7},
    {"Morel_CAW938_caw938", -17.4, -25.9, -41.0, -31.8, -32.0, -27.8},
    {"Morel_CAW938_sb26adc", -31.8, -40.9, -52.1, -40.1, -43.1, -38.3},
    {"Sealed_SIG120_DX25TG59_Woofer", -19.6, -31.1, -36.4, -28.5, -34.2, -31.4},
    {"SB15NRX2C30-4_SB26STCN-4_Woofer", -12.5, -13.8, -32.2, -13.4, -13.9, -13.3},  // two resonances
};

}  // namespace

TEST_CASE("Measured impedances: a fractional order is worth parameters where few are spent, and nothing where many are",
          "[slow]")
{
    if (dataFolder("impedance").empty() || dataFolder("novak").empty() || dataFolder("seas-l16rnx").empty())
        return;
    for (const auto& driver : measuredDrivers()) {
        INFO(driver);
        const auto families = compareOrders(
            measuredImpedance(dataFolder(driver.parent_path().string()) / driver.filename()), 10, 4);
        const auto errorOf = [&](std::size_t family, int parameters) {
            return families[family].within(parameters)->errorDb;
        };
        const auto row = std::find_if(std::begin(reached), std::end(reached),
                                      [&](const Reached& r) { return driver.stem() == std::string(r.file); });
        REQUIRE(row != std::end(reached));
        CHECK(errorOf(0, 7) <= row->integer7 + 0.2);
        CHECK(errorOf(0, 9) <= row->integer9 + 0.2);
        CHECK(errorOf(0, 21) <= row->integer21 + 0.5);  // of higher orders there are many minima
        CHECK(errorOf(1, 9) <= row->half9 + 0.2);
        CHECK(errorOf(2, 10) <= row->free10 + 0.5);
        CHECK(errorOf(4, 6) <= row->mixed6 + 0.1);
        for (const auto& family : families)
            for (const auto& member : family.members)
                CHECK(member.stable);
        if (row == std::prev(std::end(reached)))
            continue;
        // One more parameter than R + L s takes 10 dB and more off, where an integer order asks for three more, or
        // five.
        CHECK(errorOf(4, 6) < errorOf(3, 5) - 10.0);
        CHECK(errorOf(4, 6) < errorOf(0, 7) - 6.0);
        CHECK(families[0].fewestFor(errorOf(4, 6)) >= 9);
        CHECK(families[4].members[0].alpha == Approx(0.69).margin(0.08));
    }
}
