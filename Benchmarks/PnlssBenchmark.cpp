// SPDX-License-Identifier: GPL-3.0-or-later
// One Levenberg-Marquardt iteration of a PNLSS model of order 3 and degree 3 (136 parameters, 16384 samples): the
// Jacobian and the factorization, beside the same recursion in NumPy where python3-numpy is at hand, and beside plain
// loops, one parameter after the other; and the kernel of the Jacobian beside what the core can do at most.
#include "Engine/Numerics/TallQr.h"
#include "Engine/Polynomial/Pnlss/Recursion.h"
#include "Engine/Polynomial/SensitivityKernels.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <iostream>
#include <string>

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define EXCURSION_WIDEST __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define EXCURSION_WIDEST
#endif

namespace {

using namespace excursion;
using Eigen::Index;
using Eigen::MatrixXd;

constexpr Index samples = 16384;

/// Of the processor, not of the clock: other programs may be at work.
double seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

template <class Work>
double best(Work work)
{
    double least = 1e9;
    for (int k = 0; k < 5; ++k) {
        const double before = seconds();
        work();
        least = std::min(least, seconds() - before);
    }
    return least;
}

Pnlss model()
{
    StateSpace linear;
    linear.sampleRate = 1.0;
    linear.A.resize(3, 3);
    linear.A << 0.8, 0.3, 0.0, -0.3, 0.8, 0.1, 0.0, 0.0, 0.5;
    linear.B = Eigen::Vector3d::Constant(0.3);
    linear.C = Eigen::RowVector3d::Ones();
    linear.D = MatrixXd::Ones(1, 1);
    auto result = withTerms(linear, 3);
    result.E.setConstant(0.003);
    result.F.setConstant(0.003);
    return result;
}

/// [B appendix C]'s way: every parameter runs through the record by itself.
double plainLoops(const Pnlss& m, const MatrixXd& u, const MatrixXd& states)
{
    const Index n = 3, K = m.terms();
    double sum = 0.0;
    for (Index row = 0; row < n; ++row)
        for (Index regressor = 0; regressor < 4 + K; ++regressor) {
            Eigen::Vector3d x = Eigen::Vector3d::Zero();
            for (Index t = 0; t < u.rows(); ++t) {
                const double z[4] = {states(0, t), states(1, t), states(2, t), u(t, 0)};
                Eigen::Matrix3d M = m.linear.A;
                Eigen::RowVector3d G = m.linear.C;
                double injected = regressor < 4 ? z[regressor] : 0.0;
                for (Index k = 0; k < K; ++k) {
                    double power[4], value = 1.0;
                    for (int v = 0; v < 4; ++v) {
                        power[v] = 1.0;
                        for (int e = 0; e < m.exponents(k, v); ++e)
                            power[v] *= z[v];
                        value *= power[v];
                    }
                    if (regressor == 4 + k)
                        injected = value;
                    for (int j = 0; j < 3; ++j) {
                        if (m.exponents(k, j) == 0)
                            continue;
                        double slope = m.exponents(k, j);
                        for (int v = 0; v < 4; ++v)
                            for (int e = 0; e < m.exponents(k, v) - (v == j); ++e)
                                slope *= z[v];
                        M.col(j) += m.E.col(k) * slope;
                        G[j] += m.F(0, k) * slope;
                    }
                }
                sum += G * x;
                x = (M * x).eval();
                x[row] += injected;
            }
        }
    return sum;
}

/// The recursion with all parameters of a step as one matrix, as a NumPy user would write it; seconds for 16384
/// samples, 0 without NumPy.
double numpySeconds()
{
    const std::string script = R"(
import itertools, time
import numpy as np
chosen = [c for d in (2, 3) for c in itertools.combinations_with_replacement(range(4), d)]
ex = np.array([[c.count(i) for i in range(4)] for c in chosen])
K = len(ex)
A = np.array([[.8,.3,0],[-.3,.8,.1],[0,0,.5]]); E = np.full((3, K), .003); C = np.ones(3); F = np.full(K, .003)
slope = [np.maximum(ex - np.eye(4, dtype=int)[j], 0) for j in range(3)]
rng = np.random.default_rng(1); N = 2048; z = rng.standard_normal((N, 4)) * .3
t0 = time.process_time()
X = np.zeros((3, 3 * (4 + K))); J = np.zeros((N, 4 * (4 + K)))
for t in range(N):
    r = np.concatenate([z[t], np.prod(z[t] ** ex, axis=1)])
    dp = np.stack([ex[:, j] * np.prod(z[t] ** slope[j], axis=1) for j in range(3)], axis=1)
    J[t, :X.shape[1]] = (C + F @ dp) @ X
    J[t, X.shape[1]:] = r
    X = (A + E @ dp) @ X + np.kron(np.eye(3), r)
jacobian = (time.process_time() - t0) * 16384 / N
t0 = time.process_time()
tall = np.tile(J, (8, 1)) + 1e-3 * rng.standard_normal((16384, J.shape[1]))
np.linalg.svd(tall, full_matrices=False)
print(jacobian, time.process_time() - t0)
)";
    const char* python = std::getenv("EXCURSION_PYTHON");
    const std::string command = std::string(python ? python : "python3") + " -c '" + script + "' 2>/dev/null";
    double jacobian = 0.0, step = 0.0;
    if (FILE* pipe = popen(command.c_str(), "r")) {
        if (std::fscanf(pipe, "%lf %lf", &jacobian, &step) != 2)
            jacobian = step = 0.0;
        pclose(pipe);
    }
    return jacobian + step;
}

