// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Estimate/Frf.h"
#include "Scratch.h"

#include <fstream>
#include <random>
#include <sstream>

namespace excursion::test {

/// The rows of a CSV of numbers below its header; empty, with a visible warning, when the file is not there.
inline std::vector<std::vector<double>> problemRows(const std::string& file)
{
    const auto folder = dataFolder("../problems");
    std::vector<std::vector<double>> rows;
    if (folder.empty())
        return rows;
    std::ifstream stream(folder / file);
    std::string line;
    while (std::getline(stream, line)) {
        std::istringstream cells(line);
        std::vector<double> row;
        std::string cell;
        while (std::getline(cells, cell, ','))
            try {
                row.push_back(std::stod(cell));
            } catch (const std::exception&) {
                row.clear();
                break;
            }
        if (!row.empty())
            rows.push_back(row);
    }
    return rows;
}

/// A frequency response of the problems: f, Re, Im and, where there is one, the standard deviation.
inline Frf problemResponse(const std::string& file)
{
    Frf frf;
    for (const auto& row : problemRows(file)) {
        frf.frequency.push_back(row[0]);
        frf.value.emplace_back(row[1], row[2]);
        if (row.size() > 3)
            frf.noiseVariance.push_back(row[3] * row[3]);
    }
    return frf;
}

/// Standard normal numbers by the polar method, the same everywhere.
class Normal {
public:
    explicit Normal(std::uint64_t seed) : engine_(seed) {}
    double operator()()
    {
        double u, v, s;
        do {
            u = uniform();
            v = uniform();
            s = u * u + v * v;
        } while (s >= 1.0 || s == 0.0);
        return u * std::sqrt(-2.0 * std::log(s) / s);
    }

private:
    double uniform() { return 2.0 * (static_cast<double>(engine_() >> 11) * 0x1.0p-53) - 1.0; }
    std::mt19937_64 engine_;
};

}  // namespace excursion::test
