// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/BlackBox/BlackBox.h"
#include "Engine/Document/JsonField.h"
#include "Engine/Fractional/FractionalStateSpace.h"
#include "Engine/Polynomial/Volterra/VolterraSeries.h"

#include <optional>
#include <string>
#include <variant>

namespace excursion {

/// A model of one input and one output that knows no physics, as its document has it. The one place
/// where it is decided which document is which model.
struct ModelDocument {
    struct Fractional {
        FractionalPnlss model;
        FractionalGrid grid;
    };
    std::string name;
    std::string input, output;  ///< quantities, "voltage"
    double sampleRate = 0.0;    ///< Hz, at which it was identified; 0: of continuous time and of any rate
    std::variant<StateSpace, FractionalStateSpace, Pnlss, Fractional, BlockModel, Narx, ParallelHammerstein,
                 VolterraSeries>
        model;
    std::optional<Stimulus> stimulus;  ///< what it was fitted under, where the document says so
    std::string source;                ///< of the document, for refusals
};

/// Whether the format is that of such a model: "excursion-state-space", "excursion-fractional-state-space",
/// "excursion-pnlss", "excursion-fractional-pnlss", "excursion-block-model", "excursion-narx",
/// "excursion-parallel-hammerstein", "excursion-volterra-series".
bool isModelDocument(const JsonField&);

/// Throws Error (input) naming the field when the document is none of these or broken, (data) for a model of several
/// inputs or outputs, of continuous time and whole order, or with a delay beside it.
ModelDocument modelDocumentFrom(const JsonField&);

/// N x 1 to N x 1, from rest, by the simulation of its own class. The integrators of a linear model of fractional order
/// are ladders from a tenth of the slowest frequency in the record to its sample rate.
/// @param sampleRate  Hz, of the input: the model's, where it has one
Eigen::MatrixXd simulate(const ModelDocument&, const Eigen::MatrixXd& input, double sampleRate);

/// In the form in which it is played in real time and inverted. Throws Error (data) for a linear one, for a
/// Volterra series, which is a part of the model it was made of, for one that does not say what it was fitted under,
/// whose linear part is not stable, or that its class' blackBoxOf() refuses.
BlackBox blackBoxOf(const ModelDocument&);

}  // namespace excursion
