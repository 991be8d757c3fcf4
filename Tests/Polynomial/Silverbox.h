// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Polynomial/Pnlss/PnlssFit.h"
#include "Linear/Problem.h"

#include <fstream>
#include <sstream>

namespace excursion::test {

/// The Silverbox benchmark, means removed: input and output in V at 1e7 / 2^14 Hz.
struct Silverbox {
    static constexpr double rate = 1e7 / 16384;
    Eigen::VectorXd input, output;  ///< empty, with a visible warning, when the data is not there

    Silverbox()
    {
        const auto folder = dataFolder("silverbox");
        if (folder.empty())
            return;
        std::ifstream file(folder / "SNLS80mV.csv");
        std::string line;
        std::vector<double> u, y;
        std::getline(file, line);
        while (std::getline(file, line)) {
            std::istringstream cells(line);
            std::string cell;
            for (auto* column : {&u, &y})
                if (std::getline(cells, cell, ',') && cell.find_first_of("0123456789") != std::string::npos)
                    column->push_back(std::stod(cell));
        }
        REQUIRE(u.size() == 131072);
        REQUIRE(y.size() == u.size());
        input = Eigen::Map<Eigen::VectorXd>(u.data(), 131072);
        output = Eigen::Map<Eigen::VectorXd>(y.data(), 131072);
        input.array() -= input.mean();
        output.array() -= output.mean();
    }

    InputOutputRecord record(Eigen::Index from, Eigen::Index to, Eigen::Index skip) const
    {
        return {input.segment(from, to - from), output.segment(from, to - from), skip, false};
    }
    InputOutputRecord multisines() const { return record(40580, 80000, 200); }
    InputOutputRecord lastMultisine() const { return record(118800, 127400, 200); }
    InputOutputRecord arrow() const { return record(0, 40000, 1000); }
};

}  // namespace excursion::test
