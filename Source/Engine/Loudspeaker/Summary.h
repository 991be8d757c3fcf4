// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"

#include <cstddef>
#include <vector>

namespace excursion {

/// The summary of a component with standard errors, sqrt(g^T C g): g by central differences over a small fraction of
/// each parameter's standard error, C its widenedCovariance(). NaN if C is unknown.
std::vector<Figure> figuresOf(const Model&, std::size_t component);

}  // namespace excursion
