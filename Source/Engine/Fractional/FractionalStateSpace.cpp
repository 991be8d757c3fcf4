// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Fractional/FractionalStateSpace.h"

#include "Engine/Error.h"
#include "Engine/Linear/Response.h"
#include "Engine/Validity.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace excursion {

bool FractionalStateSpace::isValid(std::string* reason) const
{
    if (!(alpha > 0.0 && alpha < 2.0))
        return refuse(reason, "the order of differentiation of a fractional model must lie between 0 and 2");
    if (!form.continuous())
        return refuse(reason, "a fractional model is one of continuous time");
    return form.isValid(reason);
}

std::vector<Eigen::MatrixXcd> respond(const FractionalStateSpace& model, const std::vector<double>& frequency)
{
    std::string reason;
    if (!model.isValid(&reason))
        throw Error(Error::Kind::usage, "The model has no frequency response: " + reason + ".");
    const Resolvent resolvent(model.form);
    std::vector<Eigen::MatrixXcd> result;
    result.reserve(frequency.size());
    for (const double f : frequency)
        result.push_back(resolvent.response(evaluationPoint(f, 0.0, model.alpha)));
    return result;
}

double sectorMargin(const FractionalStateSpace& model)
{
    const double border = 0.5 * std::numbers::pi * model.alpha;
    double margin = std::numeric_limits<double>::infinity();
    for (const auto& eigenvalue : poles(model.form))
        margin = std::min(margin, eigenvalue == 0.0 ? 0.0 : std::abs(std::arg(eigenvalue)) - border);
    return margin;
}

bool isStable(const FractionalStateSpace& model) { return sectorMargin(model) > 0.0; }

}  // namespace excursion
