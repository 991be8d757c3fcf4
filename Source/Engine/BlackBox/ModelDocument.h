// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/BlackBox/BlackBox.h"
#include "Engine/Document/JsonField.h"

#include <optional>
#include <string>
#include <variant>

namespace excursion {

/// A model of one input and one output that knows no physics, in discrete time, as its document has it. The one place
/// where it is decided which document is which model.
struct ModelDocument {
    struct Fractional {
        FractionalPnlss model;
        FractionalGrid grid;
    };
    std::string name;
    std::string input, output;  ///< quantities, "voltage"
    double sampleRate = 0.0;    ///< Hz, at which it was identified
    std::variant<StateSpace, Pnlss, Fractional, BlockModel, Narx, ParallelHammerstein> model;
    std::optional<Stimulus> stimulus;  ///< what it was fitted under, where the document says so
    std::string source;                ///< of the document, for refusals
};

/// Whether the format is that of such a model: "excursion-state-space", "excursion-pnlss",
/// "excursion-fractional-pnlss", "excursion-block-model", "excursion-narx", "excursion-parallel-hammerstein".
bool isModelDocument(const JsonField&);

/// Throws Error (input) naming the field when the document is none of these or broken, (data) for a model of several
/// inputs or outputs, of continuous time, or with a delay beside it.
ModelDocument modelDocumentFrom(const JsonField&);

/// N x 1 to N x 1, from rest, by the simulation of its own class.
Eigen::MatrixXd simulate(const ModelDocument&, const Eigen::MatrixXd& input);

/// In the form in which it is played in real time and turned around. Throws Error (data) for a linear one, for one that
/// does not say what it was fitted under, whose linear part is not stable, or that its class' blackBoxOf() refuses.
BlackBox blackBoxOf(const ModelDocument&);

}  // namespace excursion
