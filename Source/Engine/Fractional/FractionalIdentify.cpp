// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Fractional/FractionalIdentify.h"

#include "Engine/Error.h"
#include "Engine/Linear/Response.h"
#include "Engine/Linear/TallQr.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>

namespace excursion {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

constexpr double notKnown = std::numeric_limits<double>::quiet_NaN();
constexpr double asWell = 2.0;   // a rise of V that two standard errors make

/// The best fit at one alpha.
struct Point {
    double alpha = 0.0, V = std::numeric_limits<double>::infinity();
    PartialFractionFit fit;
    std::string start, reason;
};

IdentifyOptions linearOptions(const FractionalOptions& options, double alpha)
{
    IdentifyOptions result;
    result.order = options.order;
    result.alpha = alpha;
    result.thorough = options.thorough;
    result.refinement = options.refinement;
    return result;
}

/// V up to a factor, which is 1 with deviations: sum |e|^2/sigma^2, else the cost.
double deviance(const PartialFractionFit& fit, const FrequencyData& data)
{
    if (data.deviation.size() == 0)
        return fit.cost;
    const Eigen::MatrixXcd basis = partialFractions(fit.sections, evaluationPoints(data.frequency, 0.0, fit.sections.alpha));
    Eigen::MatrixXcd error = basis * fit.C.transpose() - data.value;
    error.rowwise() += fit.D.transpose().cast<Complex>();
    return error.cwiseAbs().cwiseQuotient(data.deviation).squaredNorm();
}

/// The poles at another alpha: lambda^(alpha'/alpha) is the same s. Pairs that would pass the negative axis stay just before it.
Sections carried(const Sections& sections, double alpha)
{
    const double ratio = alpha / sections.alpha;
    auto roots = poles(sections);
    for (auto& root : roots) {
        const double size = std::pow(std::abs(root), ratio);
        root = root.imag() == 0.0 ? Complex(std::copysign(size, root.real()), 0.0)
                                  : std::polar(size, std::copysign(std::min(std::abs(std::arg(root)) * ratio, 0.99 * std::numbers::pi), root.imag()));
    }
    return mirrored(sectionsOf(roots, 0.0, std::pow(sections.scale, ratio), alpha));
}

/// The curve V(alpha): its points on the grid, and any other from the nearest.
class Curve {
public:
    Curve(const FrequencyData& data, const FractionalOptions& options) : data_(data), options_(options) {}

    void search(const Progress& progress)
    {
        const auto steps = static_cast<int>(std::ceil((options_.mostAlpha - options_.leastAlpha) / options_.gridStep - 1e-9));
        for (int k = 0; k <= steps; ++k) {
            const double alpha = options_.leastAlpha + (options_.mostAlpha - options_.leastAlpha) * k / steps;
            const auto part = progress.part(0.8 * k / (steps + 1.0), 0.8 * (k + 1.0) / (steps + 1.0));
            try {
                auto found = identify(data_, linearOptions(options_, alpha), part);
                Point point {alpha, 0.0, fitPartialFractions(*found.sections, data_), found.start, found.reason};
                point.V = deviance(point.fit, data_);
                points_.push_back(std::move(point));
            } catch (const Error& e) {
                if (e.kind() != Error::Kind::numerical)
                    throw;
            }
        }
        if (points_.empty())
            throw Error(Error::Kind::numerical, "No alpha gave a model of order " + std::to_string(options_.order) + ".");
        // What one alpha has found may serve its neighbours.
        for (std::size_t k = 1; k < points_.size(); ++k)
            offer(points_[k - 1], points_[k]);
        for (std::size_t k = points_.size() - 1; k-- > 0;)
            offer(points_[k + 1], points_[k]);
    }

    Point at(double alpha, const Point& near) const
    {
        Point point {alpha, std::numeric_limits<double>::infinity(), {}, near.start, near.reason};
        const auto start = carried(near.fit.sections, alpha);
        if (!start.factors.allFinite())
            return point;
        auto refined = refinePoles(start, data_, options_.refinement);
        point.fit = std::move(refined.fit);
        point.reason = refined.reason;
        point.V = deviance(point.fit, data_);
        return point;
    }

