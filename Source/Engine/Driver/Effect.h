// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Driver/Number.h"
#include "Engine/Measurement/Measurement.h"

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace excursion {

/// The instant at which an effect is asked what it adds.
template <class T>
struct Motion {
    T i;   ///< coil current, A
    T x;   ///< coil displacement, m, positive outward
    T v;   ///< coil velocity, m/s
};

/// What the base and the effects add up to. With the flux phi(i, x) of the coil these close the two
/// equations of the driver (seed 2.1, 2.2, extended):
///     u            = drop + d(phi)/dt = drop + inductance di/dt + fluxSlope v
///     mass dv/dt   = force
template <class T>
struct Balance {
    T inductance {0.0};   ///< d(phi)/di, H
    T fluxSlope {0.0};    ///< d(phi)/dx, V s/m, without the force factor's own motion voltage
    T drop {0.0};         ///< voltage drops and motion voltage, V
    T force {0.0};        ///< N, positive outward
    T mass {0.0};         ///< kg
};

/// Where and how finely an effect is to hold: what the take really visited. It is part of a model, so a
/// model means the same wherever it is loaded.
struct Extent {
    double displacement = 1e-3;    ///< peak, m
    double velocity = 1.0;         ///< peak, m/s
    double current = 1.0;          ///< peak, A
    double lowFrequency = 10.0;    ///< Hz, lowest frequency of interest
    double highFrequency = 1.0e4;  ///< Hz, highest frequency of interest
    int degree = 6;                ///< of a law's expansion
    double scale = 1.0;            ///< the base parameter that the effect is sized by, in its unit: what is large for a law
    double duration = 10.0;        ///< s, of the take: what a slow memory had time for
};

struct Parameter {
    std::string name;
    std::string unit;
    double value = 0.0;
    double lower = -std::numeric_limits<double>::infinity();
    double upper = std::numeric_limits<double>::infinity();
    bool free = true;          ///< may a fit move it
    bool strength = false;     ///< an effect whose strengths are all zero is absent
    double prior = std::numeric_limits<double>::infinity();   ///< standard deviation about zero that is plausible beforehand
    double standardError = std::numeric_limits<double>::quiet_NaN();   ///< NaN: unknown or not identifiable
};

/// A law is a curve a person knows the effect by: Bl(x), K(x), Le(x), Rms(v). The effect adds a
/// difference, zero at rest, to a parameter of the base.
struct LawInfo {
    std::string name;       ///< "Bl(x)"
    std::string unit;       ///< "N/A"
    std::string argument;   ///< "x", "v" or "i"
    std::string argumentUnit;
    std::string base;       ///< name of the base parameter it adds to
};

/// One physical effect. A subclass is the whole of it: its words, its parameters, its memory, and what it
/// adds to the driver's two equations, written once through EffectOf for any number type.
class Effect {
public:
    virtual ~Effect() = default;

    virtual std::string id() const = 0;         ///< "force-factor"
    virtual std::string title() const = 0;      ///< "Force factor Bl(x)"
    virtual std::string physics() const = 0;    ///< one sentence
    virtual std::string symptoms() const = 0;   ///< what betrays it, in words a person can check on a plot
    virtual std::string remedy() const = 0;     ///< what a designer can do about it
    virtual bool electrical() const = 0;        ///< needs a coil; a mechanical-only driver has none
    virtual bool linear() const = 0;            ///< changes the frequency response, adds no distortion

    virtual std::vector<Parameter> parameters(const Extent&) const = 0;

    /// Shapes to try when nothing is known yet: parameter vectors with every strength at zero.
    virtual std::vector<std::vector<double>> starts(const Extent&) const;

    virtual std::optional<LawInfo> law() const { return std::nullopt; }
    /// Difference that the effect adds at `argument` to the base parameter of its law.
    virtual double lawAt(const Extent&, const double* parameters, double argument) const;

    /// Name of the base parameter whose value is Extent::scale; of a law the one that it bends. Empty: none.
    virtual std::string sizedBy() const;

    virtual int memorySize(const Extent&) const { return 0; }         ///< extra states
    /// The memory changes little within a period: what it holds was made by the whole take before. Its rate is to be affine in it.
    virtual bool slow() const { return false; }
    virtual int coefficientCount(const Extent&) const = 0;

    /// Turns parameters into coefficients: all that depends on the parameters alone, once a run.
    virtual void prepare(const Extent&, const double* parameters, double* coefficients) const = 0;
    virtual void prepare(const Extent&, const Jet* parameters, Jet* coefficients) const = 0;

    /// Adds to the balance; writes the time derivative of its memory. Called several times a sample:
    /// no allocation, no lock, no exception.
    virtual void contribute(const Extent&, const double* coefficients, const Motion<double>&, const double* memory,
                            double* memoryRate, Balance<double>&) const = 0;
    virtual void contribute(const Extent&, const Jet* coefficients, const Motion<Jet>&, const Jet* memory,
                            Jet* memoryRate, Balance<Jet>&) const = 0;
    virtual void contribute(const Extent&, const Tangent* coefficients, const Motion<Tangent>&, const Tangent* memory,
                            Tangent* memoryRate, Balance<Tangent>&) const = 0;
};

/// Lets a subclass write its physics once:
///     template <class T> void prepareFor(const Extent&, const T* parameters, T* coefficients) const;
///     template <class T> void addTo(const Extent&, const T* coefficients, const Motion<T>&, const T* memory,
///                                   T* memoryRate, Balance<T>&) const;
template <class Self>
class EffectOf : public Effect {
public:
    void prepare(const Extent& e, const double* p, double* c) const final { self().prepareFor(e, p, c); }
    void prepare(const Extent& e, const Jet* p, Jet* c) const final { self().prepareFor(e, p, c); }
    void contribute(const Extent& e, const double* c, const Motion<double>& motion, const double* memory, double* rate,
                    Balance<double>& balance) const final
    {
        self().addTo(e, c, motion, memory, rate, balance);
    }
    void contribute(const Extent& e, const Jet* c, const Motion<Jet>& motion, const Jet* memory, Jet* rate,
                    Balance<Jet>& balance) const final
    {
        self().addTo(e, c, motion, memory, rate, balance);
    }
    void contribute(const Extent& e, const Tangent* c, const Motion<Tangent>& motion, const Tangent* memory, Tangent* rate,
                    Balance<Tangent>& balance) const final
    {
        self().addTo(e, c, motion, memory, rate, balance);
    }

private:
    const Self& self() const { return static_cast<const Self&>(*this); }
};

} // namespace excursion
