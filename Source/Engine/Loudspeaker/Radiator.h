// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace excursion {

/// The emission of the driver along a trajectory, and its derivatives by parameters of the model: the sum of the
/// contributions of its path to the microphone and of its effects that are heard or seen (Emission).
///
/// Thread: after construction nothing allocates, locks or throws.
class Radiator {
public:
    /// The observed values at an instant.
    struct Sound {
        double flow = 0.0;      ///< area times acceleration, m^3/s^2
        double lateness = 0.0;  ///< s
        double spot = 0.0;      ///< m
    };

    /// @param active  parameters to differentiate by, in the order of parametersOf(); may be empty
    explicit Radiator(const Model&, std::span<const Eigen::Index> active = {});
    Radiator(const Radiator&) = delete;  // it points into its own model

    /// m^2, reference area of the acceleration.
    double area();

    /// @param z             the state, as in Dynamics
    /// @param acceleration  of the coil, m/s^2
    Sound at(const double* z, double acceleration);

    /// Derivatives of the sound: one row per active parameter; columns: flow, lateness, spot.
    /// @param S             derivatives of z, parameters x states
    /// @param acceleration  and its derivatives, by parameter
    void differentiate(const double* z, double acceleration, const Eigen::Ref<const Eigen::MatrixXd>& S,
                       const Eigen::Ref<const Eigen::VectorXd>& accelerationSlopes,
                       Eigen::Ref<Eigen::MatrixXd, 0, Eigen::OuterStride<>> out);

private:
    Emission<double> sum(const double* z, double acceleration);

    static constexpr int none = -1;

    struct Part {
        const Component* component;
        std::size_t memory;  ///< where its memory starts in z
        std::vector<double> coefficients, rates;
    };
    /// Up to jetWidth directions in which one part is differentiated at once: i, x, v, memories (places in z), the
    /// acceleration, or parameters.
    struct Chunk {
        std::size_t part;
        std::vector<Jet> coefficients, memory, rates;
        /// place in z (`order` stands for the acceleration), or column in S; or none
        std::vector<int> place, column;
    };

    const Model model_;
    int order_ = 3;
    std::vector<Part> parts_;
    std::vector<Chunk> chunks_;
    Eigen::MatrixXd slopes_;  ///< active parameters x (area, acceleration, lateness, spot)
};

}  // namespace excursion
