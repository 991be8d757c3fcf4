// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Check/TakeCheck.h"

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace excursion::cli {

class Terminal;

/// The figures of each channel, what is wrong, and the verdict, for a person.
void sayCheck(const CheckReport&, Terminal&);

/// The document "excursion-check", version 1.
nlohmann::ordered_json checkJson(const CheckReport&, const std::string& take, double sampleRate);

}  // namespace excursion::cli
