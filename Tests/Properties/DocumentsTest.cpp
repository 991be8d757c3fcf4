// SPDX-License-Identifier: GPL-3.0-or-later
// What is written and read is the same, number by number and byte by byte, for models of every class and for takes.
#include "Engine/Document/JsonText.h"
#include "Engine/Document/TextFile.h"
#include "Engine/Fractional/FractionalStateSpaceFile.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/ModelFile.h"
#include "Engine/Polynomial/Block/BlockModelFile.h"
#include "Engine/Polynomial/FractionalPnlss/FractionalPnlssFile.h"
#include "Engine/Polynomial/Hammerstein/ParallelHammersteinFile.h"
#include "Engine/Polynomial/Narx/NarxFile.h"
#include "Engine/Polynomial/Pnlss/PnlssFile.h"
#include "Engine/Polynomial/Volterra/VolterraSeriesFile.h"
#include "Engine/Take/TakeFile.h"
#include "Engine/Take/Units.h"
#include "Properties/Property.h"
#include "Scratch.h"

#include <algorithm>

using namespace excursion;
using namespace excursion::test;
using Eigen::Index;

namespace {

double anyRate() { return *rc::gen::element(8000.0, 44100.0, 48000.0, 610.3515625, 1.0 / 3.0); }

StateSpace anyStateSpace(bool discrete, Index n, Index m, Index p)
{
    return {anyMatrix(n, n), anyMatrix(n, m), anyMatrix(p, n), anyMatrix(p, m), discrete ? anyRate() : 0.0};
}

std::vector<std::string> names(Index count)
{
    std::vector<std::string> list;
    for (Index k = 0; k < count; ++k)
        list.push_back(anyName());
    return list;
}

/// Monomials of degree 0 or 2 and above, and whatever coefficients.
Pnlss anyPnlss(const StateSpace& linear)
{
    Pnlss model;
    model.linear = linear;
    const auto K = between(0, 5);
    const auto n = linear.order(), m = linear.inputs(), p = linear.outputs();
    model.exponents = Exponents::Zero(K, n + m);
    for (auto row : model.exponents.rowwise()) {
        for (auto& exponent : row)
            exponent = between(0, 4);
        if (row.sum() == 1)
            row *= 2;
    }
    model.E = anyMatrix(n, K);
    model.F = anyMatrix(p, K);
    model.free.resize(n + p, K);
    for (auto& free : model.free.reshaped())
        free = *rc::gen::arbitrary<bool>();
    return model;
}

/// Writes, reads and writes again: the same bytes. Returns what was read.
template <class Document, class From>
Document again(const Document& document, From from)
{
    const Scratch scratch;
    writeJson(toJson(document), scratch / "1.json");
    Document back = readDocument(scratch / "1.json", from);
    writeJson(toJson(back), scratch / "2.json");
    RC_ASSERT(readText(scratch / "1.json") == readText(scratch / "2.json"));
    return back;
}

bool same(const StateSpace& a, const StateSpace& b)
{
    return a.A == b.A && a.B == b.B && a.C == b.C && a.D == b.D && a.sampleRate == b.sampleRate;
}

bool same(const Pnlss& a, const Pnlss& b)
{
    return same(a.linear, b.linear) && a.exponents == b.exponents && a.E == b.E && a.F == b.F
           && (a.free == b.free).all();
}

}  // namespace

TEST_CASE("A linear model written and read is the same")
{
    holds("state space", 60, [] {
        const auto n = between(0, 4), m = between(1, 3), p = between(1, 3);
        const NamedStateSpace named {anyName(), names(m), names(p), anyStateSpace(*rc::gen::arbitrary<bool>(), n, m, p),
                                     std::abs(within1())};
        const auto back = again(named, stateSpaceFromJson);
        RC_ASSERT(same(back.model, named.model));
        RC_ASSERT(back.name == named.name);
        RC_ASSERT(back.inputs == named.inputs);
        RC_ASSERT(back.outputs == named.outputs);
        RC_ASSERT(back.delay == named.delay);
    });
    holds("fractional state space", 40, [] {
        const NamedFractionalStateSpace named {
            anyName(), names(1), names(2), {1.0 + 0.999 * within1(), anyStateSpace(false, between(0, 3), 1, 2)}};
        const auto back = again(named, fractionalStateSpaceFromJson);
        RC_ASSERT(same(back.model.form, named.model.form));
        RC_ASSERT(back.model.alpha == named.model.alpha);
    });
}

