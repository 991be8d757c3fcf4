// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/BlackBox/ModelDocument.h"

#include "Engine/Error.h"
#include "Engine/Fractional/FractionalStateSpaceFile.h"
#include "Engine/Fractional/TimeResponse.h"
#include "Engine/Linear/Simulation.h"
#include "Engine/Linear/StateSpaceFile.h"
#include "Engine/Polynomial/Block/BlockModelFile.h"
#include "Engine/Polynomial/FractionalPnlss/FractionalPnlssFile.h"
#include "Engine/Polynomial/FractionalPnlss/FractionalSimulation.h"
#include "Engine/Polynomial/Hammerstein/ParallelHammersteinFile.h"
#include "Engine/Polynomial/Narx/NarxFile.h"
#include "Engine/Polynomial/Narx/NarxRecursion.h"
#include "Engine/Polynomial/Pnlss/PnlssFile.h"
#include "Engine/Polynomial/Volterra/VolterraSeriesFile.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <utility>

namespace excursion {
namespace {

using Fractional = ModelDocument::Fractional;

template <class Model>
ModelDocument documented(Named<Model> named, double sampleRate)
{
    return {std::move(named.name),
            std::move(named.input),
            std::move(named.output),
            sampleRate,
            std::move(named.model),
            std::nullopt,
            {}};
}

void requireOneEach(const std::vector<std::string>& inputs, const std::vector<std::string>& outputs,
                    const std::string& source)
{
    if (inputs.size() != 1 || outputs.size() != 1)
        throw Error(Error::Kind::data,
                    "'" + source + "' holds a model of several inputs or outputs; one of each is played.");
}

/// Of a class that may have several inputs and outputs.
template <class Model>
ModelDocument documented(const std::string& name, const std::vector<std::string>& inputs,
                         const std::vector<std::string>& outputs, double sampleRate, Model model,
                         const std::string& source)
{
    requireOneEach(inputs, outputs, source);
    if (!(sampleRate > 0.0))
        throw Error(Error::Kind::data,
                    "'" + source + "' holds a model of continuous time; identify one at a sample rate.");
    return {name, inputs.front(), outputs.front(), sampleRate, std::move(model), std::nullopt, {}};
}

ModelDocument stateSpace(const JsonField& document)
{
    auto named = stateSpaceFromJson(document);
    if (named.delay != 0.0)
        throw Error(Error::Kind::data, "'" + document.source()
                                           + "' holds a model that is late on purpose, by a delay beside it; it is "
                                             "not played.");
    return documented(named.name, named.inputs, named.outputs, named.model.sampleRate, named.model, document.source());
}

ModelDocument fractionalStateSpace(const JsonField& document)
{
    const auto named = fractionalStateSpaceFromJson(document);
    requireOneEach(named.inputs, named.outputs, document.source());
    return {named.name, named.inputs.front(), named.outputs.front(), 0.0, named.model, std::nullopt, {}};
}

ModelDocument pnlss(const JsonField& document)
{
    auto named = pnlssFromJson(document);
    return documented(named.name, named.inputs, named.outputs, named.model.linear.sampleRate, named.model,
                      document.source());
}

ModelDocument fractionalPnlss(const JsonField& document)
{
    auto named = fractionalPnlssFromJson(document);
    return documented(named.name, named.inputs, named.outputs, named.grid.sampleRate,
                      Fractional {named.model, named.grid}, document.source());
}

ModelDocument blockModel(const JsonField& document)
{
    auto named = blockModelFromJson(document);
    const double rate = named.model.linear.sampleRate;
    return documented(std::move(named), rate);
}

ModelDocument narx(const JsonField& document)
{
    auto named = narxFromJson(document);
    const double rate = named.model.sampleRate;
    return documented(std::move(named), rate);
}

ModelDocument hammerstein(const JsonField& document)
{
    auto named = parallelHammersteinFromJson(document);
    const double rate = named.model.sampleRate;
    return documented(std::move(named), rate);
}

ModelDocument volterraSeries(const JsonField& document)
{
    auto named = volterraSeriesFromJson(document);
    const double rate = named.model.sampleRate;
    return documented(std::move(named), rate);
}

struct Reader {
    const char* format;
    ModelDocument (*read)(const JsonField&);
};

constexpr std::array readers {Reader {"excursion-state-space", stateSpace},
                              Reader {"excursion-fractional-state-space", fractionalStateSpace},
                              Reader {"excursion-pnlss", pnlss},
                              Reader {"excursion-fractional-pnlss", fractionalPnlss},
                              Reader {"excursion-block-model", blockModel},
                              Reader {"excursion-narx", narx},
                              Reader {"excursion-parallel-hammerstein", hammerstein},
                              Reader {"excursion-volterra-series", volterraSeries}};

struct Simulate {
    const Eigen::MatrixXd& input;
    double sampleRate;
    template <class Model>
    Eigen::MatrixXd operator()(const Model& model) const
    {
        return simulate(model, input);
    }
    Eigen::MatrixXd operator()(const Fractional& model) const { return simulate(model.model, input, model.grid); }
    Eigen::MatrixXd operator()(const FractionalStateSpace& model) const
    {
        const DiffusiveLadderOptions band {0.1 * sampleRate / static_cast<double>(input.rows()), sampleRate, 4.0};
        return simulateByLadder(model, input, sampleRate, band);
    }
};

struct Box {
    const Stimulus& stimulus;
    const std::string& source;
    BlackBox operator()(const StateSpace&) const { return refuse(); }
    BlackBox operator()(const FractionalStateSpace&) const { return refuse(); }
    BlackBox operator()(const VolterraSeries&) const
    {
        throw Error(Error::Kind::data,
                    "'" + source + "' holds a Volterra series; use the model that it was made from.");
    }
    BlackBox operator()(const Fractional& model) const { return blackBoxOf(model.model, model.grid); }
    BlackBox operator()(const ParallelHammerstein& model) const { return blackBoxOf(model, stimulus); }
    template <class Model>
    BlackBox operator()(const Model& model) const
    {
        return blackBoxOf(model);
    }

