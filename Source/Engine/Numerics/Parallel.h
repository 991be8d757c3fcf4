// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Progress.h"

#include <cstddef>
#include <functional>

namespace excursion {

/// Runs work(n) for n = 0 .. count - 1 on several threads, in any order, until one returns false or throws, which is
/// passed on, or the caller asks to stop (throws Error (cancelled)).
void inParallel(std::size_t count, unsigned threads, const Progress&, const std::function<bool(std::size_t)>& work);

}  // namespace excursion
