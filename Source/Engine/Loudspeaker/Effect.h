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

/// The instant at which an effect is asked what it adds.
template <class T>
struct Motion {
    T i;  ///< coil current, A
    T x;  ///< coil displacement, m, positive outward
    T v;  ///< coil velocity, m/s
};

/// What the base and the effects add up to. With the flux phi(i, x) of the coil these close the two
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

/// What leaves the driver at an instant, as the base's motion and the effects make it. The microphone at distance d
/// hears
///     p(t + lateness) = rho/(2 pi d) area acceleration     (a half space; rho = 1.2 kg/m^3),
/// the laser sees x + spot.
template <class T>
struct Emission {
    T area {0.0};          ///< m^2 that the acceleration is referred to
    T acceleration {0.0};  ///< m/s^2, outward: the volume that is moved, over the area
    T lateness {0.0};      ///< s from this instant to its sound at the microphone
    T spot {0.0};          ///< m, by which the point that the laser sees is ahead of the coil
};

/// Where and how finely an effect is to hold: what the take really visited. It is part of a model, so a
/// model means the same wherever it is loaded.
struct OperatingRange {
    double displacement = 1e-3;    ///< peak, m
    double velocity = 1.0;         ///< peak, m/s
    double current = 1.0;          ///< peak, A
    double lowFrequency = 10.0;    ///< Hz, lowest frequency of interest
    double highFrequency = 1.0e4;  ///< Hz, highest frequency of interest
    int degree = 6;                ///< of a law's expansion
    /// the base parameter that the effect is sized by, in its unit: what is large for a law
    double scale = 1.0;
    double duration = 10.0;  ///< s, of the take: what a slow memory had time for
    /// parameters that are relaxed may differ from zero: false spares the memory that they stand for
    bool relaxed = true;
};

struct Parameter {
    std::string name;
    std::string unit;
    double value = 0.0;
    double lower = -std::numeric_limits<double>::infinity();
    double upper = std::numeric_limits<double>::infinity();
    bool free = true;  ///< may a fit move it
    /// means something beside an effect that relaxes only: zero and not free without one
    bool relaxed = false;
    bool heard = false;     ///< only the sound shows it: not free where none was measured
    bool strength = false;  ///< an effect whose strengths are all zero is absent
    /// standard deviation about zero that is plausible beforehand
    double prior = std::numeric_limits<double>::infinity();
    double standardError = std::numeric_limits<double>::quiet_NaN();  ///< NaN: unknown or not identifiable
};

/// A parameter of which only what is not negative makes sense.
inline Parameter positiveParameter(std::string name, std::string unit, double value)
{
    return {.name = std::move(name), .unit = std::move(unit), .value = value, .lower = 0.0};
}

/// The parameter of that name; throws std::out_of_range.
const Parameter& parameterNamed(const std::vector<Parameter>&, std::string_view name);

/// Resonance in Hz of a base with these parameters, sqrt(K/m)/(2 pi).
double resonanceOf(const std::vector<Parameter>& base);

/// A number that a person knows an effect by, where its parameters are too many to be told.
struct Figure {
    std::string name;
    std::string unit;
    double value = 0.0;
    double standardError = std::numeric_limits<double>::quiet_NaN();  ///< NaN: unknown
};

/// A law is a curve a person knows the effect by: Bl(x), K(x), Le(x), Rms(v). The effect adds a
/// difference, zero at rest, to a parameter of the base.
struct LawInfo {
    std::string name;      ///< "Bl(x)"
    std::string unit;      ///< "N/A"
    std::string argument;  ///< "x", "v" or "i"
    std::string argumentUnit;
    std::string base;  ///< name of the base parameter it adds to
};

/// One of the like parts that an effect is the sum of, such as a mode of the cone.
struct Part {
    std::size_t first = 0, count = 0;  ///< its parameters; with its strengths at zero it does nothing
    /// values of these from which a search may begin, strengths zero, like beside like
    std::vector<std::vector<double>> starts;
};

