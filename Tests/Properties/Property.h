// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <catch2/catch.hpp>

#include <Eigen/Core>

#include <rapidcheck.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <string>

namespace excursion::test {

/// Asks `times` draws whether something holds; where it does not, the smallest draw that is found is told. Draws are
/// the same at every run, until RC_PARAMS asks for others: RC_PARAMS="seed=7 max_success=10000".
template <class Property>
void holds(const std::string& what, int times, Property property)
{
    rc::detail::TestMetadata about;
    about.id = about.description = what;
    auto drawn = rc::detail::configuration().testParams;
    if (std::getenv("RC_PARAMS") == nullptr) {
        drawn.seed = 1;
        drawn.maxSuccess = times;
    }
    const auto result = rc::detail::checkTestable(std::move(property), about, drawn);
    std::ostringstream told;
    rc::detail::printResultMessage(result, told);
    INFO(what << ": " << told.str());
    CHECK(result.template is<rc::detail::SuccessResult>());
}

/// Any finite number, of any size, the smallest and negative zero among them.
inline rc::Gen<double> anyNumber()
{
    return rc::gen::map(rc::gen::resize(100, rc::gen::arbitrary<std::uint64_t>()), [](std::uint64_t bits) {
        const auto value = std::bit_cast<double>(bits);
        return std::isfinite(value) ? value : std::bit_cast<double>(bits & ~(std::uint64_t {1} << 62));
    });
}

/// A number within +-1 with many digits.
inline double within1() { return *rc::gen::inRange(-1000000007, 1000000008) / 1000000007.0; }
inline int between(int least, int most) { return *rc::gen::inRange(least, most + 1); }

/// Text as people name things, with what JSON has to mask.
inline std::string anyName()
{
    return *rc::gen::container<std::string>(
               rc::gen::oneOf(rc::gen::inRange<char>(32, 127), rc::gen::elementOf(std::string("\"\\/\n\t"))))
           + *rc::gen::element<std::string>("", "\u00e4\u97f3", "\U0001F50A");
}

inline Eigen::MatrixXd anyMatrix(Eigen::Index rows, Eigen::Index columns)
{
    Eigen::MatrixXd matrix(rows, columns);
    for (auto& value : matrix.reshaped())
        value = *anyNumber();
    return matrix;
}

inline Eigen::MatrixXd matrixWithin1(Eigen::Index rows, Eigen::Index columns)
{
    Eigen::MatrixXd matrix(rows, columns);
    for (auto& value : matrix.reshaped())
        value = within1();
    return matrix;
}

}  // namespace excursion::test
