// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/Hammerstein/SweepModel.h"

#include "Engine/Error.h"
#include "Engine/Polynomial/Hammerstein/SweepBlocks.h"
#include "Engine/Polynomial/InputOutputRecord.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace excursion {

SweepModel sweepModel(const SweepTake& sweepTake, Quantity output, const HarmonicOptions& options)
{
    std::string reason;
    if (!options.isValid(&reason))
        throw Error(Error::Kind::usage, "A model of the sweeps cannot be made: " + reason + ".");
    const SweepBlocks blocks(sweepTake);
    const auto* channel = sweepTake.take.find(output);
    const auto& input = sweepTake.take.input();
    if (!channel || channel == &input)
        throw Error(Error::Kind::data,
                    "The take has no channel \"" + std::string(name(output)) + "\" beside its input.");
    auto cut = cutting(blocks, options.highest);
    cut.length = std::clamp<Eigen::Index>(cut.length, 128, 8192);
    const auto levels = blocks.plan.levels.size();
    const auto loudest = blocks.plan.sweep(blocks.rate(), levels - 1);
    const auto band = knownBand(loudest, cut);
    const auto timeOf = [&](double f) {
        return static_cast<Eigen::Index>(loudest.rate() * std::log(f / blocks.plan.bandLow) * blocks.rate());
    };
    const Eigen::Index from = timeOf(options.highest * band.low + 1.0 / sweepWindowEdge),
                       to = timeOf(band.high - 1.0 / sweepWindowEdge);
    if (to <= from)
        throw Error(Error::Kind::data, "The sweeps are too narrow, or too short, for a model of degree "
                                           + std::to_string(options.highest)
                                           + ": where all its branches are known there is no band left.");
    const auto judged = [&](const Eigen::MatrixXd& y) -> Eigen::MatrixXd {
        const Eigen::MatrixXd part = y.middleRows(from, to - from);
        return part.array() - part.mean();
    };
    const auto column = [&](const std::vector<double>& x) -> Eigen::MatrixXd {
        return Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
    };
    const auto errorAt = [&](const ParallelHammerstein& model, std::size_t level) {
        InputOutputRecord record;
        record.output = judged(column(blocks.mean(*channel, level)));
        return outputErrorDb({judged(simulate(model, column(blocks.mean(input, level))))}, {record});
    };
    SweepModel result;
    result.level = blocks.plan.levels.back();
    const auto answer = blocks.mean(*channel, levels - 1);
    double least = std::numeric_limits<double>::infinity();
    for (; cut.length >= 128; cut.length /= 2) {
        auto model = identifyHammerstein(loudest, answer, cut).model;
        const double error = errorAt(model, levels - 1);
        if (error < least) {
            least = error;
            result.model = std::move(model);
        }
    }
    for (std::size_t level = 0; level < levels; ++level)
        result.errorDb.push_back(errorAt(result.model, level));
    return result;
}

}  // namespace excursion