TEST_CASE("A model with polynomials written and read is the same")
{
    holds("PNLSS", 60, [] {
        const auto m = between(1, 2), p = between(1, 2);
        const NamedPnlss named {anyName(), names(m), names(p), anyPnlss(anyStateSpace(true, between(1, 3), m, p))};
        const auto back = again(named, pnlssFromJson);
        RC_ASSERT(same(back.model, named.model));
    });
    holds("fractional PNLSS", 40, [] {
        const auto n = between(1, 3);
        NamedFractionalPnlss named {anyName(), names(1), names(1), {}, {}};
        named.model.alpha = 0.5 + 0.49 * within1();
        named.model.form = anyPnlss(anyStateSpace(false, n, 1, 1));
        named.model.fractional.resize(n);
        for (auto& fractional : named.model.fractional)
            fractional = *rc::gen::arbitrary<bool>();
        named.grid = {anyRate(), between(1, 16), {1.0 + std::abs(within1()), 3e3 + within1(), 4.0 + within1()}};
        const auto back = again(named, fractionalPnlssFromJson);
        RC_ASSERT(same(back.model.form, named.model.form));
        RC_ASSERT(back.model.alpha == named.model.alpha);
        RC_ASSERT((back.model.fractional == named.model.fractional).all());
        RC_ASSERT(back.grid.sampleRate == named.grid.sampleRate);
        RC_ASSERT(back.grid.substeps == named.grid.substeps);
        RC_ASSERT(back.grid.band.lowFrequency == named.grid.band.lowFrequency);
        RC_ASSERT(back.grid.band.highFrequency == named.grid.band.highFrequency);
        RC_ASSERT(back.grid.band.cellsPerDecade == named.grid.band.cellsPerDecade);
    });
    holds("parallel Hammerstein", 40, [] {
        const Named<ParallelHammerstein> named {
            anyName(), anyName(), anyName(), {anyRate(), anyMatrix(between(1, 6), between(1, 4)), *anyNumber()}};
        const auto back = again(named, parallelHammersteinFromJson);
        RC_ASSERT(back.model.filters == named.model.filters);
        RC_ASSERT(back.model.offset == named.model.offset);
        RC_ASSERT(back.model.sampleRate == named.model.sampleRate);
        RC_ASSERT(back.input == named.input);
        RC_ASSERT(back.output == named.output);
    });
    holds("NARX", 40, [] {
        Named<Narx> named {anyName(), anyName(), anyName(), {anyRate(), between(0, 3), between(0, 3), {}, {}}};
        const auto K = between(1, 5);
        named.model.exponents.resize(K, named.model.outputLags + named.model.inputLags + 1);
        for (auto& exponent : named.model.exponents.reshaped())
            exponent = between(0, 3);
        named.model.coefficients = anyMatrix(K, 1);
        const auto back = again(named, narxFromJson);
        RC_ASSERT(back.model.outputLags == named.model.outputLags);
        RC_ASSERT(back.model.inputLags == named.model.inputLags);
        RC_ASSERT(back.model.exponents == named.model.exponents);
        RC_ASSERT(back.model.coefficients == named.model.coefficients);
    });
    holds("block model", 40, [] {
        Named<BlockModel> named {anyName(), anyName(), anyName(), {}};
        named.model = {anyStateSpace(true, between(1, 3), 1, 1), anyMatrix(between(0, 3), 1),
                       anyMatrix(between(0, 3), 1), anyMatrix(between(0, 3), 1), *anyNumber()};
        const auto back = again(named, blockModelFromJson);
        RC_ASSERT(same(back.model.linear, named.model.linear));
        for (const auto branch : blockBranches())
            RC_ASSERT(back.model.of(branch) == named.model.of(branch));
        RC_ASSERT(back.model.offset == named.model.offset);
    });
    holds("Volterra series", 40, [] {
        Named<VolterraSeries> named {anyName(), anyName(), anyName(), {anyRate(), *anyNumber(), {}, {}, {}}};
        auto& model = named.model;
        model.first = anyMatrix(between(1, 4), 1);
        const auto T2 = between(0, 3), T3 = between(0, 2);
        const Eigen::MatrixXd half = anyMatrix(T2, T2);
        model.second = half.triangularView<Eigen::Upper>();
        model.second.triangularView<Eigen::StrictlyLower>() = model.second.transpose();
        model.third.assign(static_cast<std::size_t>(T3), Eigen::MatrixXd(T3, T3));
        const Eigen::MatrixXd kernel = anyMatrix(10, 1);
        for (int i = 0; i < T3; ++i)
            for (int j = 0; j < T3; ++j)
                for (int k = 0; k < T3; ++k)
                    model.third[static_cast<std::size_t>(i)](j, k) = kernel(i + j + k, 0);  // alike by symmetry
        const auto back = again(named, volterraSeriesFromJson);
        RC_ASSERT(back.model.first == model.first);
        RC_ASSERT(back.model.second == model.second);
        RC_ASSERT(back.model.third == model.third);
        RC_ASSERT(back.model.offset == model.offset);
    });
}