    const std::vector<Point>& points() const { return points_; }

private:
    void offer(const Point& from, Point& to) const
    {
        auto trial = at(to.alpha, from);
        if (trial.V < to.V)
            to = std::move(trial);
    }

    const FrequencyData& data_;
    const FractionalOptions& options_;
    std::vector<Point> points_;
};

/// The lowest point between two alphas, by golden section; the poles go along.
Point lowestBetween(const Curve& curve, const Point& start, double low, double high)
{
    const double ratio = 0.5 * (std::sqrt(5.0) - 1.0);
    Point best = start;
    auto left = curve.at(high - ratio * (high - low), best), right = curve.at(low + ratio * (high - low), best);
    for (int k = 0; k < 18; ++k) {
        for (const auto* p : {&left, &right})
            if (p->V < best.V)
                best = *p;
        if (left.V < right.V) {
            high = right.alpha;
            right = std::move(left);
            left = curve.at(high - ratio * (high - low), best);
        } else {
            low = left.alpha;
            left = std::move(right);
            right = curve.at(low + ratio * (high - low), best);
        }
    }
    return best;
}

/// d2V/dalpha2 of the curve, all else at its best: twice the squared length of dG/dalpha/sigma at right angles to the derivatives by poles, C and D.
/// Differences of V would ask for searches that all end in the same minimum to many digits.
double curvature(const PartialFractionFit& fit, const FrequencyData& data)
{
    const auto& sections = fit.sections;
    const auto n = sections.order(), K = data.lines(), p = data.outputs;
    const auto lambda = evaluationPoints(data.frequency, 0.0, sections.alpha);
    const Eigen::MatrixXcd basis = partialFractions(sections, lambda);
    TallQr qr(p * (n + 1) + n + 1);
    for (Index o = 0; o < p; ++o) {
        const Eigen::VectorXd c = fit.C.row(o).transpose();
        Eigen::MatrixXcd columns = Eigen::MatrixXcd::Zero(K, qr.columns());
        columns.middleCols(o * (n + 1), n) = basis;
        columns.col(o * (n + 1) + n).setOnes();
        columns.middleCols(p * (n + 1), n) = partialFractionSlopes(sections, lambda, basis, c);
        for (Index k = 0; k < K; ++k) {
            const Complex mu = lambda[k] / sections.scale;
            Complex slope = 0.0;   // dG/dmu
            for (Index i = 0; i < sections.pairs(); ++i) {
                const Complex f = basis(k, 2 * i), g = basis(k, 2 * i + 1);
                slope += c[2 * i + 1] * f - (c[2 * i] * f + c[2 * i + 1] * g) * (2.0 * mu + sections.factors[2 * i]) * f;
            }
            if (sections.odd())
                slope -= c[n - 1] * basis(k, n - 1) * basis(k, n - 1);
            const double f = data.frequency[static_cast<std::size_t>(k)];
            if (f > 0.0)   // at 0 Hz lambda does not move with alpha
                columns(k, qr.columns() - 1) = slope * mu * Complex(std::log(2.0 * std::numbers::pi * f), 0.5 * std::numbers::pi);
        }
        const Eigen::VectorXd weights = data.deviation.size() != 0 ? Eigen::VectorXd(data.deviation.col(o).cwiseInverse())
                                                                   : Eigen::VectorXd(weightsOf(data).col(o));
        Eigen::MatrixXd rows(2 * K, qr.columns());
        rows << weights.asDiagonal() * columns.real(), weights.asDiagonal() * columns.imag();
        qr.fold(rows);
    }
    const double length = qr.R()(qr.columns() - 1, qr.columns() - 1);
    return 2.0 * length * length;
}

std::string decimals(double x)
{
    std::array<char, 32> text;
    return {text.data(), std::to_chars(text.data(), text.data() + text.size(), x, std::chars_format::fixed, 2).ptr};
}

Index parametersOf(const FrequencyData& data, int order, bool free)
{
    return order * (data.inputs + data.outputs) + data.inputs * data.outputs + (free ? 1 : 0);
}

/// Complex values less what the parameters of a free alpha take of them.
double freedomOf(const FrequencyData& data, int order)
{
    return std::max(1.0, static_cast<double>(data.value.size()) - 0.5 * static_cast<double>(parametersOf(data, order, true)));
}

/// Where the curve, in units of another (`unit`), stays within what two standard errors make above `least`; first above second: nowhere.
std::pair<double, double> rangeOf(const std::vector<AlphaLikelihood>& curve, double least, double unit = 1.0)
{
    std::pair<double, double> range {2.0, 0.0};
    for (const auto& point : curve)
        if (point.likelihood * unit <= least + asWell)
            range = {std::min(range.first, point.alpha), std::max(range.second, point.alpha)};
    return range;
}

FractionalIdentification fixedAlpha(const FrequencyData& data, const FractionalOptions& options, const Progress& progress)
{
    auto found = identify(data, linearOptions(options, *options.alpha), progress);
    FractionalIdentification result;
    result.model = {*options.alpha, std::move(found.model)};
    result.cost = found.cost;
    result.errorDb = found.errorDb;
    result.likelihood = found.likelihood;
    result.start = found.start;
    result.reason = found.reason;
    return result;
}

FractionalIdentification freeAlpha(const FrequencyData& data, const FractionalOptions& options, const Progress& progress)
{
    Curve curve(data, options);
    curve.search(progress);
    const auto& points = curve.points();
    const auto lowest = std::min_element(points.begin(), points.end(), [](const Point& a, const Point& b) { return a.V < b.V; });
    const auto index = static_cast<std::size_t>(lowest - points.begin());
    progress.at(0.85, "searching alpha");
    auto best = lowestBetween(curve, *lowest, points[index > 0 ? index - 1 : 0].alpha, points[std::min(index + 1, points.size() - 1)].alpha);

    const double freedom = freedomOf(data, options.order);
    const bool known = data.deviation.size() != 0;
    const double unit = known ? 1.0 : best.V / freedom;
    const double second = curvature(best.fit, data);

    FractionalIdentification result;
    auto found = judged(realize(best.fit.sections, best.fit.C, best.fit.D), data, best.alpha);
    result.model = {best.alpha, std::move(found.model)};
    result.cost = best.fit.cost;
    result.errorDb = found.errorDb;
    result.likelihood = found.likelihood;
    result.start = best.start;
    result.reason = best.reason;
    for (const auto& point : points)
        result.curve.push_back({point.alpha, point.V / unit});
    const auto above = std::find_if(result.curve.begin(), result.curve.end(), [&](const auto& p) { return p.alpha > best.alpha; });
    result.curve.insert(above, {best.alpha, best.V / unit});

    const bool inside = best.alpha > options.leastAlpha + 1e-3 && best.alpha < options.mostAlpha - 1e-3;
    // Of the noise, or of what is left where that is more; without deviations V is the cost, over the power that curvature() does not divide by.
    const double left = known ? best.V : best.V * weightsOf(data).cwiseProduct(data.value.cwiseAbs()).squaredNorm();
    const double spread = known ? std::max(1.0, left / freedom) : left / freedom;
    result.alphaDeviation = inside && second > 0.0 ? std::sqrt(spread / second) : notKnown;
    const auto [low, high] = rangeOf(result.curve, best.V / unit);
    if (!inside)
        result.warning = "The error falls towards the end of the search at alpha " + decimals(best.alpha) + ", so alpha is not determined.";
    else if (!std::isfinite(result.alphaDeviation) || high > best.alpha + 3.0 * result.alphaDeviation + options.gridStep
             || low < best.alpha - 3.0 * result.alphaDeviation - options.gridStep)
        result.warning = "At order " + std::to_string(options.order) + " any alpha from " + decimals(low) + " to " + decimals(high)
                       + " explains the data within two standard errors, so alpha is not determined; a lower order may tell.";
    if (!result.warning.empty())
        result.alphaDeviation = notKnown;
    return result;
}

} // namespace

