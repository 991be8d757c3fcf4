// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/Narx/NarxFile.h"

#include "Engine/Document/JsonText.h"

namespace excursion {
namespace {

constexpr DocumentFormat narxFormat {"excursion-narx"};

}  // namespace

nlohmann::ordered_json toJson(const Named<Narx>& named)
{
    const auto& model = named.model;
    auto document = modelHeader(narxFormat, named.name, model.sampleRate, named.input, named.output);
    document["outputLags"] = model.outputLags;
    document["inputLags"] = model.inputLags;
    document["terms"] = nlohmann::ordered_json::array();
    for (Eigen::Index k = 0; k < model.parameters(); ++k) {
        const Eigen::RowVectorXi exponents = model.exponents.row(k);
        const std::vector<int> powers(exponents.begin(), exponents.end());
        document["terms"].push_back({{"exponents", powers}, {"coefficient", model.coefficients[k]}});
    }
    return document;
}

Named<Narx> narxFromJson(const JsonField& field)
{
    auto named = namedFromHeader<Narx>(field, narxFormat);
    auto& model = named.model;
    model.outputLags = field.at("outputLags").count(0, 100);
    model.inputLags = field.at("inputLags").count(0, 100);
    const auto terms = field.at("terms").items();
    const int variables = model.outputLags + model.inputLags + 1;
    model.exponents.resize(static_cast<Eigen::Index>(terms.size()), variables);
    model.coefficients.resize(model.exponents.rows());
    for (Eigen::Index k = 0; k < model.parameters(); ++k) {
        const auto& term = terms[static_cast<std::size_t>(k)];
        const auto exponents = term.at("exponents").items();
        if (static_cast<int>(exponents.size()) != variables)
            term.at("exponents").refuse("one exponent a lag and for the input itself, " + std::to_string(variables));
        for (int v = 0; v < variables; ++v)
            model.exponents(k, v) = exponents[static_cast<std::size_t>(v)].count(0, 20);
        model.coefficients[k] = term.at("coefficient").number();
    }
    return named;
}

}  // namespace excursion
