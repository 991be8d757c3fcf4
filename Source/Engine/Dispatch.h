// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

/// Marks a function that is compiled for the processors of today and for any; the program takes the better one when it
/// starts. Its loops should be plain, or on `Four`. Compiled once where there is no choice: not x86, not ELF, or
/// sanitizers.
#if defined(__x86_64__) && defined(__ELF__) && defined(__GNUC__) && !defined(__clang__)                                \
    && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define EXCURSION_DISPATCH __attribute__((target_clones("arch=x86-64-v3", "default")))
#else
#define EXCURSION_DISPATCH
#endif

namespace excursion {

/// Four doubles that are computed with at once, at any address; the compiler splits them where registers are shorter.
/// Not passed to or returned from functions that are not inlined: how depends on the processor.
using Four = double __attribute__((vector_size(32), aligned(8), may_alias));

}  // namespace excursion
