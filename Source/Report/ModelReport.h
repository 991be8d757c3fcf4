// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Document/JsonField.h"

#include <filesystem>
#include <string>

namespace excursion {

/// The page of one document: a state space or a fractional one (poles and zeros, gain surface), an identification (the
/// error against the order, chi squared against alpha, and its model), a PNLSS fit (how the error fell, its linear
/// part), harmonic distortion, or a ranking of classes. Throws Error (input) for another document, naming those that
/// have a page, (numerical) when gnuplot is missing.
std::string documentHtml(const JsonField&);

void writeDocumentPage(const JsonField&, const std::filesystem::path&);

}  // namespace excursion
