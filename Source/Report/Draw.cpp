// SPDX-License-Identifier: GPL-3.0-or-later
#include "Report/Draw.h"

#include "Engine/Error.h"
#include "Report/Gnuplot.h"
#include "Report/InlineSvg.h"
#include "Report/RoleStyle.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace excursion {
namespace {

constexpr StandIn ink {1, 2, 3, "--ink"};
constexpr StandIn grid {1, 2, 4, "--grid"};

std::string number(double value)
{
    std::array<char, 64> text {};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 7).ptr;
    return {text.data(), end};
}

std::string colour(const StandIn& c)
{
    constexpr auto digits = "0123456789abcdef";
    std::string text = "rgb '#";
    for (const int part : {c.red, c.green, c.blue})
        for (const int digit : {part / 16, part % 16})
            text += digits[digit];
    return text + "'";
}

/// A text that gnuplot takes literally.
std::string quoted(const std::string& text)
{
    std::string result = "'";
    for (const char c : text)
        if (c == '\'')
            result += "\u2019";  // gnuplot's own way to write one fails at the head of a text
        else if (static_cast<unsigned char>(c) >= ' ')
            result += c;
    return result + "'";
}

bool drawable(const Plot& plot, const Series& s, std::size_t k)
{
    return std::isfinite(s.x[k]) && std::isfinite(s.y[k]) && (!plot.x.logarithmic || s.x[k] > 0.0)
           && (!plot.y.logarithmic || s.y[k] > 0.0);
}

/// The data of a series as a here-document: x, y, lower, upper; an empty line is a gap. False when there is none.
bool writeData(std::string& script, const Plot& plot, const Series& s, const std::string& name)
{
    std::string rows;
    bool any = false;
    for (std::size_t k = 0; k < std::min(s.x.size(), s.y.size()); ++k) {
        if (!drawable(plot, s, k)) {
            rows += "\n";
            continue;
        }
        any = true;
        const bool band = k < s.lower.size() && k < s.upper.size() && std::isfinite(s.lower[k])
                          && std::isfinite(s.upper[k]);
        rows += number(s.x[k]) + ' ' + number(s.y[k]) + ' ' + number(band ? s.lower[k] : s.y[k]) + ' '
                + number(band ? s.upper[k] : s.y[k]) + '\n';
    }
    if (any)
        script += name + " << EOD\n" + rows + "EOD\n";
    return any;
}

std::string label(const Axis& axis) { return axis.unit.empty() ? axis.title : axis.title + " (" + axis.unit + ")"; }

/// 1, 2, 5 times the powers of ten, as audio people read a frequency axis: 20, 50, 100, ..., 1k, ...
std::string frequencyTics()
{
    std::string tics;
    for (int decade = -1; decade <= 5; ++decade)
        for (const int digit : {1, 2, 5}) {
            const double value = digit * std::pow(10.0, decade);
            const auto text = value >= 1e3 ? number(value / 1e3) + "k" : number(value);
            tics += (tics.empty() ? "'" : ", '") + text + "' " + number(value);
        }
    return tics;
}

void writeAxis(std::string& script, const Axis& axis, char letter)
{
    const std::string a(1, letter);
    script += "set " + a + "label " + quoted(label(axis)) + " textcolor " + colour(ink) + "\n";
    script += "set " + a + "tics nomirror scale 0.4 textcolor " + colour(ink);
    if (!axis.names.empty()) {
        script += " (";
        for (std::size_t k = 0; k < axis.names.size(); ++k)
            script += (k == 0 ? "" : ", ") + quoted(axis.names[k]) + " " + std::to_string(k);
        script += ")";
    } else if (axis.logarithmic && letter == 'x') {
        script += " (" + frequencyTics() + ")";
    }
    script += "\nset format " + a + " '%h'\n";
    if (axis.logarithmic)
        script += "set logscale " + a + "\n";
    if (axis.least < axis.most)
        script += "set " + a + "range [" + number(axis.least) + ":" + number(axis.most) + "]\n";
    else if (letter == 'x')
        script += "set autoscale xfix\n";
}

void writePlot(std::string& script, const Plot& plot)
{
    script += "reset\nset terminal svg noenhanced dynamic size " + std::to_string(plot.width) + ","
              + std::to_string(plot.height) + " font 'sans-serif,12'\n";
    script += "set border 3 linewidth 0.8 linecolor " + colour(ink) + "\n";
    script += "set grid linetype 1 linewidth 0.7 linecolor " + colour(grid) + "\n";
    script += plot.key ? "set key tmargin left Left reverse horizontal samplen 1.1 width -0.5 textcolor " + colour(ink)
                             + "\n"
                       : "set key off\n";
    writeAxis(script, plot.x, 'x');
    writeAxis(script, plot.y, 'y');
    std::string bands, lines;
    for (std::size_t k = 0; k < plot.series.size(); ++k) {
        const auto& s = plot.series[k];
        const auto name = "$d" + std::to_string(k);
        if (s.hidden || !writeData(script, plot, s, name))
            continue;
        const auto& style = styleOf(s.role);
        if (!s.lower.empty())
            bands += name + " using 1:3:4 with filledcurves fillcolor " + colour(style.colour)
                     + " fillstyle transparent solid 0.18 noborder notitle, ";
        const bool points = s.shape == Series::Shape::pointsAndLine;
        lines += name + " using 1:2 with " + (points ? "linespoints pointtype 7 pointsize 0.5" : "lines") + " dashtype "
                 + std::to_string(s.dash > 0 ? s.dash : style.dash) + " linewidth " + number(style.width)
                 + " linecolor " + colour(style.colour) + (s.title.empty() ? " notitle" : " title " + quoted(s.title))
                 + ", ";
    }
    if (lines.empty()) {
        script += "set xrange [1:10]\nset yrange [1:10]\nplot NaN notitle\n";
        return;
    }
    auto command = bands + lines;
    command.resize(command.size() - 2);
    script += "plot " + command + "\n";
}

}  // namespace

std::vector<std::string> draw(const std::vector<Plot>& plots)
{
    if (plots.empty())
        return {};
    std::string script = "set encoding utf8\n";
    for (const auto& plot : plots)
        writePlot(script, plot);
    std::vector<StandIn> colours {ink, grid};
    for (const auto role :
         {Role::measured, Role::model, Role::error, Role::noise, Role::before, Role::after, Role::reference})
        colours.push_back(styleOf(role).colour);
    auto pictures = inlineSvgs(runGnuplot(script), colours);
    if (pictures.size() != plots.size())
        throw Error(Error::Kind::numerical, "gnuplot drew " + std::to_string(pictures.size()) + " of "
                                                + std::to_string(plots.size())
                                                + " plots of the report; version 5 or later is needed.");
    return pictures;
}

}  // namespace excursion
