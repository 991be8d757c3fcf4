// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Measurement/ImportImpedance.h"

#include "Engine/Document/TextFile.h"
#include "Engine/Error.h"
#include "Engine/Measurement/DelimitedText.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

namespace excursion {
namespace {

constexpr std::uintmax_t largestFile = 64u << 20;
constexpr std::size_t fewestPoints = 3;

struct Point {
    double frequency, magnitude, degrees;
    bool operator==(const Point&) const = default;
};

std::vector<std::string> split(std::string_view line, std::string_view separators)
{
    std::vector<std::string> cells;
    for (auto first = line.find_first_not_of(separators); first != std::string_view::npos;
         first = line.find_first_not_of(separators)) {
        line.remove_prefix(first);
        const auto end = std::min(line.find_first_of(separators), line.size());
        cells.emplace_back(line.substr(0, end));
        line.remove_prefix(end);
    }
    return cells;
}

/// The numbers of a line as texts. A comma inside a cell that something else separates from the next
/// is a decimal comma; any other comma is a separator.
std::vector<std::string> cellsOf(std::string_view line)
{
    auto cells = split(line, " \t;\r");
    const auto hasInnerComma = [](const std::string& cell) {
        const auto at = cell.find(',');
        return at != std::string::npos && at > 0 && at + 1 < cell.size();
    };
    if (cells.size() < 2 || std::none_of(cells.begin(), cells.end(), hasInnerComma))
        return split(line, " \t;,\r");
    for (auto& cell : cells)
        std::replace(cell.begin(), cell.end(), ',', '.');
    return cells;
}

/// @param magnitude  what the second column is, for sentences
std::vector<Point> readPoints(const std::filesystem::path& path, const std::string& magnitude)
{
    const auto text = readText(path, largestFile);
    std::size_t lineNumber = 0;
    const auto refuse = [&](const std::string& why) {
        throw Error(Error::Kind::input, "'" + path.string() + "', line " + std::to_string(lineNumber) + " " + why);
    };
    std::vector<Point> points;
    for (std::size_t first = 0; first < text.size();) {
        const auto end = std::min(text.find('\n', first), text.size());
        const auto cells = cellsOf(std::string_view(text).substr(first, end - first));
        first = end + 1;
        ++lineNumber;
        if (cells.empty() || cells.front().find_first_of("*;#\"") == 0)
            continue;
        if (!parseNumber(cells.front())) {
            if (points.empty())
                continue;   // a heading
            refuse("begins with '" + cells.front().substr(0, 20) + "', expected a frequency in Hz.");
        }
        std::array<double, 3> numbers {};
        for (std::size_t i = 0; i < std::max<std::size_t>(2, std::min<std::size_t>(3, cells.size())); ++i) {
            const auto value = i < cells.size() ? parseNumber(cells[i]) : std::nullopt;
            if (!value || !std::isfinite(*value))
                refuse("does not hold finite numbers for frequency in Hz, " + magnitude + " and phase in degrees.");
            numbers[i] = *value;
        }
        const Point point {numbers[0], numbers[1], numbers[2]};
        if (!points.empty() && point == points.back())
            continue;
        if (point.frequency <= (points.empty() ? 0.0 : points.back().frequency))
            refuse("has a frequency that is not positive or not above the one before it; sort the file by frequency.");
        points.push_back(point);
    }
    if (points.size() < fewestPoints)
        throw Error(Error::Kind::input, "'" + path.string() + "' has " + std::to_string(points.size())
                                            + " lines of frequency in Hz, " + magnitude + " and phase in degrees, expected at least 3.");
    return points;
}

std::complex<double> polar(double magnitude, double degrees) { return std::polar(magnitude, degrees * std::numbers::pi / 180); }

} // namespace

Spectra readZma(const std::filesystem::path& path)
{
    Spectra take;
    Spectra::Channel voltage {Quantity::voltage, "V", {}}, current {Quantity::current, "A", {}};
    for (const auto& [frequency, ohms, degrees] : readPoints(path, "impedance in ohm")) {
        if (ohms <= 0)
            throw Error(Error::Kind::input, "'" + path.string() + "' has an impedance that is not positive at "
                                                + std::to_string(frequency) + " Hz.");
        take.frequency.push_back(frequency);
        voltage.values.push_back(polar(ohms, degrees));
        current.values.emplace_back(1.0);
    }
    take.channels = {std::move(voltage), std::move(current)};
    take.driver.name = path.stem().string();
    return take;
}

Frf readFrd(const std::filesystem::path& path)
{
    Frf frf;
    for (const auto& [frequency, dB, degrees] : readPoints(path, "level in dB")) {
        if (std::abs(dB) > 1000)
            throw Error(Error::Kind::input, "'" + path.string() + "' has a level beyond 1000 dB at " + std::to_string(frequency) + " Hz.");
        frf.frequency.push_back(frequency);
        frf.value.push_back(polar(std::pow(10.0, dB / 20), degrees));
    }
    return frf;
}

Spectra spectraOfFrd(const Frf& frf)
{
    constexpr double hearingThreshold = 20e-6;   // Pa
    Spectra take;
    take.frequency = frf.frequency;
    Spectra::Channel voltage {Quantity::voltage, "V", std::vector<std::complex<double>>(frf.value.size(), 1.0)};
    Spectra::Channel pressure {Quantity::pressure, "Pa", frf.value};
    for (auto& value : pressure.values)
        value *= hearingThreshold;
    take.channels = {std::move(voltage), std::move(pressure)};
    return take;
}

} // namespace excursion
