// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/Bands.h"
#include "Engine/Predistortion/Foresight.h"
#include "Engine/Predistortion/Glide.h"
#include "Engine/Predistortion/HeatFactor.h"
#include "Engine/Predistortion/LinearMotion.h"
#include "Engine/Predistortion/PeakHold.h"
#include "Engine/Predistortion/RealTime.h"
#include "Engine/Predistortion/Reference.h"
#include "Engine/Predistortion/Ticks.h"
#include "Engine/Predistortion/VoltageFactor.h"

#include <array>
#include <cstddef>
#include <limits>
#include <vector>

namespace excursion {

/// Turns a voltage down before it is linearized, so that excursion, voltage and power keep their limits together. It
/// looks ahead: what it turns down left the input `latency` samples ago. Every `tick` samples it chooses one factor for
/// each of three bands (Bands.h), and the gain of a band is these factors through a smooth window that is shorter than
/// the look-ahead. The factors are, multiplied:
///  - what keeps the motion of the wish within the limit of the excursion: the lowest band first. Judged is how far a
///    cone would coast that were left alone at any instant; a factor is held for 0.1 s at least and released slowly, so
///    a steady tone has a steady gain;
///  - what keeps the peaks of the voltage, as they are after that, within the limit, with what linearizing has lately
///    added to them;
///  - what keeps the heat of the coil within a bound that falls to the limit as the running mean comes near it;
///  - silence around a sample that is not finite.
/// The last word has a plan: from the state of a cone that was given what came out, under the inputs that are known,
/// with these factors now and silence from the next tick on. If that cone would leave its limit, the factors are turned
/// down until it does not. As silence is always a way on that was found to be safe a tick before, the limit holds; as
/// nothing but turning down is ever done, no voltage is spent on braking.
///
/// Thread: after construction nothing allocates, locks or throws.
class Protection {
public:
    static constexpr int latency = 73;  ///< samples
    static constexpr int tick = ticks::samples;
    static constexpr std::size_t bands = Bands::count;

    /// @param delay  samples from the cone, as decide() is told of it, to the next input
    Protection(const LinearMotion&, const RealTimeOptions&, double delay);

    void reset();

    /// What of a limit of the excursion is left to the signal, for the margin.
    static double share(const LinearMotion&, double margin);

    /// From now on the limits are those of the controls, or there are none.
    void set(const PredistortionControls&, bool on);

    /// Whether the next sample begins a tick, before which decide() has to be called.
    bool due() const { return place_ == 0; }
    std::size_t left() const { return static_cast<std::size_t>(tick - place_); }  ///< samples of the tick

    /// What came out in the tick before.
    struct Outcome {
        double asked = 0.0, wanted = 0.0;  ///< peaks of what went into the linearizer and of what it asked for, V
        double heat = 0.0;                 ///< mean of Re i^2, W
        bool astray = false;               ///< the cone was not given all that was asked for
        double offset = 0.0;               ///< m, where the cone is beside the linear motion, and stays for a while
        double reserve = 0.0;              ///< m, by how far it may be from all of that
        double most = 1.0;                 ///< factor that no band may pass, for other reasons
    };
    void decide(const Eigen::Map<const Eigen::VectorXd>& cone, const Outcome&);

    /// @param sound  false: a sample that is not finite came here
    double step(double u, bool sound);

    double voltageLimit() const { return voltageNow_; }  ///< V, of what comes out at the moment
    double heat() const { return cool_.mean(); }         ///< W, the running mean
    void warm(double heat) { cool_.warm(heat); }         ///< that is the running mean, W, from before
    /// what the limit of power leaves of the amount of linearization
    double effort() const { return cool_.effort(); }
    /// How near to its limit the cone will come, by the latest plan; 0: there is no limit.
    double share() const { return share_; }
    /// By how much each limit turns down at the moment: the motion that is asked for, the voltage, the current.
    struct Factors {
        double displacement = 1.0, voltage = 1.0, power = 1.0;
    };
    const Factors& factors() const { return factors_; }
    /// Nothing that leaves now was turned down: it is what came in, but for rounding.
    bool untouched() const { return untouched_ > latency / tick + 1; }

private:
    static constexpr int window = latency - tick + 1;  ///< samples over which a factor is smoothed
    static constexpr int pulse = window + tick - 1;    ///< samples over which one tick's factor acts
    static constexpr int planStep = 4, wishStep = 8;   ///< samples: steps of plan and wish
    using Values = Bands::Values;
    using Path = std::array<double, pulse>;

    void plan(const Eigen::Map<const Eigen::VectorXd>& cone, bool astray, Values& factors);
    Values forWish();

    double rate_;
    int committed_;  ///< samples on their way to the cone
    int settled_;    ///< ticks after which a cone that is given all of the wish is where that was
    Bands split_;
    std::array<Reference, bands> wish_;  ///< the motion of each band as it comes, undiminished
    Foresight coast_, ahead_;
    /// by how much the excursion can differ, relatively, per relative error of the parameters
    double uncertainty_;

    // What is known of the input.
    std::array<std::array<double, latency>, bands> delayed_ {};
    std::size_t oldest_ = 0;
    std::vector<double> sent_;  ///< the latest outputs, as many as are committed, a ring
    std::size_t sentAt_ = 0;
    Values sum_ {};  ///< of the step of the wish
    int summed_ = 0;

    // Gains: factors through the window.
    Path shape_ {};
    std::array<Path, bands> gain_ {};  ///< from the next sample on, if silence followed
    int place_ = 0;

    // Limits and what they come to.
    bool on_ = false;
    Glide displacement_, voltage_, power_;  ///< as reciprocals: 0: none
    struct Limits {
        double displacement = 0.0, voltage = 0.0;  ///< reciprocals
    };
    std::vector<Limits> past_;  ///< of the latest ticks, a ring
    std::size_t pastAt_ = 0;
    double displacementNow_ = 0.0;  ///< reciprocal
    double voltageNow_ = std::numeric_limits<double>::infinity(), share_ = 0.0;
    std::array<PeakHold, bands> wishHold_;  ///< of 1 - factor
    PeakHold reachHold_;                    ///< of how far the wish would coast, in limits
    double reach_ = 0.0, farthest_ = 0.0;   ///< farthest_: m, how far it would coast with the limit kept
    double offset_ = 0.0, reserve_ = 0.0;   ///< m, see Outcome
    std::array<Factor, bands> held_;        ///< for the excursion
    VoltageFactor loud_;
    HeatFactor cool_;
    bool heated_;           ///< there is a coil
    int undiminished_ = 0;  ///< ticks with factors of 1
    double most_ = 1.0;     ///< see Outcome
    int untouched_ = 0;     ///< ticks in which nothing was turned down
    double mute_ = 1.0;
    int muteFor_ = 0;
    Factors factors_;

    // Room for decide().
    Eigen::VectorXd future_, rest_, drive_, coasted_, state_;
    Eigen::MatrixXd parts_, partDrives_, wishes_;
};

}  // namespace excursion
