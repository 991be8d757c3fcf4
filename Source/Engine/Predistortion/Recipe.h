// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Document/JsonField.h"
#include "Engine/Predistortion/RealTime.h"

#include <nlohmann/json.hpp>

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace excursion {

/// How a signal is processed with a model.
enum class Mode {
    bypass,      ///< nothing
    speaker,     ///< played by the modelled driver, with all its distortion
    distortion,  ///< only the part of that which a linear driver would not add
    linearize,   ///< predistorted, for the real loudspeaker
    audition     ///< predistorted, then played by the modelled driver: how the loudspeaker will sound
};
inline constexpr std::array modes {Mode::bypass, Mode::speaker, Mode::distortion, Mode::linearize, Mode::audition};

std::string_view name(Mode);   ///< "bypass", as in the files
std::string_view title(Mode);  ///< "Distortion alone", for display

/// The numbers of a recipe, without text, so the audio thread may use them.
struct Settings {
    Mode mode = Mode::bypass;
    double fullScale = 10.0;         ///< V at the loudspeaker for a sample of 1.0
    double amount = 1.0;             ///< of linearization, 0 to 1
    double displacementLimit = 1.0;  ///< relative to the measured excursion of the model
    double voltageLimit = 100.0;     ///< V
    double powerLimit = 10000.0;     ///< W, of the coil's heat averaged over a second; the largest value: none
    double margin = 0.0;             ///< relative, of the model's parameters, see PredistortionControls
    double coilResistance = 0.0;     ///< ohm, for models without physics; 0: not known, and no power limit
    double trimDb = 0.0;             ///< gain of the output
    double coupling = 0.0;           ///< Hz, corner of the amplifier's high-pass; 0: none
    int couplingOrder = 1;           ///< 1 or 2
    Target target;                   ///< of linearization

    struct Range {
        double least, most;
        bool holds(double value) const { return value >= least && value <= most; }
    };
    static constexpr Range fullScales {0.01, 1000.0}, amounts {0.0, 1.0}, displacements {0.05, 4.0},
        voltages {0.01, 1000.0}, powers {0.01, 10000.0}, margins {0.0, 0.3}, resistances {0.0, 1000.0},
        trims {-60.0, 24.0}, couplings {0.0, AmplifierCoupling::highest};
    /// ranges of a target: Hz, Q, m^3, Hz for the ends of a band, dB for a curve
    static constexpr Range targetFrequencies {5.0, 5000.0}, targetQualities {0.2, 3.0}, targetVolumes {1e-4, 1.0},
        targetEnds {20.0, 20000.0}, targetLevels {-200.0, 300.0};
};

/// All user settings: how a model is used, whichever it is. As a document, format "excursion-recipe", version 5
/// (Docs/Formats.md).
struct Recipe : Settings {
    std::string title;
    std::string words;             ///< its purpose
    std::vector<std::string> off;  ///< ids of effects that are switched off

    bool isValid(std::string* reason) const;
};

/// The model without the effects that the recipe switches off.
Model withoutOff(const Model&, const Recipe&);

/// The controls of a predistorter. Its output never exceeds full scale, as no converter gives more. The first function
/// is safe on an audio thread.
/// The second is of a model as it was loaded, with the effects that are switched off: they say how far it was measured.
PredistortionControls controlsOf(const Settings&, double measuredDisplacement);
PredistortionControls controlsOf(const Recipe&, const Model&);

/// The amplifier of the settings. Between none and the lowest corner that can be stated lies the nearer of the two.
AmplifierCoupling couplingOf(const Settings&);

nlohmann::ordered_json toJson(const Recipe&);
/// Throws Error (input): the file, the field, what was found and what is expected.
Recipe recipeFromJson(const JsonField&);

}  // namespace excursion
