// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Predistortion/AmplifierCoupling.h"

#include "Engine/Validity.h"

#include <numbers>

namespace excursion {

double AmplifierCoupling::forgetting() const
{
    constexpr double timeConstants = 5.0;
    return passesConstant() ? 0.0 : timeConstants / (2.0 * std::numbers::pi * corner);
}

bool AmplifierCoupling::isValid(std::string* reason) const
{
    if (!(passesConstant() || (corner >= lowest && corner <= highest)))
        return refuse(reason, "the corner of the amplifier's high-pass must lie between 0.1 and 20 Hz, or be 0");
    if (order != 1 && order != 2)
        return refuse(reason, "the amplifier's high-pass must be of order 1 or 2");
    return true;
}

Withheld::Withheld(const AmplifierCoupling& coupling)
{
    const Eigen::Index n = coupling.passesConstant() ? 0 : coupling.order;
    const double w = 2.0 * std::numbers::pi * coupling.corner;
    A = Eigen::MatrixXd::Zero(n, n);
    B = Eigen::MatrixXd::Zero(n, 1);
    C = Eigen::MatrixXd::Zero(1, n);
    if (n == 1) {
        A << -w;
        B << w;
        C << 1.0;
    } else if (n == 2) {
        A << -std::numbers::sqrt2 * w, -w, w, 0.0;
        B << w, 0.0;
        C << std::numbers::sqrt2, 1.0;
    }
}

LinearMotion behind(const LinearMotion& motion, const AmplifierCoupling& coupling)
{
    if (coupling.passesConstant())
        return motion;
    const Withheld withheld(coupling);
    const auto n = motion.A.rows(), more = withheld.A.rows();
    auto whole = motion;
    whole.A = Eigen::MatrixXd::Zero(n + more, n + more);
    whole.A.topLeftCorner(n, n) = motion.A;
    whole.A.topRightCorner(n, more) = -motion.B * withheld.C;
    whole.A.bottomRightCorner(more, more) = withheld.A;
    whole.B.resize(n + more, 1);
    whole.B << motion.B, withheld.B;
    whole.correction = Eigen::MatrixXd::Zero(n + more, 1);
    whole.correction.bottomRows(more) = withheld.B;
    const auto widened = [more](const Eigen::RowVectorXd& row, const Eigen::RowVectorXd& added) {
        Eigen::RowVectorXd wide(row.size() + more);
        wide << row, added;
        return wide;
    };
    whole.displacement = widened(motion.displacement, Eigen::RowVectorXd::Zero(more));
    if (motion.current.size() > 0)
        whole.current = widened(motion.current, -motion.currentByInput * withheld.C);
    return whole;
}

}  // namespace excursion
