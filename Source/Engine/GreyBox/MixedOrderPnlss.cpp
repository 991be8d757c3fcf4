// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/GreyBox/MixedOrderPnlss.h"

#include "Engine/Error.h"

#include <numbers>

namespace excursion {

FractionalPnlss withTerms(const MixedImpedance& driver, int degree, TermMask mask, bool offset)
{
    if (!(driver.alpha < 1.0))
        throw Error(Error::Kind::data, "The coil's impedance rises with an order of " + std::to_string(driver.alpha)
                                           + ", not below 1: a model of integer order is the right one.");
    const double w0 = 2.0 * std::numbers::pi * driver.resonance, L = driver.semiInductance;
    StateSpace form;
    form.A = Eigen::MatrixXd {
        {0.0, 1.0, 0.0}, {-w0 * w0, -w0 / driver.quality, driver.motional}, {0.0, -1.0 / L, -driver.resistance / L}};
    form.B = Eigen::MatrixXd {{0.0}, {0.0}, {1.0 / L}};
    form.C = Eigen::MatrixXd {{0.0, 0.0, 1.0}};
    form.D = Eigen::MatrixXd::Zero(1, 1);
    return withTerms(form, driver.alpha, Eigen::Array<bool, 3, 1>(false, false, true), degree, mask, offset);
}

}  // namespace excursion
