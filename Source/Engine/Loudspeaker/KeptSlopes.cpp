// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/KeptSlopes.h"

#include "Engine/Loudspeaker/Residual.h"

#include <utility>

namespace excursion {

KeptSlopes::KeptSlopes(const Record& record, const std::vector<std::size_t>& sections)
    : record_(record), sections_(sections)
{
}

void KeptSlopes::keep(std::vector<SectionFit> fits) { slopes_ = std::move(fits); }

Eigen::VectorXd KeptSlopes::gradientAt(const std::vector<SectionFit>& fits) const
{
    Eigen::VectorXd sum;
    for (std::size_t s = 0; s < slopes_.size(); ++s) {
        const Residual residual(record_, record_.sections[sections_[s]]);
        for (std::size_t c = 0; c < slopes_[s].slopes.size(); ++c) {
            const auto& J = slopes_[s].slopes[c];
            const Eigen::VectorXf r = residual.of(c, fits[s].predicted[c]).cast<float>();
            if (sum.size() == 0)
                sum = Eigen::VectorXd::Zero(J.cols());
            sum += (J.transpose() * r).cast<double>();
        }
    }
    return sum;
}

}  // namespace excursion
