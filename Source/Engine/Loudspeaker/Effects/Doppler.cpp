// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Effects/Effects.h"

namespace excursion {
namespace {

/// The source of the sound moves: what leaves the cone at x has the way to the microphone shortened by x and is heard
/// earlier by x/c. The motion itself is not changed. The slowness 1/c is left to the data, so no unit of length or time
/// is taken for granted; in air it is 2.9 ms/m.
class Doppler final : public EffectOf<Doppler> {
public:
    Doppler()
        : EffectOf({.id = "doppler",
                    .title = "Doppler shift of the sound",
                    .physics = "The cone carries the source of its sound to and fro, so high tones are phase-modulated "
                               "by the excursion of low ones.",
                    .symptoms = "residual pressure around high tones at distances of low ones, growing with frequency "
                                "and excursion, with no trace of it in current or displacement",
                    .remedy = "Less excursion where treble is played: a crossover, or more area. No voltage removes it "
                              "for every tone at once.",
                    .electrical = false,
                    .linear = false})
    {
    }
    bool felt() const override { return false; }
    Evidence evidence() const override { return Evidence::lateness; }
    bool shownBy(Quantity quantity) const override { return quantity == Quantity::pressure; }

    std::vector<Parameter> parameters(const OperatingRange&) const override
    {
        return {{.name = "1/c", .unit = "s/m", .lower = 0.0, .strength = true}};
    }
    int coefficientCount(const OperatingRange&) const override { return 1; }

    template <class T>
    void prepareFor(const OperatingRange&, const T* p, T* c) const
    {
        c[0] = p[0];
    }

    template <class T>
    void addTo(const OperatingRange&, const T*, const Motion<T>&, const T*, T*, Balance<T>&) const
    {
    }

    template <class T>
    void radiate(const OperatingRange&, const T* c, const Motion<T>& at, const T&, const T*, const T*,
                 Emission<T>& sum) const
    {
        sum.lateness -= c[0] * at.x;
    }
};

}  // namespace

const Effect& doppler()
{
    static const Doppler effect;
    return effect;
}

}  // namespace excursion
