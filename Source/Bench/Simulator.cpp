// SPDX-License-Identifier: GPL-3.0-or-later
#include "Bench/Simulator.h"

#include "Engine/Error.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace excursion::bench {
namespace {

Triple times(const Square& M, const Triple& r)
{
    Triple out {};
    for (int j = 0; j < 3; ++j)
        out[j] = M[j][0] * r[0] + M[j][1] * r[1] + M[j][2] * r[2];
    return out;
}

// integral_0^i of shape(c) c dc, by Gauss-Legendre: the co-energy's dependence on current.
double coEnergyIntegral(const Law& saturation, double i)
{
    if (!saturation.present())
        return 0.5 * i * i;
    static constexpr double node[] {0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363};
    static constexpr double weight[] {0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763};
    double sum = 0.0;
    for (int n = 0; n < 4; ++n)
        for (const double side : {-1.0, 1.0}) {
            const double c = 0.5 * i * (1.0 + side * node[n]);
            sum += weight[n] * saturation(c).value * c;
        }
    return 0.5 * i * sum;
}

}  // namespace

Simulator::Simulator(const Loudspeaker& speaker, double step, double highest, double lowest)
    : speaker_(speaker),
      forceFactor_(speaker.forceFactor, speaker.Bl),
      stiffness_(speaker.stiffness, speaker.K),
      inductance_(speaker.inductancePosition, speaker.Le),
      saturation_(speaker.inductanceCurrent, 1.0),
      damping_(speaker.dampingVelocity, speaker.Rms),
      h_(step),
      resistance_(speaker.Re)
{
    if (const auto& eddy = speaker.eddyCurrents; eddy && !eddy->cells.empty()) {  // R s/(s + p) = s * R/(s + p)
        Relaxations cells;
        for (const auto& cell : eddy->cells) {
            cells.rate.push_back(cell.rate);
            cells.weight.push_back(cell.resistance);
        }
        eddy_ = RelaxationBank(cells, step);
    } else if (eddy) {  // K s^a = s * K s^(a - 1): K s^(a - 1) i is a flux
        auto cells = fractionalIntegral(1.0 - eddy->exponent, lowest, highest);
        for (auto& weight : cells.weight)
            weight *= eddy->coefficient;
        eddy_ = RelaxationBank(cells, step);
    }
    loopsMove_ = speaker.eddyCurrents && speaker.eddyCurrents->moves && inductance_.present();
    if (const auto& creep = speaker.creep) {
        switch (creep->family) {
        case Creep::Family::logarithmic:
            creep_ = RelaxationBank(logarithm(creep->low, creep->high), step);
            creepScale_ = creep->amount / speaker.K;
            break;
        case Creep::Family::standard:
            creep_ = RelaxationBank({{creep->low}, {creep->low}}, step);
            creepScale_ = creep->amount / speaker.K;
            break;
        case Creep::Family::fractional:  // (s/low)^b x = low^(-b) s^(b - 1) v
            creep_ = RelaxationBank(fractionalIntegral(1.0 - creep->exponent, lowest, highest), step);
            creepScale_ = speaker.K * creep->amount * std::pow(creep->low, -creep->exponent);
            break;
        case Creep::Family::chain: {
            Relaxations cells;
            for (const auto& cell : creep->cells) {
                cells.rate.push_back(cell.rate);
                cells.weight.push_back(cell.yield * cell.rate);
            }
            creep_ = RelaxationBank(cells, step);
            creepScale_ = 1.0 / speaker.K;
            break;
        }
        }
    }
    if (speaker.friction) {
        frictionState_.assign(speaker.friction->elements.size(), 0.0);
        friction_.resize(frictionState_.size());
    }
    for (const auto& mode : speaker.coneBreakup) {
        // r''/x'' = -s^2/((s - p)(s - p*)) = -1 + 2 Re part of residues: out/(s - p) + conjugate
        const double w = 2.0 * std::numbers::pi * mode.frequency;
        const std::complex<double> p {-0.5 * w / mode.quality,
                                      w * std::sqrt(1.0 - 0.25 / (mode.quality * mode.quality))};
        Mode cell;
        cell.out = -mode.gain * p * p / (p - std::conj(p));
        cell.direct = -mode.gain;
        cell.decay = std::exp(p * step);
        const auto parabola = decayedParabola(-p * step);
        for (int l = 0; l < 3; ++l)
            cell.take[l] = step * parabola[2][l];
        modes_.push_back(cell);
    }
    if (speaker.oddity)
        oddity_.emplace(*speaker.oddity, step);
    for (const auto& part : speaker.sideResonance) {
        parts_.emplace_back();
        parts_.back().part = part;
    }
}

void Simulator::predict()
{
    const auto extrapolate = [](Triple& now, Triple& before) {
        Triple next {};
        for (int j = 0; j < 3; ++j) {
            const auto& w = Radau::extrapolation()[j];
            for (int n = 0; n < 3; ++n)
                next[j] += w[n] * before[n] + w[n + 3] * now[n];
        }
        before = now;
        now = next;
    };
    extrapolate(i_, iBefore_);
    extrapolate(a_, aBefore_);
    if (speaker_.ventedBox) {
        extrapolate(port_, portBefore_);
        extrapolate(leak_, leakBefore_);
    }
    for (auto& part : parts_)
        extrapolate(part.acceleration, part.before);
}