    [[noreturn]] BlackBox refuse() const
    {
        throw Error(Error::Kind::data,
                    "'" + source + "' holds a linear model, which has no distortion: there is nothing to correct.");
    }
};

/// Whether the class is played and inverted, so that its document has to tell what it was fitted under.
bool needsStimulus(const ModelDocument& document)
{
    return !std::holds_alternative<StateSpace>(document.model)
           && !std::holds_alternative<FractionalStateSpace>(document.model)
           && !std::holds_alternative<VolterraSeries>(document.model);
}

}  // namespace

bool isModelDocument(const JsonField& document)
{
    if (!document.has("format") || !document.at("format").value().is_string())
        return false;
    const auto format = document.at("format").value().get<std::string>();
    return std::any_of(readers.begin(), readers.end(), [&](const Reader& reader) { return reader.format == format; });
}

ModelDocument modelDocumentFrom(const JsonField& document)
{
    std::vector<std::string> formats;
    for (const auto& reader : readers)
        formats.emplace_back(reader.format);
    const auto format = document.at("format").oneOf({formats.begin(), formats.end()});
    for (const auto& reader : readers)
        if (reader.format == format) {
            auto found = reader.read(document);
            found.stimulus = stimulusFrom(document);
            found.source = document.source();
            return found;
        }
    return {};  // not reached
}

Eigen::MatrixXd simulate(const ModelDocument& document, const Eigen::MatrixXd& input, double sampleRate)
{
    return std::visit(Simulate {input, sampleRate}, document.model);
}

BlackBox blackBoxOf(const ModelDocument& document)
{
    if (!document.stimulus && needsStimulus(document))
        throw Error(
            Error::Kind::data,
            "'" + document.source
                + "' does not say at which level and in which band it was fitted (the field stimulus), so nobody "
                  "knows how far it holds: fit it again with excursion pnlss or excursion rank --keep.");
    auto box = std::visit(Box {document.stimulus ? *document.stimulus : Stimulus {}, document.source}, document.model);
    box.name = document.name;
    box.input = document.input;
    box.output = document.output;
    box.stimulus = *document.stimulus;
    if (std::string reason; !box.isValid(&reason))
        throw Error(Error::Kind::data, "'" + document.source + "' cannot be played: " + reason + ".");
    return box;
}

}  // namespace excursion
