// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Predistortion/LinearMemory.h"

#include "Engine/Numerics/Exponential.h"
#include "Engine/Numerics/Lanes.h"
#include "Engine/Predistortion/CubicDrive.h"
#include "Engine/Predistortion/Modes.h"

#include <algorithm>
#include <utility>

namespace excursion {
namespace {

/// What is laid out for four states: decay, turn, G and the three sums.
constexpr std::size_t quantitiesLaid = 2 + 12 + 3;

EXCURSION_DISPATCH void carry(std::size_t rows, const double* laid, const double* motion, double* value, double* sums)
{
    advanceLaid<12, 3>(rows, laid, motion, value, sums);
}

/// G of each state, 12 columns, for dm/dt = A m + b (i, x, v).
Eigen::MatrixXd weights(const LinearRates& rates, double sampleRate)
{
    Eigen::MatrixXd G(rates.A.rows(), 12);
    for (Eigen::Index q = 0; q < 3; ++q)
        G.middleCols(4 * q, 4) = byCoefficients(exponential(rates.A, rates.b.col(q), 1.0 / sampleRate, 4).phi);
    return G;
}

LinearMemory::Row rowOf(double decay, double turn, const Eigen::RowVectorXd& G)
{
    LinearMemory::Row row;
    row.decay = decay;
    row.turn = turn;
    std::copy_n(G.data(), 12, row.byMotion.begin());
    return row;
}

/// What Cubic::past makes of its end: both its highest coefficients take half of it.
double byEnd(const LinearMemory::Row& row) { return 0.5 * (row.byMotion[2] + row.byMotion[3]); }

}  // namespace

std::optional<LinearMemory::Block> LinearMemory::summed(const LinearRates& rates, const std::vector<double>& drop,
                                                        const std::vector<double>& force, double sampleRate)
{
    const auto modes = modesOf(rates.A);
    if (!modes.apart)
        return std::nullopt;
    const auto n = rates.A.rows();
    const Eigen::Map<const Eigen::RowVectorXd> D(drop.data(), n), F(force.data(), n);
    const Eigen::MatrixXd decay = modes.inverse
                                  * exponential(rates.A, Eigen::VectorXd::Zero(n), 1.0 / sampleRate, 1).decay
                                  * modes.basis;
    const Eigen::MatrixXd G = modes.inverse * weights(rates, sampleRate);
    const Eigen::RowVectorXd byDrop = D * modes.basis, byForce = F * modes.basis, byTime = F * rates.A * modes.basis;
    Block block;
    block.rates = rates;
    for (Eigen::Index k = 0; k < n; ++k) {
        const bool paired = k < 2 * modes.pairs;
        const auto other = k % 2 == 0 ? k + 1 : k - 1;
        auto row = rowOf(decay(k, k), paired ? 0.5 * (decay(k, other) - decay(other, k)) : 0.0, G.row(k));
        row.drop = byDrop[k];
        row.force = byForce[k];
        row.forceByTime = byTime[k];
        (paired ? block.pairs : block.singles).push_back(row);
    }
    const Eigen::RowVector3d direct = F * rates.b;
    block.forceByTime = {direct[0], direct[1], direct[2]};
    return block;
}

std::optional<LinearMemory::Block> LinearMemory::readable(const LinearRates& rates, double sampleRate)
{
    if (!rates.A.isDiagonal(0.0))
        return std::nullopt;
    const Eigen::MatrixXd decay =
                              exponential(rates.A, Eigen::VectorXd::Zero(rates.A.rows()), 1.0 / sampleRate, 1).decay,
                          G = weights(rates, sampleRate);
    Block block;
    block.rates = rates;
    for (Eigen::Index k = 0; k < rates.A.rows(); ++k)
        block.singles.push_back(rowOf(decay(k, k), 0.0, G.row(k)));
    return block;
}

LinearMemory::LinearMemory(std::vector<Block> blocks) : blocks_(std::move(blocks))
{
    std::vector<Row> rows;  // pairs first, so that none falls apart
    for (const auto& block : blocks_)
        rows.insert(rows.end(), block.pairs.begin(), block.pairs.end());
    for (const auto& block : blocks_) {
        places_.push_back(rows.size());
        rows.insert(rows.end(), block.singles.begin(), block.singles.end());
        for (std::size_t q = 0; q < 3; ++q)
            forceByTime_[q] += block.forceByTime[q];
    }
    rows.resize(roundedUpToLanes(rows.size()));
    std::vector<std::vector<double>> quantities(quantitiesLaid);
    for (const auto& row : rows) {
        quantities[0].push_back(row.decay);
        quantities[1].push_back(row.turn);
        for (std::size_t k = 0; k < 12; ++k)
            quantities[2 + k].push_back(row.byMotion[k]);
        quantities[14].push_back(row.drop);
        quantities[15].push_back(row.force);
        quantities[16].push_back(row.forceByTime);
        byCurrent_.push_back(byEnd(row));
        sumsByCurrent_.drop += row.drop * byEnd(row);
        sumsByCurrent_.force += row.force * byEnd(row);
    }
    laid_ = laidOut(quantities);
    value_.assign(rows.size(), 0.0);
    before_ = value_;
}

void LinearMemory::reset()
{
    std::fill(value_.begin(), value_.end(), 0.0);
    end_ = {};
}

LinearMemory::Sums LinearMemory::step(const MotionCubic& motion)
{
    std::array<double, 12> c;
    std::copy_n(motion.v.c.begin(), 4,
                std::copy_n(motion.x.c.begin(), 4, std::copy_n(motion.i.c.begin(), 4, c.begin())));
    end_ = {motion.i.end(), motion.x.end(), motion.v.end()};
    std::array<double, 3> sums {};
    before_ = value_;
    carry(value_.size(), laid_.data(), c.data(), value_.data(), sums.data());
    return {sums[0], sums[1],
            sums[2] + forceByTime_[0] * end_[0] + forceByTime_[1] * end_[1] + forceByTime_[2] * end_[2]};
}

void LinearMemory::approach(const LinearMemory& other, double share)
{
    for (std::size_t k = 0; k < value_.size(); ++k)
        value_[k] += share * (other.value_[k] - value_[k]);
}

void LinearMemory::correct(double current)
{
    for (std::size_t k = 0; k < value_.size(); ++k)
        value_[k] += byCurrent_[k] * current;
}

double LinearMemory::rate(std::size_t block, std::size_t k) const
{
    const auto& [A, b] = blocks_[block].rates;
    const auto row = static_cast<Eigen::Index>(k);
    return A(row, row) * value(block, k) + b(row, 0) * end_[0] + b(row, 1) * end_[1] + b(row, 2) * end_[2];
}

}  // namespace excursion