void Simulator::coupleLoops()
{
    for (int j = 0; loopsMove_ && j < 3; ++j) {  // k = (Le(x)/Le(0))^1/2
        const auto [L, slope] = inductance_(x_[j]);
        coupling_[j] = std::sqrt(L / speaker_.Le);
        couplingSlope_[j] = 0.5 * slope / (speaker_.Le * coupling_[j]);
    }
}

Triple Simulator::coupledCurrent() const { return {coupling_[0] * i_[0], coupling_[1] * i_[1], coupling_[2] * i_[2]}; }

void Simulator::solveCurrents(const Triple& voltage)
{
    const auto& A = Radau::once();
    Triple back {}, flux {}, slope {};
    for (int j = 0; j < 3; ++j) {
        bl_[j] = forceFactor_(x_[j]).value;
        back[j] = voltage[j] - resistance_ * i_[j] - bl_[j] * v_[j];
        const double L = inductance_(x_[j]).value;
        const auto saturated = saturation_(i_[j]);
        flux[j] = L * saturated.value * i_[j];
        slope[j] = L * (saturated.value + saturated.slope * i_[j]);
    }
    const auto drive = times(A, back);
    const auto eddy = speaker_.eddyCurrents ? times(eddy_.gain(), coupledCurrent()) : Triple {};
    Square jacobian {};
    Triple residual {};
    for (int j = 0; j < 3; ++j) {
        residual[j] = flux_ + h_ * drive[j] - flux[j] - coupling_[j] * (eddyHistory_[j] + eddy[j]);
        for (int l = 0; l < 3; ++l)
            jacobian[j][l] = h_ * resistance_ * A[j][l] + coupling_[j] * eddy_.gain()[j][l] * coupling_[l]
                             + (j == l ? slope[j] : 0.0);
    }
    const auto change = solve(jacobian, residual);
    for (int j = 0; j < 3; ++j)
        i_[j] += change[j];
}

void Simulator::frictionForces()
{
    frictionSum_ = {};
    for (std::size_t n = 0; n < friction_.size(); ++n) {
        // Linear in F for given velocities: (1 + h A D) F = F0 + h A (stiffness v), D = stiffness |v| / limit
        const auto& element = speaker_.friction->elements[n];
        const auto& A = Radau::once();
        const auto pull = times(A, v_);
        Square M {};
        Triple right {};
        for (int j = 0; j < 3; ++j) {
            right[j] = frictionState_[n] + h_ * element.stiffness * pull[j];
            for (int l = 0; l < 3; ++l)
                M[j][l] = (j == l ? 1.0 : 0.0) + h_ * A[j][l] * element.stiffness * std::abs(v_[l]) / element.limit;
        }
        friction_[n] = solve(M, right);
        for (int j = 0; j < 3; ++j)
            frictionSum_[j] += friction_[n][j];
    }
}

void Simulator::suspensionForces()
{
    if (!speaker_.creep) {
        for (int j = 0; j < 3; ++j)
            suspension_[j] = stiffness_(x_[j]).value * x_[j];
    } else if (speaker_.creep->family == Creep::Family::fractional) {
        const auto drag = times(creep_.gain(), v_);
        for (int j = 0; j < 3; ++j)
            suspension_[j] = stiffness_(x_[j]).value * x_[j] + creepScale_ * (creepHistory_[j] + drag[j]);
    } else {  // the creep cells lie in series with the spring and carry its force
        const auto give = times(creep_.gain(), suspension_);
        for (int j = 0; j < 3; ++j) {
            const double stretched = x_[j] - creepScale_ * (creepHistory_[j] + give[j]);
            suspension_[j] = stiffness_(stretched).value * stretched;
        }
    }
}

Triple Simulator::accelerations()
{
    Triple a {};
    const auto eddy = loopsMove_ ? times(eddy_.gain(), coupledCurrent()) : Triple {};
    for (int j = 0; j < 3; ++j) {
        double force = bl_[j] * i_[j] - damping_(v_[j]).value * v_[j] - suspension_[j] - frictionSum_[j];
        if (inductance_.present())
            force += inductance_(x_[j]).slope * coEnergyIntegral(saturation_, i_[j]);
        force += box_[j] + odd_[j] + couplingSlope_[j] * i_[j] * (eddyHistory_[j] + eddy[j]);
        for (const auto& part : parts_)
            force -= part.part.mass * part.acceleration[j];
        a[j] = force / speaker_.m;
    }
    return a;
}

