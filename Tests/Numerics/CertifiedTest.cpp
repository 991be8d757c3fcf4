// SPDX-License-Identifier: GPL-3.0-or-later
// Nonlinear regressions of the NIST Statistical Reference Datasets, with their two starts and certified values.
#include "Engine/Numerics/LeastSquares.h"
#include "Engine/Numerics/Search.h"
#include "Engine/Numerics/TallQr.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <complex>
#include <limits>
#include <string>
#include <vector>

using namespace excursion;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

using Complex = std::complex<double>;

struct Regression {
    std::string name;
    Complex (*model)(double x, const std::vector<Complex>& b);
    std::vector<double> x, y;
    std::vector<double> far, near;  ///< starts
    std::vector<double> certified;
    double sumOfSquares;
    bool hardFromAfar = false;  ///< the way from there leads into a valley that ends nowhere
};

const std::vector<Regression>& regressions()
{
    static const std::vector<Regression> all {
        {"Misra1a",
         [](double x, const std::vector<Complex>& b) { return b[0] * (1.0 - std::exp(-b[1] * x)); },
         {77.6, 114.9, 141.1, 190.8, 239.9, 289.0, 332.8, 378.4, 434.8, 477.3, 536.8, 593.1, 689.1, 760.0},
         {10.07, 14.73, 17.94, 23.93, 29.61, 35.18, 40.02, 44.82, 50.76, 55.05, 61.01, 66.40, 75.47, 81.78},
         {500.0, 1e-4},
         {250.0, 5e-4},
         {2.3894212918e+02, 5.5015643181e-04},
         1.2455138894e-01},
        {"BoxBOD",
         [](double x, const std::vector<Complex>& b) { return b[0] * (1.0 - std::exp(-b[1] * x)); },
         {1.0, 2.0, 3.0, 5.0, 7.0, 10.0},
         {109.0, 149.0, 149.0, 191.0, 213.0, 224.0},
         {1.0, 1.0},
         {100.0, 0.75},
         {2.1380940889e+02, 5.4723748542e-01},
         1.1680088766e+03},
        {"Thurber",
         [](double x, const std::vector<Complex>& b) {
             return (b[0] + x * (b[1] + x * (b[2] + x * b[3]))) / (1.0 + x * (b[4] + x * (b[5] + x * b[6])));
         },
         {-3.067, -2.981, -2.921, -2.912, -2.840, -2.797, -2.702, -2.699, -2.633, -2.481, -2.363, -2.322, -1.501,
          -1.460, -1.274, -1.212, -1.100, -1.046, -0.915, -0.714, -0.566, -0.545, -0.400, -0.309, -0.109, -0.103,
          0.010,  0.119,  0.377,  0.790,  0.963,  1.006,  1.115,  1.572,  1.841,  2.047,  2.200},
         {80.574,   84.248,   87.264,   87.195,   89.076,   89.608,   89.868,   90.101,   92.405,   95.854,
          100.696,  101.060,  401.672,  390.724,  567.534,  635.316,  733.054,  759.087,  894.206,  990.785,
          1090.109, 1080.914, 1122.643, 1178.351, 1260.531, 1273.514, 1288.339, 1327.543, 1353.863, 1414.509,
          1425.208, 1421.384, 1442.962, 1464.350, 1468.705, 1447.894, 1457.628},
         {1000.0, 1000.0, 400.0, 40.0, 0.7, 0.3, 0.03},
         {1300.0, 1500.0, 500.0, 75.0, 1.0, 0.4, 0.05},
         {1.2881396800e+03, 1.4910792535e+03, 5.8323836877e+02, 7.5416644291e+01, 9.6629502864e-01, 3.9797285797e-01,
          4.9727297349e-02},
         5.6427082397e+03},
        {"MGH09",
         [](double x, const std::vector<Complex>& b) { return b[0] * x * (x + b[1]) / (x * (x + b[2]) + b[3]); },
         {4.0, 2.0, 1.0, 0.5, 0.25, 0.167, 0.125, 0.1, 0.0833, 0.0714, 0.0625},
         {0.1957, 0.1947, 0.1735, 0.16, 0.0844, 0.0627, 0.0456, 0.0342, 0.0323, 0.0235, 0.0246},
         {25.0, 39.0, 41.5, 39.0},
         {0.25, 0.39, 0.415, 0.39},
         {1.9280693458e-01, 1.9128232873e-01, 1.2305650693e-01, 1.3606233068e-01},
         3.0750560385e-04,
         true},
        {"MGH10",
         [](double x, const std::vector<Complex>& b) { return b[0] * std::exp(b[1] / (x + b[2])); },
         {50.0, 55.0, 60.0, 65.0, 70.0, 75.0, 80.0, 85.0, 90.0, 95.0, 100.0, 105.0, 110.0, 115.0, 120.0, 125.0},
         {34780.0, 28610.0, 23650.0, 19630.0, 16370.0, 13720.0, 11540.0, 9744.0, 8261.0, 7030.0, 6005.0, 5147.0, 4427.0,
          3820.0, 3307.0, 2872.0},
         {2.0, 400000.0, 25000.0},
         {0.02, 4000.0, 250.0},
         {5.6096364710e-03, 6.1813463463e+03, 3.4522363462e+02},
         8.7945855171e+01,
         true},
        {"MGH17",
         [](double x, const std::vector<Complex>& b) {
             return b[0] + b[1] * std::exp(-x * b[3]) + b[2] * std::exp(-x * b[4]);
         },
         {0.0,   10.0,  20.0,  30.0,  40.0,  50.0,  60.0,  70.0,  80.0,  90.0,  100.0,
          110.0, 120.0, 130.0, 140.0, 150.0, 160.0, 170.0, 180.0, 190.0, 200.0, 210.0,
          220.0, 230.0, 240.0, 250.0, 260.0, 270.0, 280.0, 290.0, 300.0, 310.0, 320.0},
         {0.844, 0.908, 0.932, 0.936, 0.925, 0.908, 0.881, 0.850, 0.818, 0.784, 0.751,
          0.718, 0.685, 0.658, 0.628, 0.603, 0.580, 0.558, 0.538, 0.522, 0.506, 0.490,
          0.478, 0.467, 0.457, 0.448, 0.438, 0.431, 0.424, 0.420, 0.414, 0.411, 0.406},
         {50.0, 150.0, -100.0, 1.0, 2.0},
         {0.5, 1.5, -1.0, 0.01, 0.02},
         {3.7541005211e-01, 1.9358469127e+00, -1.4646871366e+00, 1.2867534640e-02, 2.2122699662e-02},
         5.4648946975e-05,
         true},
        {"Rat43",
         [](double x, const std::vector<Complex>& b) {
             return b[0] / std::pow(1.0 + std::exp(b[1] - b[2] * x), 1.0 / b[3]);
         },
         {1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0},
         {16.08, 33.83, 65.80, 97.20, 191.55, 326.20, 386.87, 520.53, 590.03, 651.92, 724.93, 699.56, 689.96, 637.56,
          717.41},
         {100.0, 10.0, 1.0, 1.0},
         {700.0, 5.0, 0.75, 1.3},
         {6.9964151270e+02, 5.2771253025e+00, 7.5962938329e-01, 1.2792483859e+00},
         8.7864049080e+03}};
    return all;
}

