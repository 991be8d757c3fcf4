// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/PoleZeroReduction.h"

#include "Engine/Error.h"
#include "Engine/Linear/Response.h"
#include "Engine/Linear/RootDistance.h"
#include "Engine/Validity.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace excursion {
namespace {

using Complex = std::complex<double>;

constexpr double unbounded = std::numeric_limits<double>::infinity();
constexpr double pi = std::numbers::pi;

double decibels(double ratio) { return 20.0 * std::log10(ratio); }

/// Roots to take out together: indices of the upper one of each pair, or of the real one.
struct Edit {
    std::vector<std::size_t> poles, zeros;
    bool cancelled = false;
    double rippleDb = 0.0;
    double growth = 1.0;  ///< factor of 1 + errorBound
};

std::size_t sizeAt(const std::vector<Complex>& roots, std::size_t k) { return roots[k].imag() != 0.0 ? 2 : 1; }

/// Steps of the walk over roots: from one group to the next.
template <class Visit>
void eachGroup(const std::vector<Complex>& roots, Visit visit)
{
    for (std::size_t k = 0; k < roots.size(); k += sizeAt(roots, k))
        visit(k);
}

class Editor {
public:
    Editor(const StateSpace& model, const PoleZeroReductionOptions& options)
        : options_(options), g_(poleZeroGainOf(model)), low_(options.low), high_(options.high)
    {
        if (low_ == 0.0 && high_ == 0.0)
            high_ = 0.5 * model.sampleRate;
        const int count = 2000;
        for (int k = 0; k <= count; ++k)
            frequency_.push_back(low_ + (high_ - low_) * k / count);
        // Where the response bends: at the angle of every root within the band.
        for (const auto* roots : {&g_.poles, &g_.zeros})
            for (const auto& root : *roots) {
                const double f = nearestFrequency(root, g_.sampleRate, options.alpha);
                if (f > low_ && f < high_)
                    frequency_.push_back(f);
            }
        std::sort(frequency_.begin(), frequency_.end());
        frequency_.erase(std::unique(frequency_.begin(), frequency_.end()), frequency_.end());
        const Resolvent resolvent(model);
        for (const double f : frequency_)
            first_.push_back(resolvent.response(evaluationPoint(f, model.sampleRate, options.alpha))(0, 0));
        PoleZeroReductionStep asFound;
        measure(realize(g_), asFound);
        rounding_ = asFound.error;
    }

    /// What the poles and zeros as they were found miss of the response, relative: as much as rounding has cost.
    double rounding() const { return rounding_; }

    const PoleZeroGain& present() const { return g_; }
    int samplesEarly() const { return samplesEarly_; }

    /// The edit that ripples least for each pole, if there is any.
    std::optional<Edit> best() const
    {
        std::optional<Edit> found;
        const auto consider = [&](const Edit& edit) {
            const auto saved = saves(edit);
            if (saved > 0 && static_cast<int>(g_.poles.size() - saved) >= options_.order && std::isfinite(edit.rippleDb)
                && (!found
                    || edit.rippleDb * static_cast<double>(saves(*found))
                           < found->rippleDb * static_cast<double>(saved)))
                found = edit;
        };
        if (options_.pairs)
            eachGroup(g_.poles, [&](std::size_t p) {
                eachGroup(g_.zeros, [&](std::size_t q) {
                    if (sizeAt(g_.poles, p) == sizeAt(g_.zeros, q))
                        consider(cancelling(p, q));
                });
            });
        if (options_.remote)
            eachGroup(g_.poles, [&](std::size_t p) { consider(removing(p)); });
        return found;
    }

    void apply(const Edit& edit)
    {
        if (!edit.cancelled) {
            for (const auto p : edit.poles)
                leave(g_.poles, p, -1);
            for (const auto q : edit.zeros)
                leave(g_.zeros, q, 1);
        }
        erase(g_.poles, edit.poles);
        erase(g_.zeros, edit.zeros);
    }

