// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Ladder.h"

#include <string>
#include <vector>

namespace excursion::cli {

class Terminal;

/// Prints a ladder while it grows: the noise floor, then each rung as soon as its diagnosis is known, with what it
/// names as missing and why.
class LiveLadder {
public:
    explicit LiveLadder(Terminal& terminal) : terminal_(terminal) {}

    void show(const Rung&);

    /// What was taken back, the problems of the take, and the verdict.
    void end(const Ladder&);

private:
    void begin(const Comparison&);
    void row(const std::string& label, const std::vector<std::string>& cells);

    Terminal& terminal_;
    std::vector<std::string> titles_;
    int rungs_ = 0;
    bool again_ = false;  ///< the ladder has begun again
};

}  // namespace excursion::cli