const Simulator::Sample& Simulator::step(const Triple& voltage)
{
    const auto &A = Radau::once(), &B = Radau::twice();
    predict();
    if (speaker_.eddyCurrents)
        eddyHistory_ = eddy_.history();
    if (speaker_.creep)
        creepHistory_ = creep_.history();

    for (int iteration = 0;; ++iteration) {
        const auto speed = times(A, a_), way = times(B, a_);
        for (int j = 0; j < 3; ++j) {
            v_[j] = sample_.velocity + h_ * speed[j];
            x_[j] = sample_.displacement + h_ * (Radau::points()[j] * sample_.velocity + h_ * way[j]);
        }
        if (const auto& box = speaker_.ventedBox) {
            const auto portSpeed = times(A, port_), portWay = times(B, port_), leaked = times(A, leak_);
            for (int j = 0; j < 3; ++j) {
                const double speed = portVelocity_ + h_ * portSpeed[j];
                const double way = portPosition_ + h_ * (Radau::points()[j] * portVelocity_ + h_ * portWay[j]);
                box_[j] = -box->pull(x_[j] + way + leaked_ + h_ * leaked[j])
                          - box->absorption * (v_[j] + speed + leak_[j]);
                port_[j] = (box_[j] - box->drag(speed) - box->spring * way) / box->mass;
                leak_[j] = box_[j] / box->leak;
            }
        }
        for (auto& part : parts_) {
            const auto speed = times(A, part.acceleration), way = times(B, part.acceleration);
            const double w = 2.0 * std::numbers::pi * part.part.frequency;
            for (int j = 0; j < 3; ++j) {
                const double velocity = part.velocity + h_ * speed[j];
                const double position = part.position + h_ * (Radau::points()[j] * part.velocity + h_ * way[j]);
                part.acceleration[j] = w / part.part.quality * (v_[j] - velocity) + w * w * (x_[j] - position);
            }
        }
        const auto iOld = i_;
        coupleLoops();
        solveCurrents(voltage);
        frictionForces();
        suspensionForces();
        if (oddity_)
            odd_ = oddity_->force(x_, v_);
        const auto a = accelerations();

        double iMoved = 0.0, aMoved = 0.0;
        bool finite = true;  // the largest of numbers does not tell
        for (int j = 0; j < 3; ++j) {
            finite = finite && std::isfinite(i_[j]) && std::isfinite(a[j]);
            iMoved = std::max(iMoved, std::abs(i_[j] - iOld[j]));
            aMoved = std::max(aMoved, std::abs(a[j] - a_[j]));
            iLargest_ = std::max(iLargest_, std::abs(i_[j]));
            aLargest_ = std::max(aLargest_, std::abs(a[j]));
        }
        a_ = a;
        if (finite && iMoved <= 1e-11 * iLargest_ && aMoved <= 1e-11 * aLargest_)
            break;
        if (iteration == 60 || !finite)
            throw Error(Error::Kind::numerical, "The virtual loudspeaker left the range in which its equations can be "
                                                "solved; drive it with less voltage.");
    }
    finish(voltage);
    return sample_;
}

void Simulator::finish(const Triple& voltage)
{
    const auto &A = Radau::once(), &B = Radau::twice();
    double emf = 0.0, heat = 0.0;
    for (int l = 0; l < 3; ++l) {
        emf += A[2][l] * (voltage[l] - resistance_ * i_[l] - bl_[l] * v_[l]);
        heat += A[2][l] * resistance_ * i_[l] * i_[l];
    }
    flux_ += h_ * emf;
    if (speaker_.eddyCurrents)
        eddy_.advance(coupledCurrent());
    if (speaker_.creep)
        creep_.advance(speaker_.creep->family == Creep::Family::fractional ? v_ : suspension_);
    for (std::size_t n = 0; n < friction_.size(); ++n)
        frictionState_[n] = friction_[n][2];
    if (oddity_)
        oddity_->finish();
    sample_.radiated = a_[2];
    if (speaker_.ventedBox) {
        portPosition_ += h_ * (portVelocity_ + h_ * times(B, port_)[2]);
        portVelocity_ += h_ * times(A, port_)[2];
        leaked_ += h_ * times(A, leak_)[2];
        sample_.radiated += port_[2];
    }
    for (auto& part : parts_) {
        part.position += h_ * (part.velocity + h_ * times(B, part.acceleration)[2]);
        part.velocity += h_ * times(A, part.acceleration)[2];
    }
    for (auto& mode : modes_) {
        mode.state = mode.decay * mode.state + mode.take[0] * a_[0] + mode.take[1] * a_[1] + mode.take[2] * a_[2];
        sample_.radiated += mode.direct * a_[2] + 2.0 * (mode.out * mode.state).real();
    }
    if (const auto& heating = speaker_.coilHeating) {  // slow against the step: Euler
        const double toMagnet = (coilTemperature_ - magnetTemperature_) / heating->coilResistance;
        coilTemperature_ += h_ * (heat - toMagnet) / heating->coilCapacity;
        magnetTemperature_ += h_ * (toMagnet - magnetTemperature_ / heating->magnetResistance)
                              / heating->magnetCapacity;
        resistance_ = speaker_.Re * (1.0 + heating->alpha * coilTemperature_);
    }
    sample_.current = i_[2];
    sample_.displacement = x_[2];
    sample_.velocity = v_[2];
    sample_.acceleration = a_[2];
}

}  // namespace excursion::bench
