// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/BlackBox/BlackBoxStep.h"

#include "Engine/Numerics/Lanes.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

constexpr int implicitPasses = 4;

std::size_t padded(Eigen::Index n) { return roundedUpToLanes(static_cast<std::size_t>(n)); }

std::vector<double> paddedRow(const Eigen::MatrixXd& row, std::size_t length)
{
    std::vector<double> result(length, 0.0);
    for (Eigen::Index k = 0; k < row.cols(); ++k)
        result[static_cast<std::size_t>(k)] = row(0, k);
    return result;
}

// The matrices are small, so that calls would take as long as what they do: what is below is inlined into few functions
// that are compiled for several processors, one for each half of a step.

/// sum += four rows of M, from `m` on, times v(0), v(1), ...; with four sums that do not wait for one another.
template <class Vector>
[[gnu::always_inline]] inline void addRows(const double* m, std::size_t rows, std::size_t columns, const Vector& v,
                                           Four& sum)
{
    Four b {}, c {}, d {};
    std::size_t j = 0;
    for (; j + 4 <= columns; j += 4, m += 4 * rows) {
        sum += *reinterpret_cast<const Four*>(m) * v(j);
        b += *reinterpret_cast<const Four*>(m + rows) * v(j + 1);
        c += *reinterpret_cast<const Four*>(m + 2 * rows) * v(j + 2);
        d += *reinterpret_cast<const Four*>(m + 3 * rows) * v(j + 3);
    }
    for (; j < columns; ++j, m += rows)
        sum += *reinterpret_cast<const Four*>(m) * v(j);
    sum = (sum + b) + (c + d);
}

EXCURSION_DISPATCH
void addProduct(const double* M, std::size_t rows, std::size_t columns, const double* v, double* out)
{
    for (std::size_t r = 0; r < rows; r += lanes)
        addRows(
            M + r, rows, columns, [v](std::size_t j) { return v[j]; }, *reinterpret_cast<Four*>(out + r));
}

/// out = M v, v_j = from[index_j]
EXCURSION_DISPATCH
void combine(const double* M, std::size_t rows, std::size_t columns, const double* from, const std::size_t* index,
             double* out)
{
    for (std::size_t r = 0; r < rows; r += lanes) {
        Four sum {};
        addRows(
            M + r, rows, columns, [from, index](std::size_t j) { return from[index[j]]; }, sum);
        *reinterpret_cast<Four*>(out + r) = sum;
    }
}

/// |M v|^2
EXCURSION_DISPATCH
double squareOf(const double* M, std::size_t rows, std::size_t columns, const double* v)
{
    Four squares {};
    for (std::size_t r = 0; r < rows; r += lanes) {
        Four sum {};
        addRows(
            M + r, rows, columns, [v](std::size_t j) { return v[j]; }, sum);
        squares += sum * sum;
    }
    return (squares[0] + squares[1]) + (squares[2] + squares[3]);
}

/// next = A x + B u + E q @returns readX x + readQ q; readX and readQ are as long as A and E have rows and columns
struct Dynamics {
    const double *A, *B, *E, *readX, *readQ;
    std::size_t states, unpaddedStates, combinations, unpaddedCombinations;
};
EXCURSION_DISPATCH
double advanced(const Dynamics& by, const double* x, double u, const double* q, double* next)
{
    Four y {};
    for (std::size_t r = 0; r < by.states; r += lanes) {
        Four sum = *reinterpret_cast<const Four*>(by.B + r) * u;
        addRows(
            by.A + r, by.states, by.unpaddedStates, [x](std::size_t j) { return x[j]; }, sum);
        addRows(
            by.E + r, by.states, by.unpaddedCombinations, [q](std::size_t j) { return q[j]; }, sum);
        *reinterpret_cast<Four*>(next + r) = sum;
        y += *reinterpret_cast<const Four*>(by.readX + r) * *reinterpret_cast<const Four*>(x + r);
    }
    for (std::size_t r = 0; r < by.combinations; r += lanes)
        y += *reinterpret_cast<const Four*>(by.readQ + r) * *reinterpret_cast<const Four*>(q + r);
    return (y[0] + y[1]) + (y[2] + y[3]);
}

EXCURSION_DISPATCH
double dot(const double* a, const double* b, std::size_t n)
{
    Four s {}, t {};
    std::size_t k = 0;
    for (; k + 8 <= n; k += 8) {
        s += *reinterpret_cast<const Four*>(a + k) * *reinterpret_cast<const Four*>(b + k);
        t += *reinterpret_cast<const Four*>(a + k + 4) * *reinterpret_cast<const Four*>(b + k + 4);
    }
    s += t;
    double sum = (s[0] + s[1]) + (s[2] + s[3]);
    for (; k < n; ++k)
        sum += a[k] * b[k];
    return sum;
}

}  // namespace

