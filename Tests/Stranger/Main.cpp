// SPDX-License-Identifier: GPL-3.0-or-later
// simulate SETUP OUT: integrates a driver through all blocks of the setup by the classic Runge-Kutta method
// and writes what ideal sensors read: doubles, 7 per sample (u, i, x, v, a, laser, p).
#include "Decimate.h"
#include "Driver.h"
#include <cmath>
#include <cstdio>
#include <stdexcept>

using namespace sim;

namespace {

struct Fine {  // everything on the fine grid, channel by channel
    std::vector<double> u, i, x, v, a, laser, cone, port;
};

void integrate(const Setup& setup, double rate, int oversample, int substeps, Fine& fine)
{
    Driver driver(setup);
    const std::size_t n = driver.states();
    std::vector<double> y(n), k1(n), k2(n), k3(n), k4(n), z(n);
    const double h = 1 / (rate * oversample * substeps);
    double start = 0;
    for (const auto& block : setup.blocks) {
        auto input = readDoubles(block.file);  // two values for each step
        for (double& value : input)
            value *= block.gain;
        driver.stiffnessScale = block.stiffnessScale;
        driver.resistanceScale = block.resistanceScale;
        const std::size_t steps = input.size() / 2, all = steps * std::size_t(block.repeats);
        for (std::size_t step = 0; step < all; ++step) {
            const std::size_t at = 2 * (step % steps);
            const double u0 = input[at], u1 = input[at + 1], u2 = input[(at + 2) % input.size()];
            const double t = start + double(step) * h;
            Driver::Reading r;
            const bool wanted = step % std::size_t(substeps) == 0;
            driver.derivative(t, y.data(), u0, k1.data(), wanted ? &r : nullptr);
            if (wanted) {
                fine.u.push_back(r.u);
                fine.i.push_back(r.i);
                fine.x.push_back(r.x);
                fine.v.push_back(r.v);
                fine.a.push_back(r.a);
                fine.laser.push_back(r.laser);
                fine.cone.push_back(r.coneSource);
                fine.port.push_back(r.portSource);
            }
            for (std::size_t k = 0; k < n; ++k)
                z[k] = y[k] + h / 2 * k1[k];
            driver.derivative(t + h / 2, z.data(), u1, k2.data());
            for (std::size_t k = 0; k < n; ++k)
                z[k] = y[k] + h / 2 * k2[k];
            driver.derivative(t + h / 2, z.data(), u1, k3.data());
            for (std::size_t k = 0; k < n; ++k)
                z[k] = y[k] + h * k3[k];
            driver.derivative(t + h, z.data(), u2, k4.data());
            for (std::size_t k = 0; k < n; ++k)
                y[k] += h / 6 * (k1[k] + 2 * k2[k] + 2 * k3[k] + k4[k]);
            if (!std::isfinite(y[2]) || std::abs(y[2]) > 1)
                throw std::runtime_error("the driver has left the room");
        }
        start += double(all) * h;
    }
}

}  // namespace

int main(int count, char** words)
try {
    if (count != 3)
        throw std::runtime_error("simulate SETUP OUT");
    auto setup = Setup::read(words[1]);
    const double rate = setup.number("rate");
    const int oversample = int(setup.number("oversample", 8)), substeps = int(setup.number("substeps", 1));
    Fine fine;
    integrate(setup, rate, oversample, substeps, fine);
    auto pressure = radiate(fine.cone, fine.port, fine.x, rate * oversample, setup.number("mic.distance", 1),
                            setup.number("on.doppler") != 0);

    const std::vector<double>* order[] = {&fine.u, &fine.i, &fine.x, &fine.v, &fine.a, &fine.laser, &pressure};
    std::vector<std::vector<double>> out;
    for (auto* channel : order)
        out.push_back(decimate(*channel, oversample));
    std::FILE* file = std::fopen(words[2], "wb");
    if (!file)
        throw std::runtime_error("cannot write");
    for (std::size_t s = 0; s < out[0].size(); ++s)
        for (auto& channel : out)
            std::fwrite(&channel[s], sizeof(double), 1, file);
    std::fclose(file);
} catch (const std::exception& problem) {
    std::fprintf(stderr, "simulate: %s\n", problem.what());
    return 1;
}