/// What one core can do at most: multiplications and additions in ten chains that do not wait for each other, in
/// registers; in GFlop/s.
EXCURSION_WIDEST
double peak()
{
    using Eight = double __attribute__((vector_size(64)));
    constexpr long rounds = 2000000;
    double by = 0.999, plus = 1e-3;
    asm volatile("" : "+x"(by), "+x"(plus));  // not known when this is compiled, or nothing would be left of it
    Eight a {}, b = a + by, c = b + by, d = c + by, e = d + by, f = e + by, g = f + by, h = g + by, i = h + by,
                j = i + by;
    double least = 1e9;
    for (int k = 0; k < 5; ++k) {
        const double before = seconds();
        for (long round = 0; round < rounds; ++round) {
            a = a * by + plus, b = b * by + plus, c = c * by + plus, d = d * by + plus, e = e * by + plus;
            f = f * by + plus, g = g * by + plus, h = h * by + plus, i = i * by + plus, j = j * by + plus;
        }
        least = std::min(least, seconds() - before);
    }
    const Eight sum = a + b + c + d + e + f + g + h + i + j;
    double sink = sum[0];
    asm volatile("" : "+x"(sink));
    return 1e-9 * 10.0 * 8.0 * 2.0 * static_cast<double>(rounds) / least;
}

/// The kernel alone: three states, one output, eight parameters side by side through a stretch, in GFlop/s.
double kernel()
{
    using namespace kernels;
    constexpr int passes = 2000;
    const MatrixXd MG = 0.3 * MatrixXd::Random(pitch, 12), r = MatrixXd::Random(abreast, stretch);
    MatrixXd X = MatrixXd::Zero(abreast, 3), next = X, J(abreast, stretch);
    const Eigen::Vector3d g(1.0, 0.0, 0.0);
    const double taken = best([&] {
        for (int k = 0; k < passes; ++k)
            columnsThroughBlock(3, MG.data(), MG.data() + 9 * pitch, 1, r.data(), g.data(), 0, X.data(), next.data(),
                                J.data(), J.size(), stretch);
    });
    return 1e-9 * passes * static_cast<double>(stretch * abreast) * 2.0 * 12.0 / taken;
}

}  // namespace

int main()
{
    const auto m = model();
    std::srand(1);
    const MatrixXd u = MatrixXd::Random(samples, 1);
    const Recursion recursion(m, true);
    MatrixXd states, outputs;
    recursion.run(m, u, Eigen::Vector3d::Zero(), 1e6, states, outputs);
    const double simulation = best([&] { recursion.run(m, u, Eigen::Vector3d::Zero(), 1e6, states, outputs); });
    double sink = 0.0;
    const double jacobian = best(
        [&] { recursion.differentiate(m, u, states, [&](Index, std::vector<MatrixXd>& d) { sink += d[0](0, 0); }); });
    const auto P = recursion.parameters();
    const double iteration = best([&] {
        TallQr qr(P + 1);
        recursion.differentiate(m, u, states, [&](Index first, std::vector<MatrixXd>& d) {
            MatrixXd rows(d[0].rows(), P + 1);
            rows << d[0].leftCols(P), outputs.middleRows(first, rows.rows());
            qr.fold(rows);
        });
        sink += qr.R()(0, 0);
    });
    const double before = seconds();
    sink += plainLoops(m, u.topRows(samples / 16), states);
    const double plain = 16.0 * (seconds() - before);
    // 3 x 3 and 1 x 3 times 102 columns, a multiplication and an addition each
    const double operations = 2.0 * static_cast<double>(samples) * 102.0 * 12.0;
    const double alone = kernel(), most = peak();
    std::cout << "simulation   " << 1e3 * simulation << " ms\n"
              << "Jacobian     " << 1e3 * jacobian << " ms, " << 1e-9 * operations / jacobian
              << " GFlop/s of the recursion alone\n"
              << "kernel       " << alone << " GFlop/s, " << 100.0 * alone / most << " % of the " << most
              << " GFlop/s that this core can do\n"
              << "with factor  " << 1e3 * iteration << " ms\n"
              << "plain loops  " << 1e3 * plain << " ms for the Jacobian, " << plain / jacobian << " times as long\n";
    if (const double numpy = numpySeconds(); numpy > 0.0)
        std::cout << "NumPy        " << 1e3 * numpy << " ms for Jacobian and SVD, " << numpy / iteration
                  << " times as long\n";
    else
        std::cout << "NumPy        not at hand (EXCURSION_PYTHON names a Python that has it)\n";
    return sink == 12345.0;
}
