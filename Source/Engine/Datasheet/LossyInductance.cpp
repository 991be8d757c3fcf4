// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Datasheet/LossyInductance.h"

#include "Engine/Datasheet/Impedances.h"
#include "Engine/Datasheet/ResponseCurves.h"
#include "Engine/Error.h"
#include "Engine/Loudspeaker/Resonance.h"
#include "Engine/Numerics/TrustRegion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace excursion {
namespace {

using Complex = std::complex<double>;
using std::numbers::pi;

/// What a form is: its words, its law, and places to start from.
struct FormKind {
    const char* id;
    const char* formula;
    std::vector<std::pair<const char*, const char*>> parameters;  ///< name, unit
    Complex (*law)(const std::vector<double>&, double omega);
};

Complex beside(Complex a, Complex b) { return a * b / (a + b); }
Complex inductor(double L, double omega) { return {0.0, omega * L}; }
/// L beside R; nothing where one of them is nothing.
Complex cellLaw(double L, double R, double omega)
{
    return L > 0.0 && R > 0.0 ? beside(inductor(L, omega), R) : Complex(0.0);
}

const std::vector<FormKind>& kinds()
{
    static const std::vector<FormKind> list {
        {"lr2",
         "j w Le + j w L2 || R2",
         {{"Le", "H"}, {"L2", "H"}, {"R2", "ohm"}},
         [](const std::vector<double>& p, double w) { return inductor(p[0], w) + cellLaw(p[1], p[2], w); }},
        {"lr3",
         "j w Le + j w L2 || R2 + j w L3 || R3",
         {{"Le", "H"}, {"L2", "H"}, {"R2", "ohm"}, {"L3", "H"}, {"R3", "ohm"}},
         [](const std::vector<double>& p, double w) {
             return inductor(p[0], w) + cellLaw(p[1], p[2], w) + cellLaw(p[3], p[4], w);
         }},
        {"semi-inductance",
         "K w^n exp(j n pi/2)",
         {{"K", "ohm s^n"}, {"n", "1"}},
         [](const std::vector<double>& p, double w) { return std::polar(p[0] * std::pow(w, p[1]), 0.5 * pi * p[1]); }},
        {"wright",
         "Kr w^Er + j Kx w^Ex",
         {{"Kr", "ohm s^Er"}, {"Er", "1"}, {"Kx", "ohm s^Ex"}, {"Ex", "1"}},
         [](const std::vector<double>& p, double w) {
             return Complex(p[0] * std::pow(w, p[1]), p[2] * std::pow(w, p[3]));
         }},
        {"thorborg-futtrup",
         "j w Leb + j w Le || Ke (j w)^1/2 || Rss",
         {{"Leb", "H"}, {"Le", "H"}, {"Ke", "ohm s^1/2"}, {"Rss", "ohm"}},
         [](const std::vector<double>& p, double w) {
             const auto semi = std::polar(p[2] * std::sqrt(w), 0.25 * pi);
             return inductor(p[0], w) + (p[1] > 0.0 ? beside(beside(inductor(p[1], w), semi), p[3]) : Complex(0.0));
         }}};
    return list;
}

const FormKind& kindNamed(const std::string& id)
{
    for (const auto& kind : kinds())
        if (id == kind.id)
            return kind;
    throw std::out_of_range(id);
}

/// The impedance that is to be met.
struct Target {
    double Re;
    std::vector<double> omega;
    std::vector<Complex> whole;  ///< with Re

