// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Predistortion/Speaker.h"

#include "Engine/Predistortion/Subnormals.h"

#include <algorithm>
#include <cmath>

namespace excursion {

Speaker::Speaker(const Model& model, const RealTimeOptions& options)
    : oversampling_((requireRunnable(model, options), options.oversampling)),
      cone_(model, options.sampleRate * options.oversampling),
      guard_ {Plausible(model).input()},
      recovery_(2 * oversampling_.latency() + static_cast<int>(0.02 * options.sampleRate),
                static_cast<int>(0.05 * options.sampleRate))
{
}

void Speaker::reset()
{
    cone_.reset();
    oversampling_.reset();
    recovery_.reset();
}

void Speaker::process(const double* in, double* out, std::size_t n)
{
    const FlushSubnormals flush;
    const auto factor = static_cast<std::size_t>(oversampling_.factor());
    while (n > 0) {
        const std::size_t count = std::min(n, Oversampling::longestBlock);
        guard_.pass(in, count, block_.data());
        oversampling_.up(block_.data(), count, fine_.data());
        for (std::size_t k = 0; k < count; ++k)
            for (std::size_t s = 0; s < factor; ++s) {
                auto& sample = fine_[k * factor + s];
                if (guard_.faultAt[k]) {
                    cone_.rest();
                    sample = 0.0;
                } else if (!cone_.step(sample)) {
                    guard_.faultAt[k] = true;
                }
                peak_.displacement = std::max(peak_.displacement, std::abs(cone_.displacement()));
                peak_.current = std::max(peak_.current, std::abs(cone_.current()));
            }
        oversampling_.down(fine_.data(), count, block_.data());
        for (std::size_t k = 0; k < count; ++k) {
            if (guard_.faultAt[k]) {
                recovery_.fault();
                faults_.fetch_add(1, std::memory_order_relaxed);
            }
            out[k] = withoutSubnormals(recovery_.step() * block_[k]);
        }
        in += count;
        out += count;
        n -= count;
    }
    displacement_.raise(peak_.displacement);
    current_.raise(peak_.current);
    peak_ = {};
}

Speaker::Meters Speaker::collectMeters()
{
    return {displacement_.readAndReset(), current_.readAndReset(), faults_.load(std::memory_order_relaxed)};
}

double plateau(const Model& model)
{
    const double m = model.baseParameter("m").value;
    return model.electrical() ? model.baseParameter("Bl").value / (model.baseParameter("Re").value * m) : 1.0 / m;
}

}  // namespace excursion
