// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/MeasuringPanel.h"

#include "Engine/Error.h"
#include "Engine/Import/ChannelMap.h"
#include "Plots/Words.h"
#include "Plugin/Look.h"
#include "Plugin/Text.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <utility>

namespace excursion::plugin {
namespace {

constexpr int period = 16384, settlePeriods = 1, periods = 3, realizations = 3;

/// A positive number out of a text field.
double entered(const juce::String& field, const char* what)
{
    const auto value = numberIn(field);
    if (!value || !(*value > 0.0))
        throw Error(Error::Kind::usage, std::string("\"") + field.trim().toStdString() + "\" is no " + what
                                            + ": enter a number above zero.");
    return *value;
}

/// Where a device's channel stands among those that are open, which alone are recorded and played.
int placeAmong(const juce::BigInteger& open, int channel, const std::string& what, juce::AudioIODevice& device)
{
    if (!open[channel])
        throw Error(Error::Kind::usage, what + " " + std::to_string(channel + 1) + " is not open on "
                                            + device.getName().toStdString() + ": tick it under Audio device.");
    return open.getBitRange(0, channel).countNumberOfSetBits();
}

double rateOf(juce::AudioDeviceManager& devices)
{
    auto* device = devices.getCurrentAudioDevice();
    return device != nullptr ? device->getCurrentSampleRate() : 48000.0;
}

}  // namespace

MeasuringPanel::MeasuringPanel(Window& window, juce::AudioDeviceManager& devices) : window_(window), devices_(devices)
{
    device_.onClick = [this] { showDevices(); };
    go_.onClick = [this] { running() ? cancel() : start(); };
    int order = 0;
    const auto add = [this, &order](std::initializer_list<juce::Component*> parts) {
        for (auto* part : parts) {
            part->setExplicitFocusOrder(++order);
            addAndMakeVisible(part);
        }
    };
    add({&device_, &deviceName_});
    for (int k = 0; k < inputs; ++k) {
        auto& input = inputs_[static_cast<std::size_t>(k)];
        input.title.setText("Input " + juce::String(k + 1), juce::dontSendNotification);
        input.role.addItem("not used", 1);
        for (std::size_t q = 0; q < quantities.size(); ++q)
            input.role.addItem(words(name(quantities[q])), static_cast<int>(q) + 2);
        input.role.setSelectedId(1, juce::dontSendNotification);
        input.role.onChange = [this, &input] { relabel(input); };
        input.fullScale.setText("1");
        input.role.setTitle("What input " + juce::String(k + 1) + " is");
        input.fullScale.setTitle("Full scale of input " + juce::String(k + 1));
        input.fullScale.setTooltip("What a sample of 1.0 stands for");
        input.limit.setTitle("Limit of input " + juce::String(k + 1));
        input.limit.setTextToShowWhenEmpty("no limit", look::palette().dim);
        add({&input.title, &input.role, &input.fullScale, &input.unit, &input.limit});
    }
    add({&outputTitle_, &outputChannel_, &fullScaleTitle_, &fullScale_, &levelsTitle_, &levels_, &bandTitle_, &low_,
         &high_, &preview_, &go_});
    outputChannel_.setTitle("Output channel");
    fullScale_.setTitle("Volts at the output's full scale");
    levels_.setTitle("Levels, volts rms");
    low_.setTitle("Lower end of the band, Hz");
    high_.setTitle("Upper end of the band, Hz");
    setRole(0, Quantity::voltage, 16.0);
    setRole(1, Quantity::current, 4.0);
    outputTitle_.setText("Output", juce::dontSendNotification);
    for (int k = 1; k <= 8; ++k)
        outputChannel_.addItem(juce::String(k), k);
    outputChannel_.setSelectedId(1, juce::dontSendNotification);
    fullScaleTitle_.setText("V at full scale", juce::dontSendNotification);
    fullScale_.setText("16");
    levelsTitle_.setText("Levels, V rms", juce::dontSendNotification);
    levels_.setText("0.5  1.5  3");
    bandTitle_.setText("Band, Hz", juce::dontSendNotification);
    low_.setText("15");
    high_.setText("8000");
    for (auto* editor : {&levels_, &low_, &high_, &fullScale_})
        editor->onTextChange = [this] { preview(); };
    preview();
}

MeasuringPanel::~MeasuringPanel()
{
    if (measuring_)
        end();
}

void MeasuringPanel::relabel(Input& input)
{
    const int q = input.role.getSelectedId() - 2;
    input.fullScale.setEnabled(q >= 0);
    input.limit.setEnabled(q >= 0);
    const auto unit = q >= 0 ? words(siUnit(quantities[static_cast<std::size_t>(q)])) : juce::String();
    input.unit.setText(q >= 0 ? unit + " full scale" : juce::String(), juce::dontSendNotification);
    input.limit.setTooltip(
        q >= 0 ? "What it must not reach, in " + unit + " or with its unit"
                     + (quantities[static_cast<std::size_t>(q)] == Quantity::displacement ? " from where it rests" : "")
                     + ": the measurement fades out and ends. Empty: no limit"
               : juce::String());
}

void MeasuringPanel::setRole(int input, Quantity quantity, double fullScale)
{
    auto& one = inputs_[static_cast<std::size_t>(input)];
    for (std::size_t q = 0; q < quantities.size(); ++q)
        if (quantities[q] == quantity)
            one.role.setSelectedId(static_cast<int>(q) + 2, juce::dontSendNotification);
    one.fullScale.setText(juce::String(fullScale));
    relabel(one);
}

void MeasuringPanel::setLimit(int input, const juce::String& text)
{
    inputs_[static_cast<std::size_t>(input)].limit.setText(text);
}

void MeasuringPanel::setBand(double low, double high)
{
    low_.setText(juce::String(low));
    high_.setText(juce::String(high));
}

ExcitationPlanOptions MeasuringPanel::planOptions() const
{
    ExcitationPlanOptions options;
    options.multisine.sampleRate = rateOf(devices_);
    options.multisine.period = options.multisine.sampleRate > 64000.0 ? 2 * period : period;
    options.multisine.bandLow = entered(low_.getText(), "frequency");
    options.multisine.bandHigh = entered(high_.getText(), "frequency");
    options.settlePeriods = settlePeriods;
    options.periods = periods;
    options.realizations = realizations;
    options.levels.clear();
    // A comma within a number is refused, as it may be a decimal one: "1,5" is not 1 V and then 5 V.
    for (const auto& level : juce::StringArray::fromTokens(levels_.getText(), " ;", ""))
        if (const auto number = level.trimCharactersAtEnd(","); number.isNotEmpty())
            options.levels.push_back(entered(number, "level"));
    std::string reason;
    if (!options.isValid(&reason))
        throw Error(Error::Kind::usage, "The excitation cannot be played: " + reason + ".");
    return options;
}

std::vector<InputRole> MeasuringPanel::roles() const
{
    std::vector<InputRole> result;
    for (int k = 0; k < inputs; ++k) {
        const auto& input = inputs_[static_cast<std::size_t>(k)];
        const int q = input.role.getSelectedId() - 2;
        if (q < 0)
            continue;
        const auto quantity = quantities[static_cast<std::size_t>(q)];
        for (const auto& other : result)
            if (other.quantity == quantity)
                throw Error(Error::Kind::usage, "Two inputs are the " + std::string(name(quantity)) + ": choose one.");
        InputRole role {k, quantity, entered(input.fullScale.getText(), "calibration"), {}};
        if (const auto limit = input.limit.getText().trim().toStdString(); !limit.empty()) {
            role.limit = amountOf(quantity, limit);
            if (!role.limit || !(*role.limit > 0.0))
                throw Error(Error::Kind::usage, "\"" + limit + "\" is no limit of the " + std::string(name(quantity))
                                                    + ": enter a number in " + std::string(siUnit(quantity))
                                                    + ", or one with its unit, above zero.");
        }
        result.push_back(role);
    }
    return result;
}

/// What is going to be played, in a sentence.
void MeasuringPanel::preview()
{
    try {
        const auto options = planOptions();
        const double seconds = static_cast<double>(options.multisine.period * (options.settlePeriods + options.periods)
                                                   * options.realizations)
                               * static_cast<double>(options.levels.size()) / options.multisine.sampleRate;
        // A random-phase multisine peaks at some four times its rms.
        const double peak = 4.0 * options.levels.back(), most = entered(fullScale_.getText(), "voltage");
        preview_.setText("Rises to full level, then plays " + whole(seconds) + " s of odd multisines, to about "
                             + juce::String(peak, 1) + " V peak"
                             + (peak > most ? ", more than the output can give!" : "."),
                         juce::dontSendNotification);
        look::setTone(preview_, peak > most ? look::Tone::warning : look::Tone::dim);
    } catch (const Error& error) {
        preview_.setText(words(error.what()), juce::dontSendNotification);
        look::setTone(preview_, look::Tone::warning);
    }
}

void MeasuringPanel::start()
{
    try {
        auto* device = devices_.getCurrentAudioDevice();
        if (device == nullptr || !device->isOpen())
            throw Error(Error::Kind::usage, "No audio device is open: choose one first.");
        const auto plan = planExcitation(planOptions());
        const double fullScale = entered(fullScale_.getText(), "voltage");
        const auto wanted = roles();
        bool voltage = false;
        std::vector<int> inputs;
        for (const auto& role : wanted) {
            voltage = voltage || role.quantity == Quantity::voltage;
            inputs.push_back(placeAmong(device->getActiveInputChannels(), role.input, "Input", *device));
        }
        const int output = placeAmong(device->getActiveOutputChannels(), outputChannel_.getSelectedId() - 1, "Output",
                                      *device);
        if (!voltage || wanted.size() < 2)
            throw Error(
                Error::Kind::usage,
                "Choose an input for the voltage at the terminals and at least one other, such as the current.");
        if (window_.processor().session().keeps())
            throw Error(Error::Kind::usage,
                        "What was measured last waits for the work that is under way: cancel that, or wait.");
        window_.onceAgreed(true, "measure", [=, this] { play(plan, wanted, inputs, output, fullScale); });
    } catch (const std::exception& error) {
        window_.tell(words(error.what()), true);
    }
}

void MeasuringPanel::play(const Measurement& plan, const std::vector<InputRole>& roles, const std::vector<int>& inputs,
                          int output, double fullScale)
{
    try {
        window_.processor().suspendProcessing(true);  // nothing else is heard meanwhile
        measuring_ = std::make_unique<Measuring>(std::make_unique<OpenDevice>(devices_, inputs, output), plan, roles,
                                                 fullScale);
        go_.setButtonText("Stop");
        device_.setEnabled(false);  // its test tone would be heard, and its dialog hide Stop
        enableAppOptions(false);
        window_.tell("Measuring. Do not touch the loudspeaker.", false);
    } catch (const std::exception& error) {
        end();
        window_.tell(words(error.what()), true);
    }
}

void MeasuringPanel::end()
{
    measuring_ = nullptr;
    window_.processor().suspendProcessing(false);
    go_.setButtonText("Start measuring");
    device_.setEnabled(true);
    enableAppOptions(true);
    preview();
}

void MeasuringPanel::cancel()
{
    if (measuring_)
        measuring_->stop();
}

void MeasuringPanel::tick()
{
    auto* device = devices_.getCurrentAudioDevice();
    deviceName_.setText(device != nullptr
                            ? device->getName() + ", " + whole(device->getCurrentSampleRate()) + " Hz, "
                                  + juce::String(device->getActiveInputChannels().countNumberOfSetBits()) + " inputs"
                            : juce::String("no device is open"),
                        juce::dontSendNotification);
    if (measuring_ && !measuring_->ended())
        showProgress();
    else if (measuring_)
        take();
    if (!window_.processor().session().keeps())
        return;
    if (window_.processor().session().status().busy) {  // a fit that is under way is not to end for it
        preview_.setText("Measured; waits for the work that is under way.", juce::dontSendNotification);
        return;
    }
    window_.processor().session().openKept();
    preview();
}

/// What came of a measurement that has ended.
void MeasuringPanel::take()
{
    try {
        auto recorded = measuring_->recorded();
        end();
        window_.processor().session().keep(std::move(recorded.recording), "Measured with " + recorded.device,
                                           std::move(recorded.remarks), recorded.fullScale);
    } catch (const Error& error) {
        end();
        window_.tell(words(error.what()), error.kind() != Error::Kind::cancelled);
    } catch (const std::exception& error) {
        end();
        window_.tell(words(error.what()), true);
    }
}

/// "Rising, voltage -12 dB, current -20 dB".
void MeasuringPanel::showProgress()
{
    const auto status = measuring_->status();
    auto text = words(capitalized(audio::name(status.stage)));
    if (status.attempt > 1)
        text += ", attempt " + juce::String(status.attempt);
    for (std::size_t k = 0; k < status.meters.size(); ++k)
        text += ", " + words(name(measuring_->roles()[k].quantity)) + " "
                + whole(20.0 * std::log10(std::max(static_cast<double>(status.meters[k].peak), 1e-6))) + " dB";
    look::setTone(preview_, look::Tone::text);
    preview_.setText(text, juce::dontSendNotification);
}

void MeasuringPanel::showDevices()
{
    juce::DialogWindow::LaunchOptions dialog;
    auto* selector = new juce::AudioDeviceSelectorComponent(devices_, 1, 8, 1, 8, false, false, false, false);
    selector->setSize(500, 420);
    dialog.content.setOwned(selector);
    dialog.dialogTitle = "Audio device";
    dialog.dialogBackgroundColour = look::palette().background;
    dialog.resizable = false;
    dialog.launchAsync();
}

void MeasuringPanel::resized()
{
    auto area = getLocalBounds();
    constexpr int rows = 8, foot = 36 + 28;
    const int height = juce::jlimit(24, 27, (getHeight() - foot) / rows - 3),
              gap = juce::jlimit(2, 6, (getHeight() - foot) / rows - height);
    const auto row = [&] {
        auto line = area.removeFromTop(height);
        area.removeFromTop(gap);
        return line;
    };
    constexpr int title = 56, wide = 108;
    auto line = row();
    device_.setBounds(line.removeFromLeft(122));
    line.removeFromLeft(6);
    deviceName_.setBounds(line);
    for (auto& input : inputs_) {
        line = row();
        input.title.setBounds(line.removeFromLeft(title));
        input.role.setBounds(line.removeFromLeft(116));
        line.removeFromLeft(6);
        input.fullScale.setBounds(line.removeFromLeft(50));
        input.limit.setBounds(line.removeFromRight(60));
        input.unit.setBounds(line);
    }
    line = row();
    outputTitle_.setBounds(line.removeFromLeft(title));
    outputChannel_.setBounds(line.removeFromLeft(64));
    line.removeFromLeft(8);
    fullScaleTitle_.setBounds(line.removeFromLeft(112));
    fullScale_.setBounds(line.removeFromLeft(64));
    line = row();
    levelsTitle_.setBounds(line.removeFromLeft(wide));
    levels_.setBounds(line);
    line = row();
    bandTitle_.setBounds(line.removeFromLeft(wide));
    low_.setBounds(line.removeFromLeft(72));
    line.removeFromLeft(8);
    high_.setBounds(line.removeFromLeft(72));
    preview_.setBounds(area.removeFromTop(36));
    go_.setBounds(area.removeFromTop(28).removeFromLeft(140));
}

}  // namespace excursion::plugin