double innerProduct(const double* a, const double* b, std::size_t n) { return dot(a, b, n); }

PaddedMatrix::PaddedMatrix(const Eigen::MatrixXd& M)
    : rows_(padded(M.rows())), columns_(static_cast<std::size_t>(M.cols())), values_(rows_ * columns_, 0.0)
{
    for (Eigen::Index j = 0; j < M.cols(); ++j)
        for (Eigen::Index i = 0; i < M.rows(); ++i)
            values_[static_cast<std::size_t>(j) * rows_ + static_cast<std::size_t>(i)] = M(i, j);
}

void PaddedMatrix::add(const double* v, double* out) const { addProduct(values_.data(), rows_, columns_, v, out); }

void PaddedMatrix::set(const double* v, double* out) const
{
    std::fill(out, out + rows_, 0.0);
    add(v, out);
}

BlackBoxStep::BlackBoxStep(const BlackBox& box, const Region& region)
    : unpaddedStates_(static_cast<std::size_t>(box.linear.order())),
      unpaddedSeen_(static_cast<std::size_t>(box.seen())),
      unpaddedCombinations_(static_cast<std::size_t>(box.combinations())),
      products_(box.exponents, box.seen() + 1, 0),
      dynamics_(box.linear.A),
      driven_(box.linear.B),
      bent_(box.E),
      readX_(paddedRow(box.linear.C, padded(box.linear.order()))),
      readQ_(paddedRow(box.F, padded(box.combinations()))),
      readU_(box.linear.D(0, 0)),
      zOfX_(box.S),
      zOfU_(box.T),
      zOfQ_(box.G),
      combine_(box.R),
      whiten_(region.W),
      centre_(region.centre.data(), region.centre.data() + region.centre.size()),
      implicit_(!box.G.isZero(0.0)),
      identity_(box.S.rows() == box.S.cols() && box.S.isIdentity(0.0) && box.T.isZero(0.0)),
      nodes_(static_cast<std::size_t>(products_.nodes())),
      place_(unpaddedSeen_ + 1),
      next_(dynamics_.rows()),
      z_(zOfX_.rows() + 1),
      difference_(combine_.rows())
{
    for (Eigen::Index k = 0; k < box.exponents.rows(); ++k)
        termNode_.push_back(static_cast<std::size_t>(products_.termNode(k)));
}

void BlackBoxStep::see(const double* x, double u, double* z) const
{
    if (identity_) {
        std::copy(x, x + zOfX_.rows(), z);
        return;
    }
    zOfX_.set(x, z);
    zOfU_.add(&u, z);
}

double BlackBoxStep::evaluate(const double* z, double u, double* q)
{
    for (std::size_t k = 0; k < unpaddedSeen_; ++k)
        place_[k] = z[k] - centre_[k];
    place_[unpaddedSeen_] = u - centre_[unpaddedSeen_];
    const double square = squareOf(whiten_.values(), whiten_.rows(), whiten_.columns(), place_.data());
    const double scale = square > 1.0 ? 1.0 / std::sqrt(square) : 1.0;
    for (std::size_t k = 0; k <= unpaddedSeen_; ++k)
        nodes_[1 + k] = centre_[k] + scale * place_[k];
    products_.evaluate(nodes_.data());
    combine(combine_.values(), combine_.rows(), combine_.columns(), nodes_.data(), termNode_.data(), q);
    return square;
}

double BlackBoxStep::combinationsAt(const double* z, double u, const double* before, double* q)
{
    double square = 0.0;
    if (!implicit_) {
        square = evaluate(z, u, q);
    } else {
        for (int pass = 0; pass < implicitPasses; ++pass) {
            std::copy(z, z + zOfX_.rows(), z_.begin());
            for (std::size_t k = 0; k < unpaddedCombinations_; ++k)
                difference_[k] = q[k] - (before ? before[k] : 0.0);
            zOfQ_.add(difference_.data(), z_.data());
            square = evaluate(z_.data(), u, q);
        }
    }
    return std::sqrt(square);
}

double BlackBoxStep::advance(double* x, double u, const double* q)
{
    const double y = advanced({dynamics_.values(), driven_.values(), bent_.values(), readX_.data(), readQ_.data(),
                               dynamics_.rows(), dynamics_.columns(), readQ_.size(), bent_.columns()},
                              x, u, q, next_.data());
    std::copy(next_.begin(), next_.end(), x);
    return y + readU_ * u;
}

}  // namespace excursion
