// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Diagnose.h"
#include "Engine/Document/JsonField.h"

#include <nlohmann/json.hpp>

#include <vector>

namespace excursion {

/// A diagnosis as a document, format "excursion-diagnosis", version 1 (Docs/Formats.md). The refitted models of the
/// candidates are not written: `add` computes them again.
nlohmann::ordered_json toJson(const Diagnosis&);
Diagnosis diagnosisFromJson(const JsonField&);

nlohmann::ordered_json toJson(const std::vector<Problem>&);
std::vector<Problem> problemsFromJson(const JsonField&);

Verdict verdictFromJson(const JsonField&);
std::vector<std::string> textsFromJson(const JsonField&);

}  // namespace excursion
