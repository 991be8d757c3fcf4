// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Destination.h"
#include "Cli/Terminal.h"
#include "Cli/Verbs.h"

#include "Engine/Document/DocumentFormat.h"
#include "Engine/Document/JsonText.h"
#include "Engine/Error.h"
#include "Engine/Import/Calibration.h"
#include "Engine/Import/ChannelMap.h"
#include "Engine/Import/ResponseCurve.h"
#include "Engine/Import/Tone.h"
#include "Engine/Take/Air.h"
#include "Engine/Take/WavFile.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

namespace excursion::cli {
namespace {

namespace fs = std::filesystem;

struct CalibrateArguments {
    std::string file, out, quantity, sensitivity, curve, latency;
    int channel = 1;
    double voltage = 0.0, spl = 0.0, divider = 0.0, resistor = 0.0, preamp = 0.0;
    bool hasSpl = false, hasPreamp = false, inverted = false, upright = false;
};

ChannelCalibration entryOf(const CalibrateArguments& a, const Calibration& calibration, const Tone& tone)
{
    ChannelCalibration entry;
    if (const auto* known = calibration.find(a.channel))
        entry = *known;
    entry.channel = a.channel;
    entry.relativeError = tone.relativeError;
    if (!a.quantity.empty())
        entry.quantity = quantityNamed(a.quantity);
    if (a.hasSpl) {
        if (entry.quantity && *entry.quantity != Quantity::pressure)
            throw Error(Error::Kind::usage, "--spl calibrates a pressure, but channel " + std::to_string(a.channel)
                                                + " is the " + std::string(name(*entry.quantity))
                                                + "; give --quantity pressure, or another --channel.");
        if (!a.sensitivity.empty() || a.hasPreamp || a.divider > 0 || a.resistor > 0)
            throw Error(
                Error::Kind::usage,
                "--spl calibrates all from the microphone to the sample; leave --sensitivity, --preamp, --divider and "
                "--sense-resistor out.");
        entry.quantity = Quantity::pressure;
        entry.unit = "Pa";
        entry.fullScale = referencePressure * std::pow(10.0, a.spl / 20.0) / tone.rms;
        entry.referenceFrequency = tone.frequency;
        entry.sensitivity.reset();
        entry.preampGainDb.reset();
        entry.divider.reset();
        entry.senseResistor.reset();
    } else {
        entry.unit = "V";
        entry.fullScale = a.voltage / tone.rms;
    }
    if (a.divider > 0)
        entry.divider = a.divider;
    if (a.resistor > 0)
        entry.senseResistor = a.resistor;
    if (!a.sensitivity.empty())
        entry.sensitivity = parseSensitivity(a.sensitivity);
    if (a.hasPreamp)
        entry.preampGainDb = a.preamp;
    if (a.inverted || a.upright)
        entry.inverted = a.inverted;
    if (!a.latency.empty()) {
        const auto latency = durationOf(a.latency);
        if (!latency)
            throw Error(Error::Kind::usage, "'" + a.latency + "' is no latency of 0 to 1 s, such as 0.5ms.");
        entry.latency = *latency;
    }
    if (!a.curve.empty()) {
        readMicrophoneCurve(a.curve, entry.referenceFrequency);  // refused now rather than by import
        std::error_code error;
        const auto beside = fs::relative(a.curve, fs::absolute(a.out).parent_path(), error);
        entry.curve = error || beside.empty() ? fs::absolute(a.curve).string() : beside.string();
    }
    return entry;
}

void run(const CalibrateArguments& a, Terminal& terminal)
{
    requireFilePlace(a.out);
    if (a.hasSpl == (a.voltage > 0))
        throw Error(Error::Kind::usage,
                    "Give what the tone is: --voltage, in V rms at the input, or --spl, in dB at the microphone.");
    const auto sound = readSound(a.file);
    const auto label = "channel " + std::to_string(a.channel) + " of '" + a.file + "'";
    if (static_cast<std::size_t>(a.channel) > sound.channels.size())
        throw Error(Error::Kind::usage, "'" + a.file + "' has " + std::to_string(sound.channels.size())
                                            + " channels, so there is no channel " + std::to_string(a.channel)
                                            + "; they are counted from 1.");
    const auto& samples = sound.channels[static_cast<std::size_t>(a.channel) - 1];
    requireFinite(sound, static_cast<std::size_t>(a.channel) - 1, a.file);
    const auto tone = findTone(samples, sound.sampleRate, label.c_str());
    const bool merged = fs::exists(a.out);
    Calibration calibration = merged ? readCalibration(a.out) : Calibration {};
    const auto entry = entryOf(a, calibration, tone);
    std::string stands;
    if (entry.quantity) {
        const double full = entry.quantityAtFullScale(*entry.quantity, a.out);  // refuses what contradicts itself
        stands = " = " + significant(full) + " " + std::string(siUnit(*entry.quantity)) + " ("
                 + std::string(name(*entry.quantity)) + ")";
    }
    calibration.put(entry);
    const auto document = calibrationJson(calibration);
    writeJson(document, a.out);
    terminal.say("Tone on " + label + ": " + fixed(tone.frequency, 2) + " Hz, " + significant(tone.rms)
                 + " rms of full scale, from " + fixed(tone.begin, 2) + " to " + fixed(tone.end, 2) + " s; all else is "
                 + fixed(-tone.noiseDb, 0) + " dB below it.");
    terminal.say("A sample of 1.0 is " + significant(entry.fullScale) + " " + entry.unit + stands
                 + ". The tone is read to +-" + significant(std::max(100 * tone.relativeError, 1e-4), 2)
                 + " %; the error of the meter or calibrator that told its level comes on top.");
    terminal.say((merged ? "Wrote channel " : "Wrote " + a.out + " with channel ") + std::to_string(a.channel)
                 + (merged ? " into " + a.out : "") + ".");
    terminal.document(DocumentFormat {"excursion-calibrate"}.with({{"file", a.file},
                                                                   {"channel", a.channel},
                                                                   {"frequency", tone.frequency},
                                                                   {"rms", tone.rms},
                                                                   {"relativeError", tone.relativeError},
                                                                   {"noiseDb", tone.noiseDb},
                                                                   {"begin", tone.begin},
                                                                   {"end", tone.end},
                                                                   {"calibration", document}}));
}

}  // namespace

void addCalibrate(CLI::App& app, Terminal& terminal)
{
    auto o = std::make_shared<CalibrateArguments>();
    auto* verb = app.add_subcommand("calibrate", "Learn the full scale of an input from a recorded tone, for import")
                     ->group(step::measure);
    verb->add_option("FILE", o->file, "a recording of a steady tone (.wav, .aif, .caf, .flac)")->required();
    verb->add_option("--out", o->out, "the calibration; entries for other channels are kept")
        ->required()
        ->type_name("FILE.json");
    verb->add_option("--channel", o->channel, "the input, counted from 1")
        ->check(CLI::Range(1, 4096))
        ->capture_default_str();
    verb->add_option("--voltage", o->voltage,
                     "V rms of the tone at the converter's input, after divider, sensor and preamplifier")
        ->check(CLI::PositiveNumber);
    auto* spl = verb->add_option("--spl", o->spl,
                                 "dB (20 uPa) of a calibrator's tone at the microphone: calibrates the whole path")
                    ->check(CLI::Range(40.0, 160.0));
    verb->add_option("--quantity", o->quantity, "what is connected to it")->check(CLI::IsMember(quantityNames()));
    verb->add_option("--divider", o->divider, "voltage at the loudspeaker over that at the input")
        ->check(CLI::Range(1.0, 1e6));
    verb->add_option("--sense-resistor", o->resistor, "ohm; the current is the voltage over it")
        ->check(CLI::PositiveNumber);
    verb->add_option("--sensitivity", o->sensitivity, "of a sensor, such as 50mV/Pa, 10.2mV/g, 1V/mm, 0.1V/A")
        ->type_name("TEXT");
    auto* preamp = verb->add_option("--preamp", o->preamp, "gain of a preamplifier between sensor and input, dB")
                       ->check(CLI::Range(-120.0, 120.0));
    auto* invert = verb->add_flag("--invert", o->inverted, "the channel is upside down");
    verb->add_flag("--no-invert", o->upright, "it is not, though an earlier --invert said so")->excludes(invert);
    verb->add_option("--latency", o->latency, "by which the sensor is late, such as 0.5ms")->type_name("TIME");
    verb->add_option("--curve", o->curve,
                     "a sensor's response: frequency in Hz, dB[, phase in degrees]; without phases it is taken as "
                     "minimum phase")
        ->type_name("FILE");
    verb->callback([o, spl, preamp, &terminal] {
        o->hasSpl = spl->count() > 0;
        o->hasPreamp = preamp->count() > 0;
        run(*o, terminal);
    });
}

}  // namespace excursion::cli