bool FractionalOptions::isValid(std::string* reason) const
{
    const auto refuse = [reason](const char* sentence) {
        if (reason)
            *reason = sentence;
        return false;
    };
    if (alpha && !(*alpha > 0.0 && *alpha < 2.0))
        return refuse("alpha must lie between 0 and 2");
    if (!(leastAlpha > 0.0 && leastAlpha < mostAlpha && mostAlpha < 2.0 && gridStep > 1e-3 && gridStep <= 0.5))
        return refuse("alpha is searched between bounds that ascend between 0 and 2, in steps of 0.001 to 0.5");
    return linearOptions(*this, alpha.value_or(1.0)).isValid(reason);
}

FractionalIdentification identifyFractional(const FrequencyData& data, const FractionalOptions& options, const Progress& progress)
{
    std::string reason;
    if (!options.isValid(&reason))
        throw Error(Error::Kind::usage, "The frequency response cannot be identified: " + reason + ".");
    if (data.inputs != 1)
        throw Error(Error::Kind::data, "Fractional models are identified from responses to one input; these are to " + std::to_string(data.inputs) + ".");
    auto result = options.alpha ? fixedAlpha(data, options, progress) : freeAlpha(data, options, progress);
    result.sectorMargin = sectorMargin(result.model);
    result.stable = result.sectorMargin > 0.0;
    return result;
}

