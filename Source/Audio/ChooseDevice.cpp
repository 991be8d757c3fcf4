// SPDX-License-Identifier: GPL-3.0-or-later
#include "Audio/ChooseDevice.h"

#include "Engine/Document/Figures.h"
#include "Engine/Document/Words.h"
#include "Engine/Error.h"
#include "Engine/Import/TextTable.h"

#include <algorithm>
#include <cmath>

namespace excursion::audio {
namespace {

std::string listOf(const std::vector<Device>& devices)
{
    std::string text;
    for (std::size_t k = 0; k < devices.size(); ++k)
        text += (k == 0 ? "" : ", ") + std::to_string(k + 1) + " '" + devices[k].backend + ":" + devices[k].name + "'";
    return text;
}

std::string counted(int number, const char* what)
{
    return (number == 0 ? "no" : std::to_string(number)) + " " + what + (number == 1 ? "" : "s");
}

}  // namespace

const Device& chooseDevice(const std::vector<Device>& devices, const std::string& wanted)
{
    if (devices.empty())
        throw Error(Error::Kind::input, "There is no audio device; connect one, or start the JACK server.");
    if (wanted.empty())
        throw Error(Error::Kind::usage, "Say which --device is to be used; there are " + listOf(devices) + ".");
    std::vector<const Device*> matching;
    const auto collect = [&](auto matches) {
        if (matching.empty())
            for (const auto& device : devices)
                if (matches(device))
                    matching.push_back(&device);
    };
    collect([&](const Device& d) { return d.name == wanted || d.backend + ":" + d.name == wanted; });
    if (const auto number = parseNumber(wanted); matching.empty() && number && *number == std::floor(*number)
                                                 && *number >= 1 && *number <= static_cast<double>(devices.size()))
        return devices[static_cast<std::size_t>(*number) - 1];
    const auto lower = lowerCase(wanted);
    collect([&](const Device& d) { return lowerCase(d.backend + ":" + d.name).find(lower) != std::string::npos; });
    if (matching.size() == 1)
        return *matching.front();
    throw Error(Error::Kind::usage,
                (matching.empty() ? "There is no audio device '" : "More than one audio device is '") + wanted
                    + "'; there are " + listOf(devices) + ".");
}

void requireFit(const Device& device, int inputs, int outputs, double rate, const std::string& plan)
{
    if (inputs > device.inputs)
        throw Error(Error::Kind::usage, "Input " + std::to_string(inputs) + " is mapped, but '" + device.name + "' has "
                                            + counted(device.inputs, "input") + "; choose another --device or --map.");
    if (outputs > device.outputs)
        throw Error(Error::Kind::usage, "Output " + std::to_string(outputs) + " is to play, but '" + device.name
                                            + "' has " + counted(device.outputs, "output")
                                            + "; choose another --device or --output.");
    if (std::none_of(device.rates.begin(), device.rates.end(), [rate](double r) { return std::abs(r - rate) < 0.5; }))
        throw Error(
            Error::Kind::usage,
            "'" + plan + "' is for " + figure(rate, "%.10g") + " Hz, but '" + device.name + "' does "
                + (device.rates.empty() ? "none of the usual rates" : "only " + ratesText(device.rates))
                + "; set the device to that rate, or make a plan for one of its own (excursion excite --rate).");
}

std::string ratesText(const std::vector<double>& rates)
{
    std::string text;
    for (std::size_t k = 0; k < rates.size(); ++k)
        text += (k == 0 ? "" : k + 1 < rates.size() ? ", " : " and ") + figure(rates[k] / 1000.0, "%.10g");
    return text + " kHz";
}

}  // namespace excursion::audio
