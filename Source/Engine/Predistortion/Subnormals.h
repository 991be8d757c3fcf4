// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace excursion {

/// During its lifetime, this thread's arithmetic treats subnormal numbers as zero. Otherwise, a filter that rings out
/// would take a hundred times the time. (x86 and 64-bit ARM; elsewhere it does nothing.)
class FlushSubnormals {
public:
#if defined(__SSE2__)
    // flush to zero, subnormals are zeros
    FlushSubnormals() : before_(_mm_getcsr()) { _mm_setcsr(before_ | 0x8040u); }
    ~FlushSubnormals() { _mm_setcsr(static_cast<unsigned>(before_)); }
#elif defined(__aarch64__)
    FlushSubnormals()
    {
        asm volatile("mrs %0, fpcr" : "=r"(before_));
        asm volatile("msr fpcr, %0" ::"r"(before_ | (std::uint64_t {1} << 24)));
    }
    ~FlushSubnormals() { asm volatile("msr fpcr, %0" ::"r"(before_)); }
#else
    FlushSubnormals() = default;
#endif
    FlushSubnormals(const FlushSubnormals&) = delete;
    FlushSubnormals& operator=(const FlushSubnormals&) = delete;

private:
#if defined(__SSE2__)
    unsigned before_ = 0;
#else
    std::uint64_t before_ = 0;
#endif
};

/// Numbers far below the resolution of any converter become zero, also as a float.
inline double withoutSubnormals(double q) { return std::abs(q) < 1e-30 ? 0.0 : q; }

}  // namespace excursion
