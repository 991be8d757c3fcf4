// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/PlayDocument.h"

#include "Engine/Error.h"
#include "Engine/Fractional/FractionalStateSpaceFile.h"
#include "Engine/Fractional/TimeResponse.h"
#include "Engine/Linear/Simulation.h"
#include "Engine/Linear/StateSpaceFile.h"
#include "Engine/Polynomial/Block/BlockModelFile.h"
#include "Engine/Polynomial/Hammerstein/ParallelHammersteinFile.h"
#include "Engine/Polynomial/Narx/NarxFile.h"
#include "Engine/Polynomial/Pnlss/PnlssFile.h"
#include "Engine/Polynomial/Volterra/VolterraSeriesFile.h"

#include <nlohmann/json.hpp>

namespace excursion::cli {
namespace {

void requireOneEach(const std::vector<std::string>& inputs, const std::vector<std::string>& outputs,
                    const std::string& path)
{
    if (inputs.size() != 1 || outputs.size() != 1)
        throw Error(Error::Kind::data,
                    "'" + path + "' holds a model of several inputs or outputs; one of each is played.");
}

template <class Model>
PlayedDocument playedAs(const Named<Model>& named, double sampleRate)
{
    return {named.input, named.output, sampleRate,
            [model = named.model](const Eigen::MatrixXd& u, double) { return simulate(model, u); }};
}

template <class Model>
PlayedDocument playedAs(const Model& model, const std::vector<std::string>& inputs,
                        const std::vector<std::string>& outputs, double sampleRate, const std::string& path)
{
    requireOneEach(inputs, outputs, path);
    if (!(sampleRate > 0.0))
        throw Error(Error::Kind::data,
                    "'" + path + "' holds a model of continuous time; identify one at a sample rate.");
    return {inputs.front(), outputs.front(), sampleRate,
            [model](const Eigen::MatrixXd& u, double) -> Eigen::MatrixXd { return simulate(model, u); }};
}

}  // namespace

std::optional<PlayedDocument> playedDocument(const std::string& path)
{
    const auto document = readJson(path);
    const JsonField field(document, "", path);
    const auto format = field.at("format").text();
    if (format == "excursion-parallel-hammerstein") {
        const auto named = parallelHammersteinFromJson(field);
        return playedAs(named, named.model.sampleRate);
    }
    if (format == "excursion-narx") {
        const auto named = narxFromJson(field);
        return playedAs(named, named.model.sampleRate);
    }
    if (format == "excursion-volterra-series") {
        const auto named = volterraSeriesFromJson(field);
        return playedAs(named, named.model.sampleRate);
    }
    if (format == "excursion-block-model") {
        const auto named = blockModelFromJson(field);
        return playedAs(named, named.model.linear.sampleRate);
    }
    if (format == "excursion-pnlss") {
        const auto named = pnlssFromJson(field);
        return playedAs(named.model, named.inputs, named.outputs, named.model.linear.sampleRate, path);
    }
    if (format == "excursion-state-space") {
        const auto named = stateSpaceFromJson(field);
        if (named.delay != 0.0)
            throw Error(Error::Kind::data, "'" + path
                                               + "' holds a model that is late on purpose, by a delay beside it; "
                                                 "it is not played.");
        return playedAs(named.model, named.inputs, named.outputs, named.model.sampleRate, path);
    }
    if (format == "excursion-fractional-state-space") {
        const auto named = fractionalStateSpaceFromJson(field);
        requireOneEach(named.inputs, named.outputs, path);
        return PlayedDocument {named.inputs.front(), named.outputs.front(), 0.0,
                               [model = named.model](const Eigen::MatrixXd& u, double rate) {
                                   const LadderOptions band {0.1 * rate / static_cast<double>(u.rows()), rate, 4.0};
                                   return simulateByLadder(model, u, rate, band);
                               }};
    }
    return std::nullopt;
}

}  // namespace excursion::cli
