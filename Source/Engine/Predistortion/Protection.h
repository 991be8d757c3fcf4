// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Numerics/LaidRows.h"
#include "Engine/Predistortion/Bands.h"
#include "Engine/Predistortion/ConeShift.h"
#include "Engine/Predistortion/Glide.h"
#include "Engine/Predistortion/HeatFactor.h"
#include "Engine/Predistortion/LinearMotion.h"
#include "Engine/Predistortion/LookTimes.h"
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

/// Turns a voltage down before it is linearized, so that excursion, voltage and power all stay within their limits. It
/// looks ahead: the sample that it turns down entered `latency` samples ago. Every `tick` samples it chooses one factor
/// for each of three bands (Bands.h). The gain of a band is the sequence of factors, smoothed by a window that is
/// shorter than the look-ahead. Each factor is a product of:
///  - the factor that keeps the requested motion (the wish) within the excursion limit, the lowest band first. The
///    criterion is how far a cone would coast if the input stopped at any instant. A factor is held for at least 0.1 s
///    and released slowly, so a steady tone has a steady gain;
///  - the factor that keeps the remaining voltage peaks within the limit, including the recent increase through
///    linearization;
///  - the factor that keeps the heat of the coil within a bound that falls to the limit as the running mean approaches
///    it;
///  - silence around a sample that is not finite.
/// The wish and the plan are taken at spacings that are small against a period of the resonance, however low the sample
/// rate is.
/// A plan makes the final decision. It starts from the state of a cone driven by the actual output, and assumes the
/// known inputs, these factors now, and silence from the next tick on. If that cone would exceed its limit, the factors
/// are lowered until it does not. Silence was found to be safe one tick before, so it is always a safe continuation,
/// and the limit holds. Behind an amplifier that withholds the mean of the correction, what it will withhold is
/// foreseen (ConeShift): there the limit holds as far as that does. The signal is only ever turned down, so no voltage
/// is spent on braking.
///
/// Thread: after construction nothing allocates, locks or throws.
class Protection {
public:
    static constexpr int latency = 73;  ///< samples
    static constexpr int tick = ticks::samples;
    static constexpr std::size_t bands = Bands::count;

    /// @param delay  samples from the cone's state that decide() gets to the next input
    /// @param basis  the state of the motion per state that decide() gets; empty: that of a Reference of this motion
    Protection(const LinearMotion&, const RealTimeOptions&, double delay, const Eigen::MatrixXd& basis = {});

    void reset();

    /// The share of an excursion limit that the margin leaves to the signal.
    static double share(const LinearMotion&, double margin);
    /// The share of a power limit that it leaves: the current may be larger by the margin.
    static double powerShare(double margin) { return (1.0 - margin) * (1.0 - margin); }

    /// New limits from the controls, or none.
    void set(const PredistortionControls&, bool on);

    /// Whether the next sample begins a tick, before which decide() has to be called.
    bool due() const { return place_ == 0; }
    std::size_t left() const { return static_cast<std::size_t>(tick - place_); }  ///< samples of the tick

    /// The output of the previous tick.
    struct Outcome {
        double asked = 0.0, wanted = 0.0;  ///< peaks of the linearizer's input and of the voltage that it asked for, V
        double correction = 0.0;           ///< mean of the output without the input, V
        double heat = 0.0;                 ///< mean of R i^2, W
        double hotter = 1.0;               ///< R, the coil's resistance, over that of the cold one
        bool astray = false;               ///< the cone did not get everything that was asked for
        double offset = 0.0;               ///< m, slow offset of the cone from the linear motion
        double reserve = 0.0;              ///< m, possible further deviation from it
        double most = 1.0;                 ///< upper limit of all factors, for other reasons
    };
    void decide(const Eigen::Map<const Eigen::VectorXd>& cone, const Outcome&);

    /// @param sound  false: the sample was not finite
    double step(double u, bool sound);

