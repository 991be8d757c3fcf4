// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/Fade.h"
#include "Engine/Predistortion/Predistorter.h"
#include "Engine/Predistortion/Speaker.h"
#include "Engine/Predistortion/Warmth.h"

#include <cstddef>

namespace excursion {

/// The processing of a Chain, for any class of model: a predistorter, followed by the modelled loudspeaker. Either of
/// them can be switched in and out while it runs. Everything but the construction is for the audio thread: no
/// allocation, no lock, no exception. Blocks may have any length.
class ChainEngine {
public:
    static constexpr std::size_t longestPart = Predistorter::longestPart;

    virtual ~ChainEngine() = default;

    virtual int latency() const = 0;       ///< samples; fixed, does not depend on what is switched in
    virtual std::size_t room() const = 0;  ///< samples that process() accepts now, 1 to longestPart

    virtual void reset() = 0;         ///< as if new
    virtual void resetBending() = 0;  ///< the predistorter is off, and its memory is cleared
    virtual void resetPlaying() = 0;  ///< the loudspeaker is at rest, as warm as it is

    virtual Warmth warmth() const = 0;     ///< of the coil, as far as it is known
    virtual void warm(const Warmth&) = 0;  ///< as it is from before
    /// While process() is not called: the loudspeaker is given these volts, n samples, at most longestPart.
    virtual void pass(const double* volts, std::size_t n) = 0;

    virtual void set(const PredistortionControls&) = 0;  ///< new targets; a class ignores those that it lacks
    virtual void turn(bool bends) = 0;                   ///< if off, the predistorter passes the signal unchanged
    /// @param share  how much of the linear loudspeaker's output is subtracted, 0 to 1; followed within a second
    virtual void setLinearShareRemoved(double share) = 0;

    /// @param volts   n samples, replaced by the output: V, or the loudspeaker's sound at the same level
    /// @param played  weight of the loudspeaker in the output; stepped once per sample
    virtual void process(double* volts, std::size_t n, Fade& played) = 0;

    virtual void publish() = 0;  ///< makes the latest output visible to collectMeters()

    struct Meters {
        Predistorter::Meters predistorter;
        Speaker::Meters speaker;
        double region = 0.0;  ///< for a model without physics: how far out it went; 1: as far as in its fit
        int faults = 0;       ///< since construction
    };
    virtual Meters collectMeters() = 0;  ///< from any one thread
};

}  // namespace excursion
