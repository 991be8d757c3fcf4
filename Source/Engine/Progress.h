// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Error.h"

#include <functional>
#include <stop_token>
#include <string_view>

namespace excursion {

/// How long work tells its caller where it is and learns that it should stop.
/// Both members may be left empty. `report` is called from the thread that called the work, with a
/// fraction of 0..1 and a short phrase such as "fitting stiffness".
struct Progress {
    std::function<void(double fraction, std::string_view what)> report;
    std::stop_token stop;

    /// Reports and throws Error (cancelled) when the caller asked to stop.
    void at(double fraction, std::string_view what) const
    {
        if (stop.stop_requested())
            throw Error(Error::Kind::cancelled, "The work was cancelled; nothing was written.");
        if (report)
            report(fraction, what);
    }

    /// For a part of the work that stops when asked to, and reports nothing.
    Progress silent() const { return {.report = {}, .stop = stop}; }

    /// A stretch [from, to] of this progress, to hand to a part of the work.
    Progress part(double from, double to) const
    {
        Progress inner;
        inner.stop = stop;
        if (report)
            inner.report = [report = report, from, to](double fraction, std::string_view what) {
                report(from + (to - from) * fraction, what);
            };
        return inner;
    }
};

}  // namespace excursion
