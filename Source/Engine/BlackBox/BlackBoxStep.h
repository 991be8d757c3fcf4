// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/BlackBox/Region.h"
#include "Engine/Polynomial/MonomialProducts.h"

#include <cstddef>
#include <vector>

namespace excursion {

/// A matrix whose columns are padded to a multiple of four rows, for products without a remainder loop.
class PaddedMatrix {
public:
    PaddedMatrix() = default;
    explicit PaddedMatrix(const Eigen::MatrixXd&);

    std::size_t rows() const { return rows_; }  ///< with the padding
    std::size_t columns() const { return columns_; }

    const double* values() const { return values_.data(); }  ///< column by column

    /// out += M v. @param v  columns() numbers @param out  rows() numbers
    void add(const double* v, double* out) const;
    /// out = M v
    void set(const double* v, double* out) const;

private:
    std::size_t rows_ = 0, columns_ = 0;
    std::vector<double> values_;
};

/// sum a_k b_k
double innerProduct(const double* a, const double* b, std::size_t n);

/// One sample of a black box's equations, compiled for an audio thread: nothing here allocates after construction. The
/// combinations q are taken at the place within the region (see Region), so they are bounded for any input. All vectors
/// are padded: states() and so on give their lengths.
class BlackBoxStep {
public:
    BlackBoxStep(const BlackBox&, const Region&);

    std::size_t states() const { return dynamics_.rows(); }
    std::size_t seen() const { return zOfX_.rows(); }
    std::size_t combinations() const { return combine_.rows(); }

    /// z = S x + T u, seen() numbers
    void see(const double* x, double u, double* z) const;

    /// z += G q
    void addImplicit(const double* q, double* z) const
    {
        if (implicit_)
            zOfQ_.add(q, z);
    }

    /// q at z + G (q - before), with the q of the previous sample as a first guess. @param before may be null: zero
    /// @returns how far out the place is, relative to the region
    double combinationsAt(const double* z, double u, const double* before, double* q);

    /// C x + D u + F q of this sample; x becomes the state of the next.
    double advance(double* x, double u, const double* q);

private:
    double evaluate(const double* z, double u, double* q);

    std::size_t unpaddedStates_, unpaddedSeen_, unpaddedCombinations_;
    MonomialProducts products_;
    PaddedMatrix dynamics_, driven_, bent_;  // A, B, E
    std::vector<double> readX_, readQ_;      // C, F, padded
    double readU_;
    PaddedMatrix zOfX_, zOfU_, zOfQ_, combine_, whiten_;
    std::vector<double> centre_;
    bool implicit_, identity_;
    std::vector<double> nodes_, place_, next_, z_, difference_;
    std::vector<std::size_t> termNode_;
};

}  // namespace excursion
