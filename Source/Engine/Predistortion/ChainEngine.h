// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/Fade.h"
#include "Engine/Predistortion/Predistorter.h"
#include "Engine/Predistortion/Speaker.h"

#include <cstddef>

namespace excursion {

/// What a Chain puts a signal through, of whatever class the model is: a predistorter, and behind it the modelled
/// loudspeaker, either of them switched in and out while it runs. Everything but the construction is for the audio
/// thread: no allocation, no lock, no exception; blocks may be cut in any way.
class ChainEngine {
public:
    static constexpr std::size_t longestPart = Predistorter::longestPart;

    virtual ~ChainEngine() = default;

    virtual int latency() const = 0;       ///< samples, whatever is switched in; fixed
    virtual std::size_t room() const = 0;  ///< that process() may be given now, 1 to longestPart samples

    virtual void reset() = 0;         ///< as if new
    virtual void resetBending() = 0;  ///< the predistorter is off, and knows nothing of before
    virtual void resetPlaying() = 0;  ///< the loudspeaker is at rest

    virtual double heat() const = 0;     ///< W, the running mean of the coil's heat; 0 where it is not known
    virtual void warm(double heat) = 0;  ///< W, what of it is there from before

    virtual void set(const PredistortionControls&) = 0;  ///< where they are to go; what a class does not know is left
    virtual void turn(bool bends) = 0;                   ///< off, the predistorter lets the signal through as it is
    /// @param share  how much of the linear loudspeaker's output is taken away, 0 to 1; followed smoothly
    virtual void setLinearShareRemoved(double share) = 0;

    /// @param volts   n samples, become what comes out: V, or of the loudspeaker what is heard at the level of that
    /// @param played  how much of what comes out is the loudspeaker's; is stepped once a sample
    virtual void process(double* volts, std::size_t n, Fade& played) = 0;

    virtual void publish() = 0;  ///< lets collectMeters() see what has come out

    struct Meters {
        Predistorter::Meters predistorter;
        Speaker::Meters speaker;
        double region = 0.0;  ///< of a model without physics: how far out it went, 1 as far as its fit has been
        int faults = 0;       ///< since construction
    };
    virtual Meters collectMeters() = 0;  ///< from any one thread
};

}  // namespace excursion
