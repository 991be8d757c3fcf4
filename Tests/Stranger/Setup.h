// SPDX-License-Identifier: GPL-3.0-or-later
// The description of one virtual bench run, read from a text file of "name value value ..." lines.
#pragma once
#include <map>
#include <string>
#include <vector>

namespace sim {

class Setup {
public:
    static Setup read(const std::string& path);

    bool has(const std::string& name) const { return lists.count(name) > 0; }
    double number(const std::string& name, double otherwise = 0) const;
    std::vector<double> list(const std::string& name) const;

    // One stretch of the signal: a file of doubles on the half-step grid, played `repeats` times.
    struct Block {
        std::string file;
        double gain = 1;
        int repeats = 1;
        double stiffnessScale = 1;   // how far the suspension has moved since the bench was set up
        double resistanceScale = 1;  // the same of the coil
    };
    std::vector<Block> blocks;

private:
    std::map<std::string, std::vector<double>> lists;
};

std::vector<double> readDoubles(const std::string& path);

}  // namespace sim
