// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Import/Export.h"

#include "Engine/Document/DraftFile.h"
#include "Engine/Document/Figures.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace excursion {
namespace {

void appendRow(std::string& text, std::initializer_list<double> values, char separator)
{
    char before = 0;
    for (const double value : values) {
        if (before)
            text += before;
        text += shortestText(value);
        before = separator;
    }
    text += '\n';
}

double degrees(std::complex<double> value) { return std::arg(value) * 180 / std::numbers::pi; }

}  // namespace

void writeZma(const Frf& impedance, const std::filesystem::path& path)
{
    std::string text = "* Frequency (Hz)\tImpedance (ohm)\tPhase (degrees)\n";
    for (std::size_t k = 0; k < impedance.value.size(); ++k)
        appendRow(text, {impedance.frequency[k], std::abs(impedance.value[k]), degrees(impedance.value[k])}, '\t');
    publish(path, text);
}

void writeFrd(const Frf& frf, const std::filesystem::path& path)
{
    std::string text = "* Frequency (Hz)\tLevel (dB)\tPhase (degrees)\n";
    for (std::size_t k = 0; k < frf.value.size(); ++k)
        appendRow(text, {frf.frequency[k], 20 * std::log10(std::abs(frf.value[k])), degrees(frf.value[k])}, '\t');
    publish(path, text);
}

void writeCsv(const Frf& frf, const std::filesystem::path& path)
{
    const bool noise = !frf.noiseVariance.empty(), total = !frf.totalVariance.empty();
    std::string text = std::string("frequency_hz,re,im") + (noise ? ",noise_variance" : "")
                       + (total ? ",total_variance" : "") + "\n";
    for (std::size_t k = 0; k < frf.value.size(); ++k) {
        appendRow(text, {frf.frequency[k], frf.value[k].real(), frf.value[k].imag()}, ',');
        text.pop_back();
        if (noise)
            (text += ',') += shortestText(frf.noiseVariance[k]);
        if (total)
            (text += ',') += shortestText(frf.totalVariance[k]);
        text += '\n';
    }
    publish(path, text);
}

void writeCsv(const Measurement& measurement, const std::filesystem::path& path)
{
    std::string text = "time_s";
    for (const auto& channel : measurement.channels)
        text.append(",").append(name(channel.quantity)).append(" [").append(channel.unit).append("]");
    text += '\n';
    for (std::size_t n = 0; n < measurement.length(); ++n) {
        text += shortestText(static_cast<double>(n) / measurement.sampleRate);
        for (const auto& channel : measurement.channels)
            (text += ',') += shortestText(channel.samples[n]);
        text += '\n';
    }
    publish(path, text);
}

void writeCsv(const Spectra& spectra, const std::filesystem::path& path)
{
    std::string text;
    for (auto remark : spectra.remarks) {
        std::replace(remark.begin(), remark.end(), '\n', ' ');
        text.append(assumedMark).append(remark).append("\n");
    }
    text += "frequency_hz";
    for (const auto& channel : spectra.channels)
        for (const char* part : {"_re_", "_im_"})
            text.append(",").append(name(channel.quantity)).append(part).append(channel.unit);
    text += '\n';
    for (std::size_t k = 0; k < spectra.frequency.size(); ++k) {
        text += shortestText(spectra.frequency[k]);
        for (const auto& channel : spectra.channels) {
            (text += ',') += shortestText(channel.values[k].real());
            (text += ',') += shortestText(channel.values[k].imag());
        }
        text += '\n';
    }
    publish(path, text);
}

}  // namespace excursion