    /// What the present model does in fact.
    void measure(const StateSpace& model, PoleZeroReductionStep& step) const
    {
        const Resolvent resolvent(model);
        double least = unbounded, most = 0.0;
        step.error = 0.0;
        for (std::size_t k = 0; k < frequency_.size(); ++k) {
            auto ratio = resolvent.response(evaluationPoint(frequency_[k], model.sampleRate, options_.alpha))(0, 0)
                         / first_[k];
            if (!std::isfinite(std::abs(ratio)))
                continue;  // at a zero on the axis there is no ratio
            if (!model.continuous())
                ratio *= std::polar(1.0, -2.0 * pi * frequency_[k] / model.sampleRate * samplesEarly_);
            least = std::min(least, std::abs(ratio));
            most = std::max(most, std::abs(ratio));
            step.error = std::max(step.error, std::abs(ratio - 1.0));
        }
        step.rippleDb = decibels(most / least);
    }

private:
    const PoleZeroReductionOptions& options_;
    PoleZeroGain g_;
    double low_, high_;
    int samplesEarly_ = 0;
    double rounding_ = 0.0;
    std::vector<double> frequency_;
    std::vector<Complex> first_;

    std::size_t saves(const Edit& edit) const
    {
        std::size_t count = 0;
        for (const auto p : edit.poles)
            count += sizeAt(g_.poles, p);
        return count;
    }

    RootDistance distance(Complex root) const
    {
        return distanceToBand(root, g_.sampleRate, low_, high_, options_.alpha);
    }

    double remoteness(Complex root) const
    {
        if (g_.sampleRate == 0.0)
            return std::abs(evaluationPoint(high_, 0.0, options_.alpha)) / std::abs(root);
        const double radius = std::abs(1.0 + root);
        return std::min(radius, 1.0 / radius);
    }

    double rippleOf(Complex root) const
    {
        const auto [least, most] = distance(root);
        return decibels(most / least);
    }

    Edit cancelling(std::size_t p, std::size_t q) const
    {
        const double epsilon = std::abs(g_.poles[p] - g_.zeros[q]) / distance(g_.poles[p]).least;
        const auto size = static_cast<double>(sizeAt(g_.poles, p));
        Edit edit {{p}, {q}, true, unbounded, unbounded};
        if (epsilon < 1.0) {
            edit.rippleDb = size * decibels((1.0 + epsilon) / (1.0 - epsilon));
            edit.growth = std::pow(1.0 - epsilon, -size);
        }
        return edit;
    }

    void addRemote(Edit& edit, const std::vector<Complex>& roots, std::size_t k, bool pole) const
    {
        const auto size = static_cast<double>(sizeAt(roots, k));
        const double rho = remoteness(roots[k]);
        edit.rippleDb += size * rippleOf(roots[k]);
        edit.growth *= rho < 1.0 ? std::pow(pole ? 1.0 + rho : 1.0 / (1.0 - rho), size) : unbounded;
        (pole ? edit.poles : edit.zeros).push_back(k);
    }

    /// A remote pole, with the most remote zeros that have to go with it.
    Edit removing(std::size_t p) const
    {
        Edit edit;
        addRemote(edit, g_.poles, p, true);
        auto zeros = g_.zeros.size();
        const auto poles = g_.poles.size() - sizeAt(g_.poles, p);
        std::vector<std::size_t> order;
        eachGroup(g_.zeros, [&](std::size_t q) { order.push_back(q); });
        std::stable_sort(order.begin(), order.end(), [this](std::size_t a, std::size_t b) {
            return rippleOf(g_.zeros[a]) < rippleOf(g_.zeros[b]);
        });
        for (const auto q : order) {
            if (zeros <= poles)
                break;
            addRemote(edit, g_.zeros, q, false);
            zeros -= sizeAt(g_.zeros, q);
        }
        return edit;
    }

