// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Estimate/Record.h"
#include "Engine/Loudspeaker/OutputError.h"

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace excursion {

/// The slopes J of the residuals at one place of a search, kept for steps from there: J^T r with the residuals r of
/// another place (a chord's gradient, LeastSquares.h).
class KeptSlopes {
public:
    /// @param sections  indices into record.sections; they and the record outlive this
    KeptSlopes(const Record&, const std::vector<std::size_t>& sections);

    /// @param fits  with slopes
    void keep(std::vector<SectionFit> fits);

    /// @param fits  of the other place, with spectra
    /// @returns empty where no slopes are kept
    Eigen::VectorXd gradientAt(const std::vector<SectionFit>& fits) const;

private:
    const Record& record_;
    const std::vector<std::size_t>& sections_;
    std::vector<SectionFit> slopes_;
};

}  // namespace excursion