    Complex lossy(std::size_t k) const { return whole[k] - Re; }
};

std::vector<std::vector<double>> startsOf(const FormKind& kind, const Target& target)
{
    const std::size_t last = target.omega.size() - 1, middle = last / 2;
    const double low = target.omega.front(), high = target.omega.back(), size = std::abs(target.lossy(middle));
    const double atTop = std::max(target.lossy(last).imag() / high, 1e-9),
                 atBottom = std::max(target.lossy(0).imag() / low, 1e-9);
    const double slope = std::clamp(
        std::log(std::abs(target.lossy(last)) / std::abs(target.lossy(0))) / std::log(high / low), 0.05, 0.99);
    const double K = size / std::pow(target.omega[middle], slope);
    const std::string id = kind.id;
    if (id == "semi-inductance")
        return {{K, slope}};
    if (id == "wright")
        return {{K * std::cos(0.5 * pi * slope), slope, K * std::sin(0.5 * pi * slope), slope}};
    std::vector<std::vector<double>> starts;
    if (id == "thorborg-futtrup") {
        for (const double share : {0.1, 0.5})
            for (const double shunt : {1.0, 10.0})
                starts.push_back({share * atTop, 2.0 * atBottom, size / std::sqrt(target.omega[middle]),
                                  shunt * std::abs(target.lossy(last))});
        return starts;
    }
    const auto turn = [&](double share) {
        return low * std::pow(high / low, share);
    };  // the w at which a cell turns from L to R
    for (const double first : {0.0, 0.3, 0.6, 0.9}) {
        const double L2 = 0.5 * atBottom;
        if (id == "lr2")
            starts.push_back({0.5 * atTop, L2, L2 * turn(first)});
        else
            for (const double second : {0.5, 0.8, 1.1})
                if (second > first)
                    starts.push_back({0.4 * atTop, L2, L2 * turn(first), 0.4 * atTop, 0.4 * atTop * turn(second)});
    }
    return starts;
}

double costOf(const FormKind& kind, const std::vector<double>& p, const Target& target)
{
    double cost = 0.0;
    for (std::size_t k = 0; k < target.omega.size(); ++k)
        cost += std::norm((target.Re + kind.law(p, target.omega[k]) - target.whole[k]) / target.whole[k]);
    return cost;
}

/// Searches over logarithms from one start. @returns the cost
double search(const FormKind& kind, std::vector<double>& p, const Target& target)
{
    const auto start = p;
    const auto count = static_cast<Eigen::Index>(p.size()), rows = static_cast<Eigen::Index>(2 * target.omega.size());
    const auto at = [&](const Eigen::VectorXd& y) {
        auto values = start;
        for (Eigen::Index k = 0; k < count; ++k)
            // the search divides by |y|: its start is 1
            values[static_cast<std::size_t>(k)] *= std::exp(y[k] - 1.0);
        return values;
    };
    const auto residual = [&](const Eigen::VectorXd& y) {
        const auto values = at(y);
        Eigen::VectorXd r(rows);
        for (std::size_t k = 0; k < target.omega.size(); ++k) {
            const auto e = (target.Re + kind.law(values, target.omega[k]) - target.whole[k]) / target.whole[k];
            r[static_cast<Eigen::Index>(2 * k)] = e.real();
            r[static_cast<Eigen::Index>(2 * k + 1)] = e.imag();
        }
        return r;
    };
    const auto evaluate = [&](const Eigen::VectorXd& y, bool gradient, NormalEquations& sum) {
        const auto r = residual(y);
        sum.cost = r.squaredNorm();
        sum.rows = static_cast<double>(rows);
        if (gradient) {
            Eigen::MatrixXd J(rows, count);
            constexpr double step = 1e-5;
            for (Eigen::Index k = 0; k < count; ++k) {
                auto above = y, below = y;
                above[k] += step;
                below[k] -= step;
                J.col(k) = (residual(above) - residual(below)) / (2.0 * step);
            }
            sum.N = J.transpose() * J;
            sum.g = J.transpose() * r;
        }
        return std::isfinite(sum.cost);
    };
    constexpr double reach = 16.0;  // no parameter goes farther than exp(reach)
    Eigen::VectorXd y = Eigen::VectorXd::Ones(count);
    minimizeInTrustRegion(evaluate, y, Eigen::VectorXd::Constant(count, 1.0 - reach),
                          Eigen::VectorXd::Constant(count, 1.0 + reach), {200, 1e-12});
    p = at(y);
    return costOf(kind, p, target);
}

LossyForm fitted(const FormKind& kind, const Target& target)
{
    std::vector<double> best;
    double lowest = std::numeric_limits<double>::infinity();
    for (auto start : startsOf(kind, target))
        if (const double cost = search(kind, start, target); cost < lowest) {
            lowest = cost;
            best = start;
        }
    // A search over logarithms never reaches zero: what makes no difference is not there.
    constexpr double difference = 1e-4;
    for (auto& value : best) {
        const double kept = std::exchange(value, 0.0);
        if (!(costOf(kind, best, target) < (1.0 + difference) * lowest))
            value = kept;
    }
    LossyForm form {kind.id,
                    kind.formula,
                    {},
                    100.0 * std::sqrt(costOf(kind, best, target) / static_cast<double>(target.omega.size())),
                    0.0};
    for (std::size_t k = 0; k < best.size(); ++k)
        form.parameters.push_back({kind.parameters[k].first, kind.parameters[k].second, best[k]});
    for (std::size_t k = 0; k < target.omega.size(); ++k)
        form.worstDb = std::max(
            form.worstDb,
            std::abs(20.0 * std::log10(std::abs((target.Re + impedanceOf(form, target.omega[k])) / target.whole[k]))));
    return form;
}

}  // namespace

std::complex<double> impedanceOf(const LossyForm& form, double omega)
{
    std::vector<double> values;
    for (const auto& p : form.parameters)
        values.push_back(p.value);
    return kindNamed(form.id).law(values, omega);
}

std::pair<double, double> bandOf(const Model& model)
{
    std::pair<double, double> band {10.0, 10000.0};
    for (std::size_t k = 1; k < model.components.size(); ++k)
        band = {model.components[k].operatingRange.lowFrequency, model.components[k].operatingRange.highFrequency};
    return band;
}

LossyInductance lossyInductance(const Model& model, double low, double high)
{
    if (!model.electrical())
        throw Error(Error::Kind::data, "The model has no coil, and so no inductance.");
    const auto band = bandOf(model);
    LossyInductance result;
    result.high = high > 0.0 ? high : band.second;
    result.low = low > 0.0 ? low : std::min(std::max(band.first, 3.0 * resonanceOf(model)), 0.1 * result.high);
    if (!(result.high >= 2.0 * result.low) || !std::isfinite(result.high))
        throw Error(
            Error::Kind::usage,
            "The band of the inductance must span at least an octave, from a lower to a higher frequency in Hz.");
    result.Re = coilResistance(model, resistanceFrequency(model));

    const auto frequency = curveFrequencies(result.low, result.high, 24.0);
    Target target {result.Re, {}, blockedImpedance(model, frequency)};
    double loss = 0.0;
    for (std::size_t k = 0; k < frequency.size(); ++k) {
        target.omega.push_back(2.0 * pi * frequency[k]);
        loss = std::max(loss, std::abs(target.lossy(k).real()) / std::abs(target.whole[k]));
    }
    constexpr double something = 1e-6;
    if (loss < something) {
        result.lossless = true;
        result.Le = model.baseParameter("Le").value;
        return result;
    }
    for (const auto& kind : kinds())
        result.forms.push_back(fitted(kind, target));
    return result;
}

}  // namespace excursion
