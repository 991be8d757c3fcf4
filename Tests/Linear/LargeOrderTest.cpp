// SPDX-License-Identifier: GPL-3.0-or-later
// Modal systems of large order, drawn at random: the noise is met without being told how large it is.
#include "Engine/Linear/Identify.h"
#include "Engine/Linear/ResidualWhiteness.h"
#include "Engine/Linear/Response.h"
#include "Linear/Problem.h"

#include <numbers>

using namespace excursion;
using namespace excursion::test;
using Complex = std::complex<double>;

namespace {

/// `modes` resonances from 300 Hz up with damping ratios of 0.5 to 4 %, and a real pole.
PartialFractionFit drawnModes(int modes, Normal& normal)
{
    std::vector<Complex> roots {{-2.0 * std::numbers::pi * 2000.0, 0.0}};
    for (int i = 0; i < modes; ++i) {
        const double w = 2.0 * std::numbers::pi * 300.0 * std::pow(60.0, (i + 0.2 * std::tanh(normal())) / modes);
        const double damping = 0.005 * std::pow(8.0, 0.5 + 0.5 * std::tanh(normal()));
        roots.emplace_back(-damping * w, w);
        roots.emplace_back(-damping * w, -w);
    }
    PartialFractionFit fit;
    fit.sections = sectionsOf(roots, 0.0, 2.0 * std::numbers::pi * 20000.0);
    fit.C.resize(1, fit.sections.order());
    for (Eigen::Index i = 0; i < fit.sections.order(); ++i) {
        const double damped = i + 1 < fit.sections.order() ? fit.sections.factors[i - i % 2] : 1.0;
        fit.C(0, i) = normal() * damped;
    }
    fit.D = Eigen::VectorXd::Constant(1, 0.3);
    return fit;
}

/// Its response on `lines` lines up to 20 kHz, with noise of `noise` times its rms value and no word of it.
struct Drawn {
    FrequencyData measured, truth;
};

Drawn drawnResponse(const PartialFractionFit& fit, int lines, double noise, Normal& normal)
{
    Drawn drawn;
    auto& data = drawn.truth;
    for (int k = 1; k <= lines; ++k)
        data.frequency.push_back(20000.0 * k / lines);
    const auto model = realize(fit.sections, fit.C, fit.D);
    const auto frf = frfOf(model, data.frequency);
    data = frequencyDataOf(frf);
    drawn.measured = data;
    const double size = noise * data.value.norm() / std::sqrt(static_cast<double>(lines));
    for (auto& value : drawn.measured.value.reshaped())
        value += size * std::numbers::sqrt2 * 0.5 * Complex(normal(), normal());
    return drawn;
}

}  // namespace

TEST_CASE("White noise around a model is taken for noise, a resonance of a third of its power is not")
{
    Normal normal(11);
    int white = 0, seen = 0;
    for (int draw = 0; draw < 200; ++draw) {
        const auto truth = drawnModes(1, normal);  // too low to take up what comes at 6 to 12 kHz
        const auto drawn = drawnResponse(truth, 400, 1e-2, normal);
        white += leavesWhiteNoise(fitPartialFractions(truth.sections, drawn.measured), drawn.measured);
        // a resonance that nothing in the fit has: 4 % wide, at a frequency drawn
        auto other = drawn.measured;
        Eigen::VectorXcd bump(400);
        const double at = 9000.0 + 3000.0 * std::tanh(normal());
        for (Eigen::Index k = 0; k < 400; ++k) {
            const double f = other.frequency[static_cast<std::size_t>(k)];
            bump[k] = 1.0 / Complex(at * at - f * f, 0.04 * at * f);
        }
        const double noise = (drawn.measured.value - drawn.truth.value).norm();
        other.value += std::sqrt(0.3) * noise / bump.norm() * bump;
        seen += !leavesWhiteNoise(fitPartialFractions(truth.sections, other), other);
    }
    CHECK(white >= 197);
    CHECK(seen >= 190);
    // Four lines a pole are too few to say.
    const auto truth = drawnModes(20, normal);
    const auto drawn = drawnResponse(truth, 150, 1e-3, normal);
    CHECK_FALSE(leavesWhiteNoise(fitPartialFractions(truth.sections, drawn.measured), drawn.measured));
}

TEST_CASE("Modal systems of large order are met at a noise that nobody knows, stable")
{
    for (const int modes : {10, 13, 17, 20}) {
        Normal normal(static_cast<std::uint64_t>(modes));
        const auto truth = drawnModes(modes, normal);
        const auto drawn = drawnResponse(truth, 1000, 1e-3, normal);
        IdentifyOptions options;
        options.order = 2 * modes + 1;
        const auto found = identify(drawn.measured, options);
        INFO("order " << options.order << " from " << found.start);
        CHECK(found.stable);
        // The best model of the true order fits no worse than the truth, refitted over the true poles, and is nearer to
        // the truth than the measurement is.
        CHECK(found.cost <= fitPartialFractions(truth.sections, drawn.measured).cost * (1.0 + 1e-9));
        CHECK(judged(found.model, drawn.truth).cost < 0.1 * found.cost);
    }
}
