// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

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

/// How many states a loop on `Four` takes at once.
inline constexpr std::size_t lanes = 4;

inline std::size_t roundedUpToLanes(std::size_t states) { return (states + lanes - 1) / lanes * lanes; }

/// What is known of each state, quantity by quantity (all of one length, a multiple of `lanes`), laid out as a loop
/// over the states reads it: all quantities of the first four states, then those of the next four.
inline std::vector<double> laidOut(const std::vector<std::vector<double>>& quantities)
{
    std::vector<double> result;
    for (std::size_t state = 0; state < quantities.front().size(); state += lanes)
        for (const auto& values : quantities)
            result.insert(result.end(), values.begin() + static_cast<std::ptrdiff_t>(state),
                          values.begin() + static_cast<std::ptrdiff_t>(state + lanes));
    return result;
}

/// One step of states that are laid out as decay, turn (what each takes of its neighbour in a block of two), `inputs`
/// weights and `outputs` sums:
///     y(1) = decay y(0) + turn y'(0) + sum_k input_k w_k,    output_k = sum y(1) s_k.
/// For a function that is compiled for several processors (EXCURSION_DISPATCH) to be made of.
template <int inputs, int outputs>
[[gnu::always_inline]] inline void advanceLaid(std::size_t rows, const double* laid, const double* input, double* state,
                                               double* output)
{
    Four sums[outputs] = {};
    for (std::size_t row = 0; row < rows; row += lanes) {
        const auto* const four = reinterpret_cast<const Four*>(laid + (2 + inputs + outputs) * row);
        auto& here = *reinterpret_cast<Four*>(state + row);
        Four next = four[0] * here + four[1] * __builtin_shufflevector(here, here, 1, 0, 3, 2);
        for (int k = 0; k < inputs; ++k)
            next += input[k] * four[2 + k];
        here = next;
        for (int k = 0; k < outputs; ++k)
            sums[k] += next * four[2 + inputs + k];
    }
    for (int k = 0; k < outputs; ++k)
        output[k] = (sums[k][0] + sums[k][1]) + (sums[k][2] + sums[k][3]);
}

}  // namespace excursion
