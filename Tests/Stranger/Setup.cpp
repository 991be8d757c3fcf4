// SPDX-License-Identifier: GPL-3.0-or-later
#include "Setup.h"
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace sim {

Setup Setup::read(const std::string& path)
{
    std::ifstream in(path);
    if (!in)
        throw std::runtime_error("cannot read " + path);
    Setup setup;
    std::string line;
    while (std::getline(in, line)) {
        std::istringstream words(line);
        std::string name;
        if (!(words >> name) || name[0] == '#')
            continue;
        if (name == "block") {
            Block block;
            words >> block.file >> block.gain >> block.repeats >> block.stiffnessScale >> block.resistanceScale;
            if (!words)
                throw std::runtime_error("a block needs a file, gain, repeats and two scales: " + line);
            setup.blocks.push_back(block);
            continue;
        }
        std::vector<double> values;
        for (double value; words >> value;)
            values.push_back(value);
        setup.lists[name] = values;
    }
    return setup;
}

double Setup::number(const std::string& name, double otherwise) const
{
    auto found = lists.find(name);
    return found == lists.end() || found->second.empty() ? otherwise : found->second[0];
}

std::vector<double> Setup::list(const std::string& name) const
{
    auto found = lists.find(name);
    return found == lists.end() ? std::vector<double> {} : found->second;
}

std::vector<double> readDoubles(const std::string& path)
{
    std::ifstream in(path, std::ios::binary | std::ios::ate);
    if (!in)
        throw std::runtime_error("cannot read " + path);
    std::vector<double> values(std::size_t(in.tellg()) / sizeof(double));
    in.seekg(0);
    in.read(reinterpret_cast<char*>(values.data()), std::streamsize(values.size() * sizeof(double)));
    return values;
}

}  // namespace sim