    double voltageLimit() const { return voltageNow_; }  ///< V, of the output at the moment
    double heat() const { return cool_.mean(); }         ///< W, the running mean
    void warm(double heat) { cool_.warm(heat); }         ///< W, running mean from before
    /// While nothing is decided: the coil turned so much into heat on average, W.
    void rest(double heat, double samples) { cool_.rest(heat, samples); }
    /// factor of the power limit on the amount of linearization
    double effort() const { return cool_.effort(); }
    /// How close the cone will come to its limit, by the latest plan; 0: there is no limit.
    double share() const { return share_; }
    /// The present factor of each limit: on the requested motion, the voltage, the current.
    struct Factors {
        double displacement = 1.0, voltage = 1.0, power = 1.0;
    };
    const Factors& factors() const { return factors_; }
    /// The present output was not turned down: it equals the input, except for rounding.
    bool untouched() const { return untouched_ > latency / tick + 1; }

private:
    static constexpr int window = latency - tick + 1;  ///< samples over which a factor is smoothed
    static constexpr int pulse = window + tick - 1;    ///< samples over which one tick's factor acts
    using Values = Bands::Values;
    using Path = std::array<double, pulse>;

    void plan(const Eigen::Map<const Eigen::VectorXd>& cone, bool astray, Values& factors);
    void wish(const Values&);
    void look();
    Values forWish();

    double rate_;
    int settled_;              ///< ticks after which a cone that gets all of the wish follows it
    int planStep_, wishStep_;  ///< samples: step lengths of plan and wish
    int looksEvery_;           ///< steps of the wish
    bool trusts_;              ///< near the limit, too, a cone that gets all of the wish needs no plan
    int committed_;            ///< number of samples on their way to the cone
    int known_;                ///< samples from now on of which the input is known
    LookTimes times_;
    Bands split_;
    std::array<Reference, bands> wish_;  ///< the motion of each band, not turned down
    // m, where a cone will be: one that moved as the wish and is left alone, the cone itself, and by what is played to
    // it
    LaidRows byWish_, byCone_, byInput_;
    ConeShift shift_;
    /// relative change of the excursion per relative error of the parameters
    double uncertainty_;

    // What is known of the input.
    std::array<std::array<double, latency>, bands> delayed_ {};
    std::size_t oldest_ = 0;
    std::vector<double> sent_;  ///< the latest committed_ outputs, a ring
    std::size_t sentAt_ = 0;
    Values sum_ {};                 ///< over the step of the wish
    int summed_ = 0, stepped_ = 0;  ///< samples of that step; steps since the wish was looked at

    // Gains: factors through the window.
    Path shape_ {};
    std::array<Path, bands> gain_ {};  ///< from the next sample on, if silence followed
    int place_ = 0;

    // Limits and what they come to.
    bool on_ = false;
    Glide displacement_, voltage_, power_;  ///< as reciprocals; 0: none
    struct Limits {
        double displacement = 0.0, voltage = 0.0;  ///< reciprocals
    };
    std::vector<Limits> past_;  ///< of the latest ticks, a ring
    std::size_t pastAt_ = 0;
    double displacementNow_ = 0.0;  ///< reciprocal
    double voltageNow_ = std::numeric_limits<double>::infinity(), share_ = 0.0;
    std::array<PeakHold, bands> wishHold_;  ///< of 1 - factor
    PeakHold reachHold_;                    ///< of how far the wish would coast, relative to the limit
    double reach_ = 0.0, farthest_ = 0.0;   ///< farthest_: m, how far it would coast within the limit
    double coasts_ = 0.0;                   ///< m, how far it would coast, of this tick
    Values need_ {1.0, 1.0, 1.0};           ///< of this tick
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
    Eigen::VectorXd future_, rest_, coasted_, aside_, state_;
    Eigen::MatrixXd drives_, driven_, parts_, wishes_;
};

}  // namespace excursion
