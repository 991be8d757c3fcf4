// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/Response.h"
#include "Engine/Linear/SecondOrderSections.h"
#include "Linear/Problem.h"

#include <numbers>

using namespace excursion;
using namespace excursion::test;
using Complex = std::complex<double>;

TEST_CASE("Sections hold any poles, mirror what is unstable, and slopes are derivatives")
{
    for (const double rate : {0.0, 48000.0}) {
        const std::vector<Complex> roots =
            rate == 0.0 ? std::vector<Complex> {{-300, 5000}, {-300, -5000}, {-20, 0}, {-9000, 0}, {-4000, 0}}
                        : std::vector<Complex> {{0.9, 0.3}, {0.9, -0.3}, {0.99, 0}, {-0.4, 0}, {0.2, 0}};
        const auto sections = sectionsOf(roots, rate, rate == 0.0 ? 1e4 : 1.0);
        CHECK(isStable(sections));
        for (const auto& root : roots) {
            double nearest = 1e9;
            for (const auto& pole : poles(sections))
                nearest = std::min(nearest, std::abs(pole - root));
            CHECK(nearest < 1e-12 * std::max(1.0, std::abs(root)));
        }
        const std::vector<double> f {10.0, 333.0, 1500.0, 20000.0};
        const auto lambda = evaluationPoints(f, rate);
        const Eigen::VectorXd c = Eigen::VectorXd::LinSpaced(5, 0.5, 2.0);
        const auto basis = partialFractions(sections, lambda);
        const auto slopes = partialFractionSlopes(sections, lambda, basis, c);
        for (Eigen::Index j = 0; j < 5; ++j) {
            auto up = sections, down = sections;
            const double h = 1e-5 * std::abs(sections.factors[j]);
            up.factors[j] += h;
            down.factors[j] -= h;
            const Eigen::VectorXcd numeric = (partialFractions(up, lambda) - partialFractions(down, lambda)) * c
                                             / (2.0 * h);
            CHECK((numeric - slopes.col(j)).norm() < 1e-6 * slopes.col(j).norm());
        }
        // The realization has that response.
        const auto model = realize(sections, c.transpose(), Eigen::VectorXd::Constant(1, 0.25));
        const Eigen::VectorXcd wanted = basis * c + Eigen::VectorXcd::Constant(4, 0.25);
        for (std::size_t k = 0; k < f.size(); ++k)
            CHECK(std::abs(respond(model, {f[k]})[0](0, 0) - wanted[static_cast<Eigen::Index>(k)])
                  < 1e-12 * wanted.norm());
    }
    const auto outside = sectionsOf({{1.2, 0.5}, {1.2, -0.5}, {-3.0, 0.0}}, 1.0, 1.0);
    CHECK_FALSE(isStable(outside));
    const auto inside = poles(mirrored(outside));
    CHECK(std::abs(inside[0] - Complex(1.2, -0.5) / 1.69) < 1e-12);
    CHECK(std::abs(inside[2] - Complex(-1.0 / 3.0, 0.0)) < 1e-12);
    CHECK(isStable(mirrored(outside)));
}
