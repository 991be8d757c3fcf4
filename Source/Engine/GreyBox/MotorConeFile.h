// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/StateSpaceFile.h"

#include <nlohmann/json_fwd.hpp>

#include <limits>
#include <string>

namespace excursion {

/// A loudspeaker as motor and cone (MotorCone), with the names of what they connect.
struct NamedMotorCone {
    std::string source, name;  ///< path of the take or response, and what it is called
    double delay = 0.0;        ///< s, of the sound on its way
    double motorErrorDb = 0.0, coneErrorDb = 0.0,
           errorDb = 0.0;  ///< as MotorCone has them; NaN where one is not finite
    double motorChiSquared = std::numeric_limits<double>::quiet_NaN(),
           chiSquared = std::numeric_limits<double>::quiet_NaN();
    bool refined = false;
    double toldUpTo = 0.0;  ///< Hz
    std::string sentence;
    bool stable = false;
    NamedStateSpace motor, cone, cascade;
};

/// The document "excursion-motor-cone" 1 (Docs/Formats.md).
nlohmann::ordered_json toJson(const NamedMotorCone&);
NamedMotorCone motorConeFromJson(const JsonField&);

}  // namespace excursion
