// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string>
#include <vector>

namespace excursion {

/// What of a take or a ladder something shows, by kind: {"level", "1.7 V"}. A page can switch off all that has it.
using Facets = std::map<std::string, std::string>;

/// What a line stands for; one colour a role, the same on every picture (Okabe & Ito's set, which colour-blind people
/// tell apart; the roles differ in their dashes as well).
enum class Role { measured, model, error, noise, before, after, reference };

struct Series {
    enum class Shape { line, pointsAndLine };
    std::string title;  ///< for the key; empty: not in it
    Role role = Role::measured;
    std::vector<double> x, y;          ///< a NaN interrupts the line
    std::vector<double> lower, upper;  ///< of a band around the line; empty: none
    Shape shape = Shape::line;
    /// 0: the role's own; otherwise a pattern of gnuplot's, to tell apart lines of one role
    int dash = 0;
    std::string told {};                ///< its name under the pointer, where lines share one title
    std::vector<std::string> names {};  ///< of its points, told under the pointer; empty: none
    Facets facets {};
    bool hidden = false;  ///< not drawn until a reader asks for it
};

struct Axis {
    std::string title;
    std::string unit;  ///< typeset, see displayUnit()
    bool logarithmic = false;
    double least = 0.0, most = 0.0;  ///< of the range; equal: from the data
    std::vector<std::string> names;  ///< of the values 0, 1, 2, ...; empty: numbers
};

/// A picture with two axes. Data is in the axes' display units.
struct Plot {
    std::string title;
    Axis x, y;
    std::vector<Series> series;
    bool key = true;
    Facets facets {};
    int width = 460, height = 300;
};

}  // namespace excursion
