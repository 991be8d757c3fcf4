// SPDX-License-Identifier: GPL-3.0-or-later
// The Mittag-Leffler function against closed forms, and against its series summed with 180 digits by mpmath.
#include "Engine/Fractional/MittagLeffler.h"
#include "Scratch.h"

#include <cmath>
#include <limits>
#include <numbers>

using namespace excursion;
using namespace excursion::test;
using Complex = std::complex<double>;

namespace {

double relativeError(Complex found, Complex truth) { return std::abs(found - truth) / std::abs(truth); }

}  // namespace

TEST_CASE("The Mittag-Leffler function is the exponential, circular and error functions where it should be")
{
    for (const double x : {-700.0, -30.0, -3.7, -0.91, -0.2, 0.0, 0.4, 1.0, 2.2, 25.0, 500.0}) {
        INFO("at " << x);
        CHECK(mittagLeffler(1.0, 1.0, x) == Approx(std::exp(x)).epsilon(1e-14).margin(0.0));
        CHECK(mittagLeffler(1.0, 0.0, x) == Approx(x * std::exp(x)).epsilon(1e-14).margin(1e-300));
        CHECK(mittagLeffler(1.0, 2.0, x) == Approx(x == 0.0 ? 1.0 : std::expm1(x) / x).epsilon(2e-14).margin(0.0));
        const double root = std::sqrt(std::abs(x));
        CHECK(std::abs(mittagLeffler(2.0, 1.0, x) - (x < 0.0 ? std::cos(root) : std::cosh(root)))
              < 1e-13 * std::cosh(x < 0.0 ? 0.0 : root));
        if (x != 0.0)
            CHECK(std::abs(mittagLeffler(2.0, 2.0, x) - (x < 0.0 ? std::sin(root) : std::sinh(root)) / root)
                  < 1e-13 * (1.0 + (x < 0.0 ? 0.0 : std::sinh(root))) / root);
    }
    // exp(z^2) erfc(-z), its erfc free of cancellation
    for (const double x : {-5.0, -2.0, -1.0, -0.3, 0.7, 1.5, 4.0, 20.0}) {
        const double truth = std::exp(x * x) * std::erfc(-x);
        CHECK(mittagLeffler(0.5, 1.0, x) == Approx(truth).epsilon(1e-12).margin(0.0));
    }
    // Complex arguments: exp(z) and (exp(z) - 1)/z
    for (const Complex z : {Complex(3.0, 4.0), Complex(-6.0, 20.0), Complex(-0.1, -9.0), Complex(0.0, 300.0)}) {
        CHECK(relativeError(mittagLeffler(1.0, 1.0, z), std::exp(z)) < 1e-14);
        CHECK(relativeError(mittagLeffler(1.0, 2.0, z), (std::exp(z) - 1.0) / z) < 1e-13);
    }
}