    /// lambda - r = z (1 - r_z/z), or -r_z (1 - z/r_z) with r_z = 1 + r; in continuous time -r (1 - s/r): the constant
    /// stays in the gain.
    void leave(const std::vector<Complex>& roots, std::size_t k, int sign)
    {
        for (std::size_t i = k; i < k + sizeAt(roots, k); ++i) {
            const auto root = g_.sampleRate > 0.0 ? 1.0 + roots[i] : roots[i];
            if (g_.sampleRate > 0.0 && std::abs(root) < 1.0) {
                samplesEarly_ -= sign;
                continue;
            }
            // Conjugates give |r|^2 between them.
            const double constant = sizeAt(roots, k) == 2 ? std::abs(root) : -root.real();
            g_.gain *= sign > 0 ? constant : 1.0 / constant;
        }
    }

    static void erase(std::vector<Complex>& roots, std::vector<std::size_t> groups)
    {
        std::sort(groups.rbegin(), groups.rend());
        for (const auto k : groups)
            roots.erase(roots.begin() + static_cast<std::ptrdiff_t>(k),
                        roots.begin() + static_cast<std::ptrdiff_t>(k + sizeAt(roots, k)));
    }
};

std::vector<Complex> rootsOf(const std::vector<Complex>& roots, const std::vector<std::size_t>& groups)
{
    std::vector<Complex> result;
    for (const auto k : groups)
        for (std::size_t i = k; i < k + sizeAt(roots, k); ++i)
            result.push_back(roots[i]);
    return result;
}

}  // namespace

bool PoleZeroReductionOptions::isValid(std::string* reason) const
{
    if (!(rippleDb >= 0.0) || !std::isfinite(rippleDb) || order < 0)
        return refuse(reason, "the ripple and the order must be 0 or above");
    if (!remote && !pairs)
        return refuse(reason, "neither remote roots nor pairs may be taken out");
    if (!(low >= 0.0) || !std::isfinite(high) || (high != 0.0 ? !(low < high) : low != 0.0))
        return refuse(reason, "the band must begin at 0 Hz or above and below its end");
    if (!(alpha > 0.0 && alpha < 2.0))
        return refuse(reason, "the order of differentiation must lie between 0 and 2");
    return true;
}

PoleZeroReduction reduceByPolesAndZeros(const StateSpace& model, const PoleZeroReductionOptions& options)
{
    std::string reason;
    if (!options.isValid(&reason))
        throw Error(Error::Kind::usage, "The model cannot be reduced: " + reason + ".");
    if (model.continuous() && options.high == 0.0)
        throw Error(Error::Kind::usage,
                    "A model of continuous time is reduced within a band: no pole is remote from all frequencies.");
    if (!model.continuous() && options.high > 0.5 * model.sampleRate)
        throw Error(Error::Kind::usage, "The band goes beyond half the sample rate of the model.");
    if (!model.continuous() && options.alpha != 1.0)
        throw Error(Error::Kind::usage, "The order of differentiation of a model of discrete time is 1.");
    Editor editor(model, options);
    PoleZeroReduction result;
    result.model = model;
    const double rounding = editor.rounding();
    if (!(rounding < 0.1))
        throw Error(Error::Kind::numerical, "The model's poles and zeros cannot be told well enough within the band.");
    double bound = decibels((1.0 + rounding) / (1.0 - rounding)), growth = 1.0 + rounding;
    result.reason = "no pole is left that could go";
    while (const auto edit = editor.best()) {
        if (bound + edit->rippleDb > options.rippleDb) {
            result.reason = "the next step would pass the bound of the ripple";
            break;
        }
        PoleZeroReductionStep step;
        step.poles = rootsOf(editor.present().poles, edit->poles);
        step.zeros = rootsOf(editor.present().zeros, edit->zeros);
        step.cancelled = edit->cancelled;
        editor.apply(*edit);
        bound += edit->rippleDb;
        growth *= edit->growth;
        step.boundDb = bound;
        step.errorBound = growth - 1.0;
        result.model = realize(editor.present());
        step.order = result.model.order();
        editor.measure(result.model, step);
        result.steps.push_back(std::move(step));
    }
    if (!model.continuous())
        result.delay = -editor.samplesEarly() / model.sampleRate;
    return result;
}

}  // namespace excursion