/// What an effect is called and how a person knows it, and the two facts that decide where it can be.
struct EffectCard {
    std::string id;           ///< "force-factor"
    std::string title;        ///< "Force factor Bl(x)"
    std::string physics;      ///< one sentence
    std::string symptoms;     ///< what betrays it, in words a person can check on a plot
    std::string remedy;       ///< what a designer can do about it
    bool electrical = false;  ///< needs a coil; a mechanical-only driver has none
    bool linear = false;      ///< changes the frequency response, adds no distortion
};

/// One physical effect. A subclass is the whole of it: its card, its parameters, its memory, what it adds to the
/// driver's two equations and what to the sound that leaves it, written once through EffectOf for any number type.
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
    virtual bool felt() const { return true; }             ///< acts on coil and cone; else it is heard or seen only
    virtual bool shownBy(Quantity) const { return true; }  ///< a channel of that quantity can show it
    virtual bool undone() const { return felt(); }  ///< predistortion reckons with it; else it leaves it as it is

    virtual std::vector<Parameter> parameters(const OperatingRange&) const = 0;

    /// Shapes to try when nothing is known yet: parameter vectors with every strength at zero.
    virtual std::vector<std::vector<double>> starts(const OperatingRange&) const;

    /// For a linear effect that is a sum of parts, which may be narrow: a search on finely resolved frequency responses
    /// takes them up one after the other, each where it explains most of what is left, for as long as another one pays.
    /// None: the effect is searched as a whole.
    virtual std::vector<Part> parts(const OperatingRange&) const;

    /// Resonances of the base in Hz from which a search on a frequency response begins together with a start, besides
    /// the one that the base has: a base that was fitted without the effect may sit on a part of what the effect does.
    virtual std::vector<double> restarts(const OperatingRange&, const std::vector<double>& start) const;

    /// Whether such values can be the effect's own, beside a base with those parameters. If not, its shape has been
    /// bent to stand for something else, and it is not named.
    virtual bool plausible(const OperatingRange&, const std::vector<Parameter>& own,
                           const std::vector<Parameter>& base) const;

    /// What the parameters come to, in a few numbers (without errors, see figuresOf() in Summary.h); none where they
    /// speak for themselves.
    virtual std::vector<Figure> summary(const OperatingRange&, const double* parameters) const;

    virtual std::optional<LawInfo> law() const { return std::nullopt; }
    /// Difference that the effect adds at `argument` to the base parameter of its law.
    virtual double lawAt(const OperatingRange&, const double* parameters, double argument) const;

    /// Name of the base parameter whose value is OperatingRange::scale; of a law the one that it bends. Empty: none.
    virtual std::string sizedBy() const;

    virtual int memorySize(const OperatingRange&) const { return 0; }  ///< extra states
    /// The memory changes little within a period: what it holds was made by the whole take before. Its rate is to be
    /// affine in it.
    virtual bool slow() const { return false; }
    virtual bool relaxes() const { return false; }  ///< yields in the course of time
    virtual int coefficientCount(const OperatingRange&) const = 0;

    /// Turns parameters into coefficients: all that depends on the parameters alone, once a run.
    virtual void prepare(const OperatingRange&, const double* parameters, double* coefficients) const = 0;
    virtual void prepare(const OperatingRange&, const Jet* parameters, Jet* coefficients) const = 0;

    /// Adds to the balance; writes the time derivative of its memory. Called several times a sample:
    /// no allocation, no lock, no exception.
    virtual void contribute(const OperatingRange&, const double* coefficients, const Motion<double>&,
                            const double* memory, double* memoryRate, Balance<double>&) const = 0;
    virtual void contribute(const OperatingRange&, const Jet* coefficients, const Motion<Jet>&, const Jet* memory,
                            Jet* memoryRate, Balance<Jet>&) const = 0;
    virtual void contribute(const OperatingRange&, const Tangent* coefficients, const Motion<Tangent>&,
                            const Tangent* memory, Tangent* memoryRate, Balance<Tangent>&) const = 0;

    /// Whether it adds to the emission.
    virtual bool emits() const = 0;

    /// Adds to the emission; asked after contribute(), without whose memoryRate what a memory radiates is not known.
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
/// and, if it is heard or seen otherwise than through the cone's motion,
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
    // What is asked all the time is compiled for the processor at hand, with all that it calls; a virtual function
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