/// Derivatives by a complex step, which are exact to rounding.
class RegressionError final : public SearchProblem {
public:
    explicit RegressionError(const Regression& problem) : problem_(problem) {}

    VectorXd error(const VectorXd& b) const
    {
        VectorXd e(rows());
        for (Index n = 0; n < rows(); ++n)
            e[n] = y(n) - at(n, complex(b)).real();
        return e;
    }

    MatrixXd slopes(const VectorXd& b) const  ///< of the model
    {
        constexpr double step = 1e-30;
        MatrixXd J(rows(), b.size());
        for (Index k = 0; k < b.size(); ++k) {
            auto moved = complex(b);
            moved[static_cast<std::size_t>(k)] += Complex(0.0, step);
            for (Index n = 0; n < rows(); ++n)
                J(n, k) = at(n, moved).imag() / step;
        }
        return J;
    }

    double cost(const VectorXd& b) override { return error(b).squaredNorm(); }

    MatrixXd factor(const VectorXd& b) override
    {
        MatrixXd folded(rows(), b.size() + 1);
        folded << slopes(b), error(b);
        TallQr qr(b.size() + 1);
        qr.fold(folded);
        return qr.R();
    }

private:
    Index rows() const { return static_cast<Index>(problem_.x.size()); }
    double y(Index n) const { return problem_.y[static_cast<std::size_t>(n)]; }
    Complex at(Index n, const std::vector<Complex>& b) const
    {
        return problem_.model(problem_.x[static_cast<std::size_t>(n)], b);
    }
    static std::vector<Complex> complex(const VectorXd& b) { return {b.data(), b.data() + b.size()}; }