TEST_CASE("A driver with any effects written and read is the same")
{
    holds("driver", 60, [] {
        auto model = makeModel(*rc::gen::element<std::string>("electrodynamic", "mechanical"));
        model.name = anyName();
        OperatingRange operatingRange;
        operatingRange.displacement = 1e-3 * (1.5 + within1());
        operatingRange.degree = between(2, 8);
        operatingRange.lowFrequency = 10.0 + within1();
        for (const auto* effect : catalogue())
            if (*rc::gen::arbitrary<bool>() && (model.electrical() || !effect->electrical()))
                model = withEffect(model, *effect, operatingRange);
        for (auto* parameter : parametersOf(model)) {
            parameter->value = std::clamp(parameter->value * (1.0 + 0.3 * within1()) + 0.01 * std::abs(within1()),
                                          parameter->lower, parameter->upper);
            if (*rc::gen::arbitrary<bool>())
                parameter->standardError = std::abs(within1());
        }
        model.microphoneDistance = 1.5 + within1();
        const auto back = again(model, [](const JsonField& field) { return modelFromJson(field); });
        RC_ASSERT(back.name == model.name);
        RC_ASSERT(back.effectIds() == model.effectIds());
        RC_ASSERT(parameterVector(back) == parameterVector(model));
        RC_ASSERT(back.microphoneDistance == model.microphoneDistance);
    });
}

TEST_CASE("A take written and read is the same")
{
    holds("take", 25, [] {
        Measurement take;
        take.sampleRate = *rc::gen::element(8000.0, 44100.0, 48000.0);
        take.driver.name = anyName();
        if (*rc::gen::arbitrary<bool>())
            take.driver.coneArea = 0.02 + 0.01 * within1();
        if (*rc::gen::arbitrary<bool>())
            take.coupling = 1.5 + within1();
        const auto N = static_cast<std::size_t>(between(1, 50));
        for (const auto quantity : {Quantity::voltage, Quantity::current, Quantity::pressure}) {
            Channel channel {quantity, std::string(siUnit(quantity)), 1.0 + std::abs(within1()), {}};
            for (std::size_t t = 0; t < N; ++t)
                channel.samples.push_back(channel.fullScale * within1());
            take.channels.push_back(channel);
        }
        const Scratch scratch;
        writeMeasurement(take, scratch.folder());
        const auto back = readOwnTake(headerOf(scratch.folder())).take;
        RC_ASSERT(back.sampleRate == take.sampleRate);
        RC_ASSERT(back.driver.name == take.driver.name);
        RC_ASSERT(back.driver.coneArea == take.driver.coneArea);
        RC_ASSERT(back.coupling == take.coupling);
        RC_ASSERT(back.channels.size() == take.channels.size());
        for (std::size_t c = 0; c < take.channels.size(); ++c) {
            RC_ASSERT(back.channels[c].quantity == take.channels[c].quantity);
            RC_ASSERT(back.channels[c].fullScale == take.channels[c].fullScale);
            for (std::size_t t = 0; t < N; ++t)
                // once divided by the full scale and once multiplied
                RC_ASSERT(std::abs(back.channels[c].samples[t] - take.channels[c].samples[t])
                          <= 3e-16 * take.channels[c].fullScale);
        }
    });
}
