// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/Autoregression.h"

namespace excursion {

Eigen::VectorXd autoregression(const Eigen::VectorXd& x, Eigen::Index order)
{
    Eigen::VectorXd a = Eigen::VectorXd::Zero(order + 1), forth = x, back = x;
    a[0] = 1.0;
    for (Eigen::Index k = 1; k <= order; ++k) {
        const Eigen::Index count = x.size() - k;
        const Eigen::VectorXd f = forth.tail(count), b = back.head(count);
        const double power = f.squaredNorm() + b.squaredNorm();
        const double reflection = power > 0.0 ? -2.0 * f.dot(b) / power : 0.0;
        const Eigen::VectorXd before = a;
        for (Eigen::Index i = 1; i <= k; ++i)
            a[i] = before[i] + reflection * before[k - i];
        forth = f + reflection * b;
        back = b + reflection * f;
    }
    return a;
}

Eigen::VectorXd whitenedBy(const Eigen::VectorXd& a, const Eigen::VectorXd& x)
{
    Eigen::VectorXd y = x;
    for (Eigen::Index i = 1; i < a.size(); ++i)
        y.tail(x.size() - i) += a[i] * x.head(x.size() - i);
    return y;
}

Eigen::VectorXd colouredBy(const Eigen::VectorXd& a, const Eigen::VectorXd& e)
{
    Eigen::VectorXd x = e;
    for (Eigen::Index t = 0; t < x.size(); ++t)
        for (Eigen::Index i = 1; i < a.size() && i <= t; ++i)
            x[t] -= a[i] * x[t - i];
    return x;
}

}  // namespace excursion
