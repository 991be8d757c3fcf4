// SPDX-License-Identifier: GPL-3.0-or-later
#include "Fuzz/Target.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sys/mman.h>
#include <unistd.h>

namespace excursion::fuzz {

void demand(bool holds, const char* promise)
{
    if (holds)
        return;
    std::fprintf(stderr, "broken promise: %s\n", promise);
    std::abort();
}

void demandSound(const Take& take)
{
    if (const auto* spectra = std::get_if<Spectra>(&take)) {
        demand(spectra->input() != nullptr, "spectra have an input");
        for (std::size_t k = 0; k < spectra->frequency.size(); ++k)
            demand(std::isfinite(spectra->frequency[k])
                       && spectra->frequency[k] > (k == 0 ? 0.0 : spectra->frequency[k - 1]),
                   "frequencies ascend");
        for (const auto& channel : spectra->channels) {
            demand(channel.values.size() == spectra->frequency.size(), "one value a frequency");
            for (const auto& value : channel.values)
                demand(std::isfinite(value.real()) && std::isfinite(value.imag()), "finite spectra");
        }
        return;
    }
    const auto& measurement = std::get<Measurement>(take);
    demand(std::isfinite(measurement.sampleRate) && measurement.sampleRate > 0.0, "a sample rate");
    demand(!measurement.input().samples.empty(), "an input with samples");
    for (const auto& channel : measurement.channels) {
        demand(channel.samples.size() == measurement.length(), "one sample a channel");
        demand(std::isfinite(channel.fullScale) && channel.fullScale > 0.0, "a full scale");
        for (const double sample : channel.samples)
            demand(std::isfinite(sample), "finite samples");
    }
}

MemoryFile::MemoryFile(const void* data, std::size_t size) : descriptor_(memfd_create("fuzz", 0))
{
    demand(descriptor_ >= 0 && write(descriptor_, data, size) == static_cast<ssize_t>(size), "a file in memory");
}

MemoryFile::~MemoryFile() { close(descriptor_); }

std::filesystem::path MemoryFile::path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

}  // namespace excursion::fuzz