TEST_CASE("The Mittag-Leffler function agrees with its series in 180 digits")
{
    struct Reference {
        double alpha, beta;
        Complex z, value;
    };
    const Reference references[] = {
        {0.1, 1.0, {1.0, 0.0}, {23.160534598113205163, 0.0}},
        {0.1, -1.5, {-1.1161231740339044, 0.0}, {0.20729130834613073086, 0.0}},
        {0.25, 1.0, {-3.1185212585399205, 1.1087273380493117}, {0.19632253182953455712, 0.05623325232984851452}},
        {0.25, 5.0, {-0.4161468365471424, 0.9092974268256817}, {0.026271279352100393219, 0.012782717555506591119}},
        {0.4, 0.5, {2.6814496271023662, 1.9481871907939856}, {-4.0106386517778703664, 10.436786620316182418}},
        {0.4, 0.4, {0.7240096715797808, 0.2239624364875844}, {1.9258473955246661705, 1.6216382531319679788}},
        {0.5, 2.0, {1.7320508075688772, 0.0}, {12.309774183076729987, 0.0}},
        {0.5, 0.5, {-4.47213595499958, 0.0}, {0.013160091923529428183, 0.0}},
        {0.7, 0.0, {-0.5800058854214944, 0.20620939480059527}, {-0.21262527454840268711, 0.016983350278428785062}},
        {0.7, 1.7, {-0.8979072451763774, 1.961963124221719}, {0.28327881864965319458, 0.35471395486735453361}},
        {0.9, 0.0, {11.63042440427192, 73.43160969878541}, {-77.414572826177117444, 108.55622574037347357}},
        {0.99, 1.0, {0.955336489125606, 0.29552020666133955}, {2.5034221441595323651, 0.77189199064340080174}},
        {0.99, -1.5, {19.4097390078592, 0.0}, {876656450305.711285, 0.0}},
        {1.0, 1.0, {-120.0, 0.0}, {7.6676480737219996324e-53, 0.0}},
        {1.0, 5.0, {-0.9422223406686581, 0.3349881501559051}, {0.034794256456149262067, 0.0020625883389660564401}},
        {1.3, 0.5, {-20.44492830506509, 44.67298334809098}, {-2.1818709330061064485, 6.1915180004561758072}},
        {1.3, 1.3, {-0.18437743566820586, 0.36186109222052093}, {0.96897832891279402743, 0.22770187582752573652}},
        {1.7, 2.0, {6.183900583875306, 1.9129046145747464}, {3.4766714304333890955, 1.3069350099665080677}},
        {1.7, 1.7, {3424.586326197458, 0.0}, {2.6882028350664604986e+50, 0.0}},
        {2.0, 0.0, {-0.25, 0.0}, {-0.23971276930210150014, 0.0}},
        {2.0, 3.0, {-8.480001066017923, 3.014893351403146}, {0.22491010847584529833, 0.06840098460325184494}},
        {2.5, 0.0, {-65644.70676805013, 143436.30110030278}, {4.5935942654931474113e+37, -8.6342790590818881494e+37}},
        {3.0, 1.0, {0.0707372016677029, 0.9974949866040544}, {1.0104139651407475985, 0.16644247005164140135}},
        {3.0, -1.5, {7642.691913004848, 2364.1616532907165}, {-163768915758.99849885, 204237154789.52859471}},
        {0.05, -2.0, {1.1076215334108885, 0.468294873254488}, {-0.46102108610842653219, -0.41720156271034960257}},
        {0.3, -2.0, {0.08144864620875797, 1.148541564318312}, {-0.42573637151923437972, 0.10035641190004811501}},
        {0.75, -2.0, {-0.5946035575013605, 0.0}, {-0.24015135185254749464, 0.0}},
        {1.0, -3.3, {9.210609940028851, 3.8941834230865053}, {156558772.98130316113, -123780196.65810739903}},
        {1.6, -3.3, {0.12818484391369087, 1.807588314889614}, {6.204137332409452862, -6.0131991484333699402}},
        {3.0, 12.0, {-1000.0, 0.0}, {1.6018099779300977143e-8, 0.0}},
    };
    for (const auto& r : references) {
        INFO("alpha " << r.alpha << ", beta " << r.beta << ", z " << r.z);
        const double condition = 1.0 + std::pow(std::abs(r.z), 1.0 / r.alpha) / r.alpha;
        if (r.beta >= -1.5 && r.beta <= 5.0)
            CHECK(relativeError(mittagLeffler(r.alpha, r.beta, r.z), r.value) < 5e-14 * condition);
        CHECK(relativeError(mittagLeffler(r.alpha, r.beta, r.z), r.value) < 1e-12);
    }
}

TEST_CASE("Far out the Mittag-Leffler function follows its algebraic tail")
{
    // exp(x^2) erfc(x) = (1 - 1/(2 x^2) + 3/(4 x^4) - ..)/(x sqrt(pi)); E_{1/2,1/2}(-x), whose first term vanishes, is
    // 1/(2 x^2 sqrt(pi)) (1 - 3/(2 x^2) ..)
    for (const double x : {1e4, 1e7}) {
        CHECK(mittagLeffler(0.5, 1.0, -x)
              == Approx((1.0 - 0.5 / (x * x)) / (x * std::sqrt(std::numbers::pi))).epsilon(1e-13).margin(0.0));
        CHECK(
            mittagLeffler(0.5, 0.5, -x)
            == Approx((1.0 - 1.5 / (x * x)) / (2.0 * x * x * std::sqrt(std::numbers::pi))).epsilon(1e-13).margin(0.0));
    }
    CHECK(mittagLeffler(0.5, 1.0, 50.0) == std::numeric_limits<double>::infinity());
    CHECK(mittagLeffler(0.1, 1.0, 1e5) == std::numeric_limits<double>::infinity());
}

TEST_CASE("A Mittag-Leffler function that does not exist is refused")
{
    refused(Error::Kind::usage, "0.05 to 3", [] { mittagLeffler(0.0, 1.0, 1.0); });
    refused(Error::Kind::usage, "finite", [] { mittagLeffler(0.5, 1.0, std::nan("")); });
}
