// SPDX-License-Identifier: GPL-3.0-or-later
// What one Levenberg-Marquardt iteration of a PNLSS model of order 20 and degree 3 costs as the record grows and as
// monomials are added, linear part held: processor time and peak memory, each run in a process of its own. Everything
// is told as a ratio to the first run of its row, with a line fitted through it. A file name as argument receives the
// table as CSV:
//     gnuplot -e "set datafile separator ','; plot 'scaling.csv' using 2:5 every ::1"
#include "Engine/Polynomial/Pnlss/PnlssFit.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <string>
#include <vector>

namespace {

using namespace excursion;
using Eigen::Index;

constexpr Index order = 20;

StateSpace resonances()
{
    StateSpace linear;
    linear.sampleRate = 8000.0;
    linear.A = Eigen::MatrixXd::Zero(order, order);
    linear.B = Eigen::MatrixXd::Zero(order, 1);
    linear.C = Eigen::MatrixXd::Ones(1, order);
    linear.D = Eigen::MatrixXd::Zero(1, 1);
    for (Index i = 0; i < order; i += 2) {
        const double angle = 0.05 * std::pow(1.3, static_cast<double>(i) / 2.0), radius = 0.95;
        linear.A.block(i, i, 2, 2) << radius * std::cos(angle), radius * std::sin(angle), -radius * std::sin(angle),
            radius * std::cos(angle);
        linear.B(i + 1, 0) = 0.1;
    }
    return linear;
}

struct Cost {
    double seconds = 0.0, megabytes = 0.0;
    Index parameters = 0;
};

/// One iteration in a child process, whose largest resident set is its own.
Cost costOf(Index samples, Index monomials)
{
    int pipes[2];
    if (pipe(pipes) != 0)
        std::exit(1);
    const auto child = fork();
    if (child == 0) {
        const auto sparse = withTerms(resonances(), 3, TermMask::noCrossProducts);
        auto truth = withTerms(resonances(), Exponents(sparse.exponents.topRows(monomials)));
        std::srand(1);
        const Eigen::MatrixXd u = Eigen::MatrixXd::Random(samples, 1);
        truth.E.setConstant(1e-3);
        const Eigen::MatrixXd y = simulate(truth, u);
        auto start = truth;
        start.E.setConstant(0.9e-3);
        PnlssFitOptions options;
        options.linearFree = false;
        options.search = PnlssSearch::plain;
        options.maximumIterations = 1;
        Cost cost;
        cost.seconds = 1e9;
        for (int k = 0; k < 2; ++k) {
            const auto before = std::clock();
            const auto fit = fitPnlss(start, {{u, y, 0, false}}, {}, options);
            cost.seconds = std::min(cost.seconds, static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC);
            if (!(fit.iterations == 1 && fit.history.size() == 2))
                _exit(1);  // it refused its step, so this was another work
        }
        cost.parameters = (order + 1) * monomials;
        _exit(write(pipes[1], &cost, sizeof cost) == sizeof cost ? 0 : 1);
    }
    close(pipes[1]);
    Cost cost;
    const bool told = read(pipes[0], &cost, sizeof cost) == sizeof cost;
    close(pipes[0]);
    int status = 0;
    rusage usage {};
    wait4(child, &status, 0, &usage);
    if (!told || status != 0) {
        std::fprintf(stderr, "An iteration with %td samples and %td monomials failed.\n", samples, monomials);
        std::exit(1);
    }
    cost.megabytes = static_cast<double>(usage.ru_maxrss) / 1024.0;
    return cost;
}

struct Line {
    double offset = 0.0, slope = 0.0, r2 = 0.0, exponent = 0.0;
};

/// y = offset + slope x by least squares, the share of the variance that it explains, and the slope of log y over log
/// x.
Line through(const std::vector<double>& x, const std::vector<double>& y)
{
    const auto n = static_cast<double>(x.size());
    const auto fitted = [n](const std::vector<double>& a, const std::vector<double>& b) {
        double ma = 0.0, mb = 0.0, aa = 0.0, ab = 0.0, bb = 0.0;
        for (std::size_t k = 0; k < a.size(); ++k) {
            ma += a[k] / n;
            mb += b[k] / n;
        }
        for (std::size_t k = 0; k < a.size(); ++k) {
            aa += (a[k] - ma) * (a[k] - ma);
            ab += (a[k] - ma) * (b[k] - mb);
            bb += (b[k] - mb) * (b[k] - mb);
        }
        return Line {mb - ab / aa * ma, ab / aa, ab * ab / (aa * bb), 0.0};
    };
    auto line = fitted(x, y);
    std::vector<double> lx, ly;
    for (std::size_t k = 0; k < x.size(); ++k) {
        lx.push_back(std::log(x[k]));
        ly.push_back(std::log(y[k]));
    }
    line.exponent = fitted(lx, ly).slope;
    return line;
}

void study(const char* name, const std::vector<std::pair<Index, Index>>& runs, bool bySamples, std::ofstream& csv)
{
    std::printf("\n%s\n%10s %10s %10s %10s %8s %10s %8s\n", name, "samples", "monomials", "parameters", "seconds",
                "ratio", "MB", "ratio");
    std::vector<double> x, time, memory;
    for (const auto& [samples, monomials] : runs) {
        const auto cost = costOf(samples, monomials);
        x.push_back(static_cast<double>(bySamples ? samples : monomials)
                    / static_cast<double>(bySamples ? runs[0].first : runs[0].second));
        time.push_back(cost.seconds);
        memory.push_back(cost.megabytes);
        std::printf("%10td %10td %10td %10.3f %8.2f %10.1f %8.2f\n", samples, monomials, cost.parameters, cost.seconds,
                    cost.seconds / time[0], cost.megabytes, cost.megabytes / memory[0]);
        std::fflush(stdout);
        if (csv)
            csv << (bySamples ? "samples" : "monomials") << ',' << samples << ',' << monomials << ',' << cost.parameters
                << ',' << cost.seconds << ',' << cost.megabytes << '\n';
    }
    for (const auto& [what, values] : {std::pair {"time", &time}, std::pair {"memory", &memory}}) {
        const auto line = through(x, *values);
        std::printf("%-6s  a line explains %.2f %% of its variance, offset %.0f %% of the first run; it grows as the "
                    "power %.2f\n",
                    what, 100.0 * line.r2, 100.0 * line.offset / (*values)[0], line.exponent);
    }
}

}  // namespace

int main(int argc, char** argv)
{
    std::ofstream csv;
    if (argc > 1) {
        csv.open(argv[1]);
        csv << "row,samples,monomials,parameters,seconds,megabytes\n";
    }
    study("against samples", {{4096, 12}, {8192, 12}, {16384, 12}, {32768, 12}, {65536, 12}}, true, csv);
    study("against active monomials",
          {{8192, 6}, {8192, 12}, {8192, 18}, {8192, 24}, {8192, 30}, {8192, 36}, {8192, 42}}, false, csv);
    if (argc > 1 && !csv.good()) {
        std::fprintf(stderr, "%s could not be written.\n", argv[1]);
        return 1;
    }
    return 0;
}