    const Regression& problem_;
};

VectorXd vectorOf(const std::vector<double>& values)
{
    return Eigen::Map<const VectorXd>(values.data(), static_cast<Index>(values.size()));
}

void isCertified(const Regression& problem, const VectorXd& found, double sumOfSquares, double digits)
{
    REQUIRE(found.size() == static_cast<Index>(problem.certified.size()));
    for (Index k = 0; k < found.size(); ++k)
        CHECK(found[k] == Approx(problem.certified[static_cast<std::size_t>(k)]).epsilon(digits));
    CHECK(sumOfSquares == Approx(problem.sumOfSquares).epsilon(1e-9));
}

}  // namespace

TEST_CASE("The search finds NIST's certified values to six digits, and their sum of squares to nine",
          "[search][certified]")
{
    for (const auto& problem : regressions())
        for (const bool afar : {false, true})
            for (const bool steady : {false, true}) {
                CAPTURE(problem.name, afar, steady);
                RegressionError error(problem);
                SearchOptions options;
                options.maximumIterations = 2000;
                options.costTolerance = 1e-15;
                options.roundingCost = 0.0;
                if (steady)
                    options.damping = Damping::steady();
                if (afar) {  // a column that nearly vanishes asks for much damping
                    options.damping.most = 1e100;
                    options.damping.attempts = 500;
                }
                const auto found = search(error, vectorOf(afar ? problem.far : problem.near), options);
                CAPTURE(found.message, found.iterations, found.finalCost);
                CHECK(found.usable());
                CHECK(found.finalCost < found.initialCost);
                if (afar && problem.hardFromAfar)
                    continue;
                CHECK(found.converged());
                isCertified(problem, found.values, found.finalCost, 1e-6);
            }
}

TEST_CASE("The bounded search finds them too, as far as normal equations let it", "[least-squares][certified]")
{
    for (const auto& problem : regressions()) {
        CAPTURE(problem.name);
        RegressionError error(problem);
        auto b = vectorOf(problem.near);
        const auto evaluate = [&error](const VectorXd& at, bool gradient, NormalEquations& sum) {
            const VectorXd r = -error.error(at);
            sum = NormalEquations(r);
            if (gradient)
                sum.differentiateBy(error.slopes(at), r);
            return std::isfinite(sum.cost);
        };
        LeastSquaresOptions options;
        options.maximumIterations = 500;
        options.costTolerance = 1e-15;
        const VectorXd free = VectorXd::Constant(b.size(), std::numeric_limits<double>::infinity());
        const auto found = minimize(evaluate, b, -free, free, options);
        CAPTURE(found.message, found.iterations, found.finalCost);
        CHECK(found.usable());
        isCertified(problem, b, found.finalCost, 1e-5);
    }
}
