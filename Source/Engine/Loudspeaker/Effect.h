// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Number.h"
#include "Engine/Numerics/Lanes.h"
#include "Engine/Take/Measurement.h"

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace excursion {

/// The motion at the instant at which an effect contributes.
template <class T>
struct Motion {
    T i;  ///< coil current, A
    T x;  ///< coil displacement, m, positive outward
    T v;  ///< coil velocity, m/s
};

/// The sum of the contributions of the base and the effects. With the flux phi(i, x) of the coil they close the two
/// equations of the driver ([B 2.1, 2.2], extended):
///     u            = drop + d(phi)/dt = drop + inductance di/dt + fluxSlope v
///     mass dv/dt   = force
template <class T>
struct Balance {
    T inductance {0.0};  ///< d(phi)/di, H
    T fluxSlope {0.0};   ///< d(phi)/dx, V s/m, without the force factor's own motion voltage
    T drop {0.0};        ///< voltage drops and motion voltage, V
    T force {0.0};       ///< N, positive outward
    T mass {0.0};        ///< kg
};

/// What a coil keeps of its inductance L = d(phi)/di, with L0 at rest and l = L0/20, the share of air:
///     L from 2 l on,   l + L^2/(4 l) from 0 to 2 l,   l below.
/// Iron can be saturated or left, no more. A law that says less has been bent where the take seldom was; without this
/// bound its current would run away.
template <class T>
T keptInductance(const T& L, const T& L0)
{
    constexpr double air = 1.0 / 20.0;
    const T l = air * L0;
    if (L > 2.0 * l)
        return L;
    return L > T(0.0) ? l + L * L / (4.0 * l) : l;
}

/// The output of the driver at an instant, from the base's motion and the effects. The microphone at distance d
/// measures
///     p(t + lateness) = rho/(2 pi d) area acceleration     (a half space; rho = 1.2 kg/m^3),
/// the laser measures x + spot.
template <class T>
struct Emission {
    T area {0.0};          ///< m^2, reference area of the acceleration
    T acceleration {0.0};  ///< m/s^2, outward: volume acceleration over the area
    T lateness {0.0};      ///< s from this instant until its sound reaches the microphone
    T spot {0.0};          ///< m, how far the laser's point is ahead of the coil
};

/// The range and resolution in which an effect is valid: what the take really visited. It is part of the model, so a
/// model means the same wherever it is loaded.
struct OperatingRange {
    double displacement = 1e-3;    ///< peak, m
    double velocity = 1.0;         ///< peak, m/s
    double current = 1.0;          ///< peak, A
    double lowFrequency = 10.0;    ///< Hz, lowest frequency of interest
    double highFrequency = 1.0e4;  ///< Hz, highest frequency of interest
    int degree = 6;                ///< degree of a law's expansion
    /// what is large for a law, in the unit of the base parameter that it modifies, see resize()
    double scale = 1.0;
    double duration = 10.0;  ///< s, of the take: the time that a slow memory had
    /// relaxed parameters may differ from zero; false saves the memory that they need
    bool relaxed = true;
    bool joint = true;  ///< joint parameters may differ from zero: another law of the same base parameter is there
    std::vector<double> host {};  ///< parameters of the effect within which it acts, Effect::host(); not in files
};

struct Parameter {
    std::string name;
    std::string unit;
    double value = 0.0;
    double lower = -std::numeric_limits<double>::infinity();
    double upper = std::numeric_limits<double>::infinity();
    bool free = true;  ///< a fit may change it
    /// has a meaning only together with an effect of its domain that relaxes: zero and not free without one
    bool relaxed = false;
    /// has a meaning only together with another law of the same base parameter: zero and not free without one
    bool joint = false;
    bool heard = false;  ///< only the sound shows it: not free if none was measured
    /// its sign says nothing, so that its slope vanishes at zero (SearchCoordinates); it has a prior and no bounds
    bool even = false;
    /// by which a relaxation departs from the law that its effect follows beforehand (RelaxationSpectrum.h)
    bool departure = false;
    bool strength = false;  ///< if all strengths of an effect are zero, it is absent
    /// prior: plausible standard deviation about zero
    double prior = std::numeric_limits<double>::infinity();
    double standardError = std::numeric_limits<double>::quiet_NaN();  ///< NaN: unknown or not identifiable
};

/// A parameter that must not be negative.
inline Parameter positiveParameter(std::string name, std::string unit, double value)
{
    return {.name = std::move(name), .unit = std::move(unit), .value = value, .lower = 0.0};
}

/// The parameter with this name; throws std::out_of_range.
const Parameter& parameterNamed(const std::vector<Parameter>&, std::string_view name);

/// Resonance in Hz of a base with these parameters, sqrt(K/m)/(2 pi).
double resonanceOf(const std::vector<Parameter>& base);

/// A characteristic number of an effect that has too many parameters to show.
struct Figure {
    std::string name;
    std::string unit;
    double value = 0.0;
    double standardError = std::numeric_limits<double>::quiet_NaN();  ///< NaN: unknown
};

/// A law is the well-known curve of an effect: Bl(x), K(x), Le(x), Rms(v). The effect adds a difference, zero at rest,
/// to a parameter of the base.
struct LawInfo {
    std::string name;      ///< "Bl(x)"
    std::string unit;      ///< "N/A"
    std::string argument;  ///< "x", "v" or "i"
    std::string argumentUnit;
    std::string base;  ///< name of the base parameter it adds to
};

/// What shows an effect of a model to a person: the picture that an engineer would ask for.
enum class Evidence {
    law,       ///< its law, LawInfo
    response,  ///< the frequency response that it changes
    loop,      ///< force against displacement, with a memory of where the cone turned
    drift,     ///< resistance against time while the coil carries a steady current
    lateness   ///< of the sound, against displacement
};

/// One of the similar parts that an effect is the sum of, such as a mode of the cone.
struct Part {
    std::size_t first = 0, count = 0;  ///< its parameters; with its strengths at zero it has no effect
    /// start values for a search, strengths zero, similar ones next to each other
    std::vector<std::vector<double>> starts;
};

/// Where a search begins again: values of the effect, and another resonance of the base.
struct Restart {
    double resonance = 0.0;   ///< of the base alone, Hz
    std::vector<double> own;  ///< the effect's parameters
};

/// The names and descriptions of an effect, and the two facts that decide where it can occur.
struct EffectCard {
    std::string id;           ///< "force-factor"
    std::string title;        ///< "Force factor Bl(x)"
    std::string physics;      ///< one sentence
    std::string symptoms;     ///< how it shows, in words that the user can check on a plot
    std::string remedy;       ///< what a designer can do about it
    bool electrical = false;  ///< needs a coil; a mechanical-only driver has none
    bool linear = false;      ///< changes the frequency response, adds no distortion
};

/// One physical effect. A subclass contains all of it: its card, its parameters, its memory, and its contributions to
/// the driver's two equations and to the emitted sound, written once through EffectOf for any number type.
class Effect {
public:
    explicit Effect(EffectCard card) : card_(std::move(card)) {}
    virtual ~Effect() = default;

    const std::string& id() const { return card_.id; }
    const std::string& title() const { return card_.title; }
    const std::string& physics() const { return card_.physics; }
    const std::string& symptoms() const { return card_.symptoms; }
    const std::string& remedy() const { return card_.remedy; }
    bool electrical() const { return card_.electrical; }
    bool linear() const { return card_.linear; }
    virtual bool felt() const { return true; }             ///< acts on coil and cone; else it is only heard or seen
    virtual bool shownBy(Quantity) const { return true; }  ///< a channel of this quantity can show it
    virtual bool undone() const { return felt(); }         ///< predistortion compensates it; else it ignores it

    /// The picture that shows it: its law (Laws.h), a response, or a portrait (Portrait.h).
    virtual Evidence evidence() const { return law() ? Evidence::law : Evidence::response; }

    virtual std::vector<Parameter> parameters(const OperatingRange&) const = 0;

    /// Shapes to try if nothing is known yet: parameter vectors with every strength at zero.
    virtual std::vector<std::vector<double>> starts(const OperatingRange&) const;

    /// For a linear effect that is a sum of parts, which may be narrow. A search on finely resolved frequency responses
    /// adds them one after the other, each where it explains most of the remainder, as long as another one is
    /// justified. None: the effect is searched as a whole.
    virtual std::vector<Part> parts(const OperatingRange&) const;

    /// Additional starts for a search on a frequency response, of this start with the base elsewhere: a base that was
    /// fitted without the effect may have settled on a resonance of the effect, or do part of its work.
    virtual std::vector<Restart> restarts(const OperatingRange&, const std::vector<double>& start,
                                          const std::vector<Parameter>& base) const;

    /// Where a step of a search leads, that by its slopes leads from `from` to `p`: changes p so that what the effect
    /// does follows the slopes further. As it is: the slopes hold far enough.
    virtual void follow(const OperatingRange&, const double* from, double* p) const;

    /// Whether these values are plausible for the effect, with a base of these parameters. If not, the effect stands
    /// for something else, and it is not named.
    virtual bool plausible(const OperatingRange&, const std::vector<Parameter>& own,
                           const std::vector<Parameter>& base) const;

    /// A summary of the parameters in a few numbers (without errors, see figuresOf() in Summary.h); none if the
    /// parameters speak for themselves.
    virtual std::vector<Figure> summary(const OperatingRange&, const double* parameters) const;

    virtual std::optional<LawInfo> law() const { return std::nullopt; }
    /// The difference that the effect adds to the base parameter of its law at `argument`.
    virtual double lawAt(const OperatingRange&, const double* parameters, double argument) const;
    /// Of a law whose work is partly delayed by what relaxes: what that adds to lawAt() at a frequency in Hz.
    virtual double delayedLawAt(const OperatingRange&, const double* parameters, double argument,
                                double frequency) const;

    /// Name of the base parameter that makes OperatingRange::scale (see resize()); for a law, the one that it modifies.
    /// Empty: none.
    virtual std::string sizedBy() const;

    /// The linear effect within which it acts. What it prepares from are its own parameters and then those of that
    /// effect, of which OperatingRange::host is not empty in a model that has it; it does nothing in another.
    virtual const Effect* host() const { return nullptr; }

    virtual int memorySize(const OperatingRange&) const { return 0; }  ///< extra states
    /// The memory changes little within a period: its content depends on the whole take before. Its rate must be affine
    /// in it.
    virtual bool slow() const { return false; }
    /// Linear, and yields over time: a suspension that creeps, loops in the iron.
    virtual bool relaxes() const { return false; }
    bool creeps() const { return relaxes() && !electrical(); }
    /// What a linear effect that relaxes adds to a base parameter at a frequency in Hz: to K as Re F/x, to Rms as
    /// Im F/(w x), to Le as Im u/(w i); else 0. The data tells the sum, and how that divides into the two only as far
    /// as the relaxations lie within the band.
    virtual double addsTo(std::string_view base, const OperatingRange&, const double* parameters,
                          double frequency) const;
    virtual int coefficientCount(const OperatingRange&) const = 0;

    /// Turns parameters into coefficients, once per run: everything that depends on the parameters alone.
    virtual void prepare(const OperatingRange&, const double* parameters, double* coefficients) const = 0;
    virtual void prepare(const OperatingRange&, const Jet* parameters, Jet* coefficients) const = 0;

    /// Adds to the balance, and writes the time derivative of its memory. Called several times per sample: no
    /// allocation, no lock, no exception.
    virtual void contribute(const OperatingRange&, const double* coefficients, const Motion<double>&,
                            const double* memory, double* memoryRate, Balance<double>&) const = 0;
    virtual void contribute(const OperatingRange&, const Jet* coefficients, const Motion<Jet>&, const Jet* memory,
                            Jet* memoryRate, Balance<Jet>&) const = 0;
    virtual void contribute(const OperatingRange&, const Tangent* coefficients, const Motion<Tangent>&,
                            const Tangent* memory, Tangent* memoryRate, Balance<Tangent>&) const = 0;

    /// Whether it adds to the emission.
    virtual bool emits() const = 0;

    /// Adds to the emission. Called after contribute(), whose memoryRate is needed for what a memory radiates.
    /// @param acceleration  of the coil, m/s^2
    virtual void emit(const OperatingRange&, const double* coefficients, const Motion<double>&,
                      const double& acceleration, const double* memory, const double* memoryRate,
                      Emission<double>&) const = 0;
    virtual void emit(const OperatingRange&, const Jet* coefficients, const Motion<Jet>&, const Jet& acceleration,
                      const Jet* memory, const Jet* memoryRate, Emission<Jet>&) const = 0;

private:
    EffectCard card_;
};

/// Lets a subclass write its physics once:
///     template <class T> void prepareFor(const OperatingRange&, const T* parameters, T* coefficients) const;
///     template <class T> void addTo(const OperatingRange&, const T* coefficients, const Motion<T>&, const T* memory,
///                                   T* memoryRate, Balance<T>&) const;
/// and, if it is heard or seen other than through the cone's motion,
///     template <class T> void radiate(const OperatingRange&, const T* coefficients, const Motion<T>&, const T&
///     acceleration,
///                                     const T* memory, const T* memoryRate, Emission<T>&) const;
template <class Self>
class EffectOf : public Effect {
public:
    using Effect::Effect;

    void prepare(const OperatingRange& e, const double* p, double* c) const final { self().prepareFor(e, p, c); }
    void prepare(const OperatingRange& e, const Jet* p, Jet* c) const final { self().prepareFor(e, p, c); }
    void contribute(const OperatingRange& e, const double* c, const Motion<double>& motion, const double* memory,
                    double* rate, Balance<double>& balance) const final
    {
        add(self(), e, c, motion, memory, rate, balance);
    }
    void contribute(const OperatingRange& e, const Jet* c, const Motion<Jet>& motion, const Jet* memory, Jet* rate,
                    Balance<Jet>& balance) const final
    {
        add(self(), e, c, motion, memory, rate, balance);
    }
    void contribute(const OperatingRange& e, const Tangent* c, const Motion<Tangent>& motion, const Tangent* memory,
                    Tangent* rate, Balance<Tangent>& balance) const final
    {
        add(self(), e, c, motion, memory, rate, balance);
    }
    bool emits() const final { return radiates<double>; }
    void emit(const OperatingRange& e, const double* c, const Motion<double>& motion, const double& acceleration,
              const double* memory, const double* rate, Emission<double>& emission) const final
    {
        emitFor(e, c, motion, acceleration, memory, rate, emission);
    }
    void emit(const OperatingRange& e, const Jet* c, const Motion<Jet>& motion, const Jet& acceleration,
              const Jet* memory, const Jet* rate, Emission<Jet>& emission) const final
    {
        emitFor(e, c, motion, acceleration, memory, rate, emission);
    }

private:
    // Frequently called code is compiled for the present processor, with everything that it calls. A virtual function
    // itself cannot be.
    EXCURSION_DISPATCH [[gnu::flatten]] static void add(const Self& self, const OperatingRange& e, const double* c,
                                                        const Motion<double>& motion, const double* memory,
                                                        double* rate, Balance<double>& balance)
    {
        self.addTo(e, c, motion, memory, rate, balance);
    }
    EXCURSION_DISPATCH [[gnu::flatten]] static void add(const Self& self, const OperatingRange& e, const Jet* c,
                                                        const Motion<Jet>& motion, const Jet* memory, Jet* rate,
                                                        Balance<Jet>& balance)
    {
        self.addTo(e, c, motion, memory, rate, balance);
    }
    EXCURSION_DISPATCH [[gnu::flatten]] static void add(const Self& self, const OperatingRange& e, const Tangent* c,
                                                        const Motion<Tangent>& motion, const Tangent* memory,
                                                        Tangent* rate, Balance<Tangent>& balance)
    {
        self.addTo(e, c, motion, memory, rate, balance);
    }

    template <class T, class Whose = Self>
    static constexpr bool radiates = requires(const Whose& effect, const OperatingRange& e, const T* of,
                                              const Motion<T>& motion, Emission<T>& emission)
    {
        effect.radiate(e, of, motion, motion.i, of, of, emission);
    };
    template <class T>
    void emitFor(const OperatingRange& e, const T* c, const Motion<T>& motion, const T& acceleration, const T* memory,
                 const T* rate, Emission<T>& emission) const
    {
        if constexpr (radiates<T>)
            self().radiate(e, c, motion, acceleration, memory, rate, emission);
    }
    const Self& self() const { return static_cast<const Self&>(*this); }
};

}  // namespace excursion
