// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/BlackBox/BlackBoxLinearizer.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace excursion {
namespace {

constexpr double slowPart = 0.05;  // of the stimulus' lowest frequency

}  // namespace

double* BlackBoxLinearizer::Window::next() { return values_.data() + at_ * each_; }

void BlackBoxLinearizer::Window::settle()
{
    // A second copy, a length further, keeps the latest samples in one row wherever the next one goes.
    const double* fresh = values_.data() + at_ * each_;
    std::copy(fresh, fresh + each_, values_.data() + (at_ + samples_) * each_);
    at_ = at_ + 1 == samples_ ? 0 : at_ + 1;
}

BlackBoxLinearizer::BlackBoxLinearizer(const BlackBox& box, const Region& region, const Rest& rest,
                                       const BlackBoxDesign& design)
    : step_(box, region),
      rest_(rest),
      preview_(static_cast<std::size_t>(design.preview)),
      width_(step_.combinations()),
      K_(step_.states(), 0.0),
      g_((preview_ + 1) * width_, 0.0),
      slowShare_(1.0 - std::exp(-2.0 * std::numbers::pi * slowPart * box.stimulus.lowest() / box.linear.sampleRate)),
      reference_(step_.states()),
      z_(step_.seen() + 1),
      q_(width_),
      slowFirst_(width_),
      slow_(width_),
      moved_(width_),
      past_(2 + step_.seen() + width_, static_cast<std::size_t>(design.passes) * preview_ + 1)
{
    for (Eigen::Index k = 0; k < design.control.K.size(); ++k)
        K_[static_cast<std::size_t>(k)] = design.control.K[k];
    for (std::size_t j = 0; j <= preview_; ++j)
        for (Eigen::Index i = 0; i < design.control.g.rows(); ++i)
            g_[j * width_ + static_cast<std::size_t>(i)] = design.control.g(i, static_cast<Eigen::Index>(j));
    for (int k = 0; k < design.passes; ++k)
        passes_.push_back(
            {std::vector<double>(step_.states()), std::vector<double>(width_), Window(width_, preview_ + 1)});
    reset();
}

void BlackBoxLinearizer::reset()
{
    const auto place = [](const Eigen::VectorXd& from, std::vector<double>& to) {
        std::fill(to.begin(), to.end(), 0.0);
        std::copy(from.begin(), from.end(), to.begin());
    };
    place(rest_.x, reference_);
    for (auto* q : {&q_, &slowFirst_, &slow_})
        place(rest_.q, *q);
    past_.clear();
    // The past was silence, at rest.
    std::vector<double>& z = z_;
    step_.see(reference_.data(), 0.0, z.data());
    step_.addImplicit(q_.data(), z.data());
    auto& scratch = passes_.front().e;  // an audio thread may call this
    std::copy(reference_.begin(), reference_.end(), scratch.begin());
    const double still = step_.advance(scratch.data(), 0.0, q_.data());
    for (std::size_t k = 0; k <= passes_.size() * preview_; ++k) {
        double* fresh = past_.next();
        fresh[0] = 0.0;
        std::copy(z.begin(), z.end() - 1, fresh + 1);
        std::copy(q_.begin(), q_.end(), fresh + 1 + step_.seen());
        fresh[1 + step_.seen() + width_] = still;
        past_.settle();
    }
    for (auto& pass : passes_) {
        std::fill(pass.e.begin(), pass.e.end(), 0.0);
        place(rest_.q, pass.q);
        pass.ahead.clear();
    }
}

BlackBoxLinearizer::Sample BlackBoxLinearizer::step(double u, double largest, double voltageLimit)
{
    const auto seen = step_.seen();
    // The linear part, and the nonlinearity along it.
    double* fresh = past_.next();
    double* const z = fresh + 1;
    fresh[0] = u;
    step_.see(reference_.data(), u, z);
    step_.addImplicit(slow_.data(), z);
    std::copy(slow_.begin(), slow_.end(), fresh + 1 + seen);
    step_.combinationsAt(z, u, slow_.data(), q_.data());
    double* ahead = passes_.front().ahead.next();
    for (std::size_t k = 0; k < width_; ++k)
        ahead[k] = q_[k] - slow_[k];
    passes_.front().ahead.settle();
    fresh[1 + seen + width_] = step_.advance(reference_.data(), u, slow_.data());
    for (std::size_t k = 0; k < width_; ++k) {
        slowFirst_[k] += slowShare_ * (q_[k] - slowFirst_[k]);
        slow_[k] += slowShare_ * (slowFirst_[k] - slow_[k]);
    }
    past_.settle();

    Sample sample;
    for (std::size_t p = 0; p < passes_.size(); ++p) {
        auto& pass = passes_[p];
        const bool last = p + 1 == passes_.size();
        const double* then = past_.past((p + 1) * preview_);
        const double* const slow = then + 1 + seen;
        double w = -innerProduct(K_.data(), pass.e.data(), K_.size())
                   - innerProduct(g_.data(), pass.ahead.oldest(), g_.size());
        const double wanted = then[0] + w;
        if (last) {
            w = std::clamp(w, -largest, largest);
            const double room = std::max(voltageLimit - std::abs(then[0]), 0.0);
            w = then[0] > 0.0 ? std::min(w, room) : std::max(w, -room);
            w = std::clamp(w, -voltageLimit - std::abs(then[0]), voltageLimit + std::abs(then[0]));
        }
        step_.see(pass.e.data(), w, z_.data());
        for (std::size_t k = 0; k < seen; ++k)
            z_[k] += then[1 + k];
        const double distance = step_.combinationsAt(z_.data(), then[0] + w, slow, pass.q.data());
        double* const difference = last ? moved_.data() : passes_[p + 1].ahead.next();
        for (std::size_t k = 0; k < width_; ++k)
            difference[k] = pass.q[k] - slow[k];
        const double y = step_.advance(pass.e.data(), w, difference);
        if (last)
            sample = {then[0], w, wanted, slow[width_] + y, y, distance};
        else
            passes_[p + 1].ahead.settle();
    }
    return sample;
}

}  // namespace excursion
