// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Effects/Effects.h"

#include <cmath>
#include <numbers>

namespace excursion {
namespace {

/// Above the band in which it moves as one piece the cone bends. Each mode is a small resonator on the coil,
///     y'' = -(w/Q) (y' - v) - w^2 (y - x),
/// whose own motion r = y - x is heard with a gain g and seen at the laser's spot with a gain h:
///     area (a + sum g_k r_k''),   x + sum h_k r_k.
/// The modes are taken for too light to be felt by the coil. Frequencies are told by their distance from places spread
/// over the upper three octaves of the band, so that what is plausible beforehand holds for each.
class ConeBreakup final : public EffectOf<ConeBreakup> {
public:
    ConeBreakup()
        : EffectOf({.id = "cone-breakup",
                    .title = "Cone breakup",
                    .physics = "Above some frequency the cone bends: parts of it move by themselves and radiate.",
                    .symptoms = "linear residual pressure in narrow peaks and dips at the top of the band, the same at "
                                "every level, with no trace of it in the current",
                    .remedy = "More damping in the cone or its surround, another shape of the cone, or a crossover "
                              "below the first mode.",
                    .electrical = false,
                    .linear = true})
    {
    }
    bool felt() const override { return false; }
    /// The displacement falls with the square of the frequency: where modes are, a laser that tells it sees its noise.
    bool shownBy(Quantity quantity) const override
    {
        return quantity == Quantity::pressure || quantity == Quantity::velocity || quantity == Quantity::acceleration;
    }

    std::vector<Parameter> parameters(const OperatingRange&) const override
    {
        std::vector<Parameter> result;
        for (int k = 1; k <= modes; ++k) {
            const auto add = [&](const char* letter, const char* unit, double prior, bool strength) {
                Parameter p;
                p.name = letter + std::to_string(k);
                p.unit = unit;
                p.prior = prior;
                p.strength = strength;
                result.push_back(p);
            };
            constexpr double octavesAround = 1.0, octavesOfQuality = 1.5;
            add("shift", "octaves", octavesAround, false);
            add("sharpness", "octaves", octavesOfQuality, false);
            add("g", "1", plausibleGain, true);
            add("h", "1", plausibleGain, true);
        }
        return result;
    }
    /// Broader and narrower modes are found from one of this quality, which is too narrow to stand for two at once.
    /// They lie so close that the next one is always within the width of a mode.
    std::vector<Part> parts(const OperatingRange&) const override
    {
        constexpr double quality = 12.0, step = 0.75 / quality, aboveBand = 0.1;  // octaves
        std::vector<Part> parts;
        for (int k = 0; k < modes; ++k) {
            Part part {static_cast<std::size_t>(each * k), each, {}};
            for (double octave = -octavesSearched; octave < aboveBand; octave += step)
                part.starts.push_back({octave - octaveOf(k), std::log2(quality / middlingQuality), 0.0, 0.0});
            parts.push_back(std::move(part));
        }
        return parts;
    }

    /// A mode rings, above the band in which the cone moves as one piece, and what swings is a part of the cone.
    bool plausible(const OperatingRange& e, const std::vector<Parameter>& own,
                   const std::vector<Parameter>& base) const override
    {
        constexpr double leastQuality = 2.0, mostGain = plausibleGain, lowest = 1.5;
        const double resonance = resonanceOf(base);
        // A laser hardly tells what a mode does at its spot: the gain may come out as large as its error.
        const auto tooLargeAtSpot = [](const Parameter& gain) {
            constexpr double most = 4.0 * mostGain;
            const double size = std::abs(gain.value),
                         error = std::isfinite(gain.standardError) ? gain.standardError : 0.0;
            return size > most || size - 2.0 * error > mostGain;
        };
        for (int k = 0; k < modes; ++k) {
            const auto* p = own.data() + each * k;
            const double frequency = e.highFrequency * std::exp2(octaveOf(k) + p[0].value),
                         quality = middlingQuality * std::exp2(p[1].value);
            if ((p[2].value != 0.0 || p[3].value != 0.0)
                && (frequency < lowest * resonance || quality < leastQuality || std::abs(p[2].value) > mostGain
                    || tooLargeAtSpot(p[3])))
                return false;
        }
        return true;
    }

    int memorySize(const OperatingRange&) const override { return 2 * modes; }
    int coefficientCount(const OperatingRange&) const override { return each * modes; }

    /// Coefficients of a mode: w^2, w/Q, g and h.
    template <class T>
    void prepareFor(const OperatingRange& e, const T* p, T* c) const
    {
        using std::exp;
        for (int k = 0; k < modes; ++k, p += each, c += each) {
            const double place = 2.0 * std::numbers::pi * e.highFrequency * std::exp2(octaveOf(k));
            const T w = place * exp(std::numbers::ln2 * p[0]);
            c[0] = w * w;
            c[1] = w * exp(-std::numbers::ln2 * p[1]) / middlingQuality;
            c[2] = p[2];
            c[3] = p[3];
        }
    }

    template <class T>
    void addTo(const OperatingRange&, const T* c, const Motion<T>& at, const T* memory, T* rate, Balance<T>&) const
    {
        for (int k = 0; k < modes; ++k, c += each, memory += 2, rate += 2) {
            rate[0] = memory[1];
            rate[1] = c[1] * (at.v - memory[1]) + c[0] * (at.x - memory[0]);
        }
    }

    template <class T>
    void radiate(const OperatingRange&, const T* c, const Motion<T>& at, const T& acceleration, const T* memory,
                 const T* rate, Emission<T>& sum) const
    {
        for (int k = 0; k < modes; ++k, c += each, memory += 2, rate += 2) {
            sum.acceleration += c[2] * (rate[1] - acceleration);
            sum.spot += c[3] * (memory[0] - at.x);
        }
    }

private:
    static constexpr int modes = 4, each = 4;
    static constexpr double spacing = 0.75;  // octaves from one place to the next
    static constexpr double plausibleGain = 3.0;
    static constexpr double octavesSearched = modes * spacing, middlingQuality = 5.0;

    /// A mode's own place, from the upper end of the band.
    static double octaveOf(int mode) { return spacing * (mode + 0.5 - modes); }
};

}  // namespace

const Effect& coneBreakup()
{
    static const ConeBreakup effect;
    return effect;
}

}  // namespace excursion
