// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Signal/Multisine.h"

#include "Engine/Error.h"
#include "Engine/Signal/Fft.h"
#include "Engine/Validity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

namespace excursion {
namespace {

constexpr std::array<std::string_view, 8> gridNames {"full", "odd", "odd-odd", "odd-random",
                                                     "R10",  "R20", "R40",     "R80"};
constexpr std::array<std::string_view, 3> shapeNames {"white", "pink", "red"};

template <class Enum, std::size_t n>
std::optional<Enum> named(const std::array<std::string_view, n>& names, std::string_view text)
{
    const auto found = std::find(names.begin(), names.end(), text);
    if (found == names.end())
        return std::nullopt;
    return static_cast<Enum>(found - names.begin());
}

/// Random numbers of one purpose: the lines, or the phases of a realization. Streams of the same seed
/// do not overlap in practice, because seed_seq scrambles all of its words.
class Stream {
public:
    Stream(std::uint64_t seed, std::uint32_t purpose)
    {
        std::seed_seq words {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32), purpose};
        generator_.seed(words);
    }
    /// Uniform on [0, 1). std::uniform_real_distribution may differ from library to library.
    double uniform() { return static_cast<double>(generator_() >> 11) * 0x1p-53; }

private:
    std::mt19937_64 generator_;
};

constexpr std::uint32_t linesPurpose = 0, firstPhasePurpose = 1;

int lastLine(int period) { return (period - 1) / 2; }

std::vector<int> logarithmicLines(int perDecade, int last)
{
    std::vector<int> lines;
    for (int i = 0;; ++i) {
        const double k = std::round(std::pow(10.0, static_cast<double>(i) / perDecade));
        if (k > last)
            return lines;
        if (lines.empty() || k > lines.back())
            lines.push_back(static_cast<int>(k));
    }
}

std::vector<int> steppedLines(int step, int last)
{
    std::vector<int> lines;
    for (int k = 1; k <= last; k += step)
        lines.push_back(k);
    return lines;
}

std::vector<int> gridLines(Grid grid, int last)
{
    switch (grid) {
    case Grid::full: return steppedLines(1, last);
    case Grid::odd:
    case Grid::oddRandom: return steppedLines(2, last);
    case Grid::oddOdd: return steppedLines(4, last);
    case Grid::R10: return logarithmicLines(10, last);
    case Grid::R20: return logarithmicLines(20, last);
    case Grid::R40: return logarithmicLines(40, last);
    case Grid::R80: return logarithmicLines(80, last);
    }
    return {};
}

/// An incomplete last group keeps all its lines.
std::vector<int> withOneLeftOutOfEachGroup(const std::vector<int>& lines, int groupSize, std::uint64_t seed)
{
    Stream random(seed, linesPurpose);
    const auto group = static_cast<std::size_t>(groupSize);
    std::vector<int> kept;
    for (std::size_t first = 0; first < lines.size(); first += group) {
        const bool complete = first + group <= lines.size();
        const auto leftOut = complete ? first + static_cast<std::size_t>(random.uniform() * groupSize) : lines.size();
        for (std::size_t i = first; i < std::min(first + group, lines.size()); ++i)
            if (i != leftOut)
                kept.push_back(lines[i]);
    }
    return kept;
}

double amplitude(Shape shape, int line)
{
    switch (shape) {
    case Shape::white: return 1.0;
    case Shape::pink: return 1.0 / std::sqrt(line);
    case Shape::red: return 1.0 / line;
    }
    return 1.0;
}

void requireValid(const MultisineOptions& options)
{
    std::string reason;
    if (!options.isValid(&reason))
        throw Error(Error::Kind::usage, reason);
}

}  // namespace

std::string_view name(Grid grid) { return gridNames[static_cast<std::size_t>(grid)]; }
std::string_view name(Shape shape) { return shapeNames[static_cast<std::size_t>(shape)]; }
std::optional<Grid> gridNamed(std::string_view text) { return named<Grid>(gridNames, text); }
std::optional<Shape> shapeNamed(std::string_view text) { return named<Shape>(shapeNames, text); }

bool MultisineOptions::isValid(std::string* reason) const
{
    if (!(std::isfinite(sampleRate) && sampleRate > 0))
        return refuse(reason, "The sample rate of a multisine must be a positive number of Hz.");
    if (period < 8 || period > (1 << 26))
        return refuse(reason, "The period of a multisine must be 8 to 67108864 samples.");
    if (!(std::isfinite(bandLow) && std::isfinite(bandHigh) && bandLow >= 0 && bandHigh > bandLow))
        return refuse(reason, "The band of a multisine must go from a frequency of at least 0 Hz up to a higher one.");
    if (bandHigh > sampleRate / 2)
        return refuse(reason, "The band of a multisine must end at or below half the sample rate.");
    if (!(std::isfinite(rms) && rms > 0))
        return refuse(reason, "The level of a multisine must be a positive number of V rms.");
    if (groupSize < 2 || groupSize > 1000)
        return refuse(reason, "A group of odd lines that misses one must hold 2 to 1000 lines.");
    return true;
}

std::vector<int> chooseLines(const MultisineOptions& options)
{
    requireValid(options);
    // A band edge that is meant to be a line stays in, whatever the rounding of f N / fs.
    constexpr double rounding = 1e-9;
    const double spacing = options.sampleRate / options.period;
    const double first = options.bandLow / spacing * (1 - rounding), last = options.bandHigh / spacing * (1 + rounding);
    auto lines = gridLines(options.grid, lastLine(options.period));
    std::erase_if(lines, [&](int k) { return k < first || k > last; });
    if (options.grid == Grid::oddRandom)
        lines = withOneLeftOutOfEachGroup(lines, options.groupSize, options.seed);
    if (lines.empty())
        throw Error(Error::Kind::usage, "No line of the grid lies in the band; widen the band or lengthen the period.");
    return lines;
}

std::vector<int> oddDetectionLines(const std::vector<int>& excited)
{
    std::vector<int> silent;
    if (excited.empty())
        return silent;
    for (int k = excited.front() | 1; k < excited.back(); k += 2)
        if (!std::binary_search(excited.begin(), excited.end(), k))
            silent.push_back(k);
    return silent;
}

std::vector<double> multisine(const MultisineOptions& options, const std::vector<int>& lines, int realization)
{
    requireValid(options);
    if (lines.empty() || lines.front() < 1 || lines.back() > lastLine(options.period)
        || !std::is_sorted(lines.begin(), lines.end()))
        throw Error(Error::Kind::usage,
                    "The lines of a multisine must ascend from 1 or more to less than half its period.");
    if (realization < 0)
        throw Error(Error::Kind::usage, "The realizations of a multisine are counted from 0.");

    const auto N = static_cast<std::size_t>(options.period);
    double power = 0.0;
    for (const int k : lines)
        power += std::pow(amplitude(options.shape, k), 2) / 2;
    const double scale = options.rms / std::sqrt(power) * static_cast<double>(N) / 2;  // a_k to |X_k|

    Stream random(options.seed, firstPhasePurpose + static_cast<std::uint32_t>(realization));
    std::vector<std::complex<double>> spectrum(N / 2 + 1);
    for (const int k : lines)
        spectrum[static_cast<std::size_t>(k)] = std::polar(scale * amplitude(options.shape, k),
                                                           2 * std::numbers::pi * random.uniform());
    return inverseFft(spectrum, N);
}

}  // namespace excursion