FractionalSweep sweepFractional(const FrequencyData& data, const std::vector<int>& orders, const FractionalOptions& options, const Progress& progress)
{
    if (orders.empty() || !std::is_sorted(orders.begin(), orders.end(), std::less_equal<> {}))
        throw Error(Error::Kind::usage, "The orders of a sweep must ascend.");
    FractionalSweep sweep;
    const double values = 2.0 * static_cast<double>(data.value.size()), count = static_cast<double>(orders.size());
    for (std::size_t k = 0; k < orders.size(); ++k) {
        auto single = options;
        single.order = orders[k];
        FractionalSweep::Entry entry;
        entry.order = orders[k];
        entry.found = identifyFractional(data, single, progress.part(static_cast<double>(k) / count, static_cast<double>(k + 1) / count));
        entry.mdl = (data.deviation.size() != 0 ? 2.0 * entry.found.likelihood : values * std::log(std::max(entry.found.cost, 1e-26)))
                  + static_cast<double>(parametersOf(data, orders[k], !options.alpha)) * std::log(values);
        sweep.entries.push_back(std::move(entry));
    }
    for (std::size_t k = 1; k < sweep.entries.size(); ++k)
        if (sweep.entries[k].mdl < sweep.entries[sweep.chosen].mdl)
            sweep.chosen = k;
    const auto& chosen = sweep.entries[sweep.chosen];
    sweep.sentence = "Order " + std::to_string(chosen.order) + " has the lowest description length.";
    if (options.alpha)
        return sweep;
    // V of all entries in the unit of the chosen one
    const bool deviations = data.deviation.size() != 0;
    const double least = deviations ? chosen.found.likelihood : freedomOf(data, chosen.order);
    const double alpha = chosen.found.model.alpha, away = std::isfinite(chosen.found.alphaDeviation) ? 3.0 * chosen.found.alphaDeviation : 0.0;
    for (const auto& entry : sweep.entries) {
        const double unit = deviations ? 1.0 : entry.found.cost / freedomOf(data, entry.order) * freedomOf(data, chosen.order) / chosen.found.cost;
        const auto [low, high] = rangeOf(entry.found.curve, least, unit);
        if (&entry == &chosen || low > high || (high <= alpha + away && low >= alpha - away))
            continue;
        sweep.warning = "Order and alpha are ambiguous: order " + std::to_string(entry.order) + " explains the data as well with alpha from " + decimals(low)
                      + " to " + decimals(high) + "; order " + std::to_string(chosen.order) + " says " + decimals(alpha) + ".";
        break;
    }
    return sweep;
}

} // namespace excursion
