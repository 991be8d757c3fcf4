// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Check/TakeCheck.h"
#include "Engine/Estimate/Record.h"
#include "Engine/Take/Measurement.h"

#include <memory>

namespace excursion {

/// A take that was made ready, once, for all that is asked of it: its excitation is completed (completeExcitation()),
/// it is checked, and it is cut into sections that models are compared with. All that works on a take as a whole asks
/// for one of these. Copies share the take; any thread may read it.
class PreparedTake {
public:
    // Implicit, so that a raw take is prepared where a prepared one is asked for.
    PreparedTake(Take);
    PreparedTake(Measurement);
    PreparedTake(Spectra);

    const Take& either() const;
    /// Null where the take is a frequency response, or is none.
    const Measurement* inTime() const;
    const Spectra* asResponses() const;

    /// The take in time. Throws Error (data) when it is a frequency response.
    const Measurement& measurement() const;

    /// The take in time with the ends of its sections settled (settleEnds()) and without the hum of the mains
    /// (takeOffHum()): what models are fitted to. Made when it is first asked for; the take itself where nothing rings
    /// or hums.
    const Measurement& settled() const;

    /// Of what was measured. Made when it is first asked for.
    const CheckReport& report() const;

    /// The settled take cut into sections (MakeRecord.h), with the pressure as the check
    /// has found its path (CheckReport::sound): corrected by the microphone's roll-off, or set aside; so it checks the
    /// take. Made when it is first asked for; a copy of it is adapted to a model (adapt()). Throws Error (data) as
    /// makeRecord() does, and when the take is a frequency response.
    const Record& record() const;

private:
    struct State;
    std::shared_ptr<const State> state_;
};

}  // namespace excursion
