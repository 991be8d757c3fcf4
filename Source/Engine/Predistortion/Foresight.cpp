// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Predistortion/Foresight.h"

#include "Engine/Numerics/Exponential.h"

#include <algorithm>
#include <cmath>

namespace excursion {

Foresight::Foresight(const LinearMotion& motion, const Eigen::MatrixXd& basis, const Eigen::VectorXd& times,
                     Eigen::Index steps, double step, double since)
    : coasting(times.size(), basis.cols()), driven(Eigen::MatrixXd::Zero(times.size(), steps))
{
    const auto n = motion.A.rows();
    // The input beside the state.
    const auto after = [&](double time) {
        const auto [decay, phi] = exponential(motion.A, motion.B, time, 1);
        Eigen::MatrixXd all = Eigen::MatrixXd::Identity(n + 1, n + 1);
        all.topLeftCorner(n, n) = decay;
        all.topRightCorner(n, 1) = phi;
        return all;
    };
    const Eigen::MatrixXd onward = after(step);
    for (Eigen::Index i = 0; i < times.size(); ++i) {
        // x after a time, per state at its start and per input that is held meanwhile
        const Eigen::RowVectorXd all = motion.displacement * after(times[i]).topRows(n);
        coasting.row(i) = all.head(n) * basis;
        // From the end of the last step that has begun by then; the time grows by a step each round.
        const auto last = std::min(steps, static_cast<Eigen::Index>(std::floor((times[i] + since) / step)));
        Eigen::RowVectorXd then = motion.displacement
                                  * after(times[i] + since - static_cast<double>(last) * step).topRows(n);
        if (last < steps)
            driven(i, last) = last > 0 ? then[n] : all[n];
        for (Eigen::Index k = last - 1; k >= 0; --k) {
            const double shorter = then[n];
            then = (then * onward).eval();
            driven(i, k) = (k > 0 ? then[n] : all[n]) - shorter;
        }
    }
}

void Foresight::sharpen()
{
    constexpr double share = 1.0 / 24.0;
    const auto steps = driven.cols();
    Eigen::MatrixXd filter = Eigen::MatrixXd::Identity(steps, steps) * (1.0 + 2.0 * share);
    for (Eigen::Index k = 0; k + 1 < steps; ++k)
        filter(k, k + 1) = filter(k + 1, k) = -share;
    if (steps > 0)
        filter(0, 0) -= share;
    driven = (driven * filter).eval();
}

Bands::Values largestWithin(const Eigen::VectorXd& rest, const Eigen::MatrixXd& parts, Bands::Values most, double limit)
{
    Bands::Values factors {};
    for (std::size_t b = 0; b < Bands::count; ++b) {
        // The bands above this one as they may be at most, those below given up. They have to keep the limit by
        // themselves: what one band takes back of another today it need not take back tomorrow.
        double high = most[b];
        for (Eigen::Index i = 0; i < rest.size() && high >= 0.0; ++i) {
            double others = rest[i];
            for (std::size_t above = b + 1; above < Bands::count; ++above)
                others += most[above] * parts(i, static_cast<Eigen::Index>(above));
            const double part = parts(i, static_cast<Eigen::Index>(b)),
                         room = limit - std::copysign(others, part * others);
            if (std::abs(others) > limit)
                high = -1.0;
            else if (room < high * std::abs(part))
                high = room / std::abs(part);
        }
        if (high >= 0.0) {
            factors[b] = high;
            std::copy(most.begin() + static_cast<std::ptrdiff_t>(b) + 1, most.end(),
                      factors.begin() + static_cast<std::ptrdiff_t>(b) + 1);
            return factors;
        }
    }
    return factors;
}

}  // namespace excursion
