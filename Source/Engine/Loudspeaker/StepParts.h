// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/ExponentialStep.h"

#include <array>
#include <cmath>
#include <optional>

namespace excursion {

/// The steps of a model that are 1, 1/2, 1/4 .. 1/64 of a whole one, each made when it is asked for.
class StepParts {
public:
    static constexpr int powers = 7;  ///< 1, 2, 4 .. 64 parts

    /// @param model  it must outlive this
    /// @param whole  s
    StepParts(const Model& model, double whole) : model_(model), whole_(whole) {}

    /// @param power  of two, of the parts
    ExponentialStep& operator[](int power)
    {
        auto& part = parts_[static_cast<std::size_t>(power)];
        return part ? *part : part.emplace(model_, std::ldexp(whole_, -power));
    }

private:
    const Model& model_;
    double whole_;
    std::array<std::optional<ExponentialStep>, powers> parts_;
};

}  // namespace excursion
