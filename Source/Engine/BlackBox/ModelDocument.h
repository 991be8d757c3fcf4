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

/// A model without physics, with one input and one output, as stored in its document. Only this file decides which
/// document is which model.
struct ModelDocument {
    struct Fractional {
        FractionalPnlss model;
        FractionalGrid grid;
    };
    std::string name;
    std::string input, output;  ///< quantities, "voltage"
    double sampleRate = 0.0;    ///< Hz, at which it was identified; 0: continuous time, for any rate
    std::variant<StateSpace, FractionalStateSpace, Pnlss, Fractional, BlockModel, Narx, ParallelHammerstein,
                 VolterraSeries>
        model;
    std::optional<Stimulus> stimulus;  ///< the input of its fit, if the document has it
    std::string source;                ///< name of the document, for error messages
};

/// Whether the format is one of such a model: "excursion-state-space", "excursion-fractional-state-space",
/// "excursion-pnlss", "excursion-fractional-pnlss", "excursion-block-model", "excursion-narx",
/// "excursion-parallel-hammerstein", "excursion-volterra-series".
bool isModelDocument(const JsonField&);

/// Throws Error (input) naming the field if the document is none of these or broken, (data) for a model with several
/// inputs or outputs, a model of integer order in continuous time, or a model with a separate delay.
ModelDocument modelDocumentFrom(const JsonField&);

/// N x 1 to N x 1, from rest, by the simulation of its own class. The integrators of a linear model of fractional order
/// are ladders from a tenth of the slowest frequency in the record to its sample rate.
/// @param sampleRate  Hz, of the input: the model's rate, if it has one
Eigen::MatrixXd simulate(const ModelDocument&, const Eigen::MatrixXd& input, double sampleRate);

/// The form in which it is played in real time and inverted. Throws Error (data) for a linear model, for a Volterra
/// series, which is only a part of the model that it was made from, for a model without the stimulus of its fit, for
/// one whose linear part is not stable, or that the blackBoxOf() of its class refuses.
BlackBox blackBoxOf(const ModelDocument&);

}  // namespace excursion
