// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/Pnlss/PnlssFile.h"

#include "Engine/Document/DocumentFormat.h"
#include "Engine/Document/JsonText.h"
#include "Engine/Linear/StateSpaceFile.h"

#include <cmath>

namespace excursion {
namespace {

using Eigen::Index;
using Json = nlohmann::ordered_json;

constexpr DocumentFormat pnlssFormat {"excursion-pnlss"};

/// One object a monomial: its exponents, its coefficient in each row, and which of them a fit may move.
Json termJson(const Pnlss& model, Index k)
{
    Json exponents = Json::array(), E = Json::array(), F = Json::array(), free = Json::array();
    for (Index v = 0; v < model.exponents.cols(); ++v)
        exponents.push_back(model.exponents(k, v));
    for (Index i = 0; i < model.E.rows(); ++i)
        E.push_back(model.E(i, k));
    for (Index o = 0; o < model.F.rows(); ++o)
        F.push_back(model.F(o, k));
    for (Index r = 0; r < model.free.rows(); ++r)
        free.push_back(model.free(r, k));
    return {{"exponents", exponents}, {"E", E}, {"F", F}, {"free", free}};
}

}  // namespace

Json termsJson(const Pnlss& model)
{
    Json terms = Json::array();
    for (Index k = 0; k < model.terms(); ++k)
        terms.push_back(termJson(model, k));
    return terms;
}

Json toJson(const NamedPnlss& named)
{
    Json document = pnlssFormat.with({{"name", named.name}});
    document["linear"] = toJson(NamedStateSpace {named.name, named.inputs, named.outputs, named.model.linear});
    document["terms"] = termsJson(named.model);
    return document;
}

void readTerms(const JsonField& field, Pnlss& model)
{
    const auto n = model.linear.order(), m = model.linear.inputs(), p = model.linear.outputs();
    const auto terms = field.items();
    const auto K = static_cast<Index>(terms.size());
    model.exponents.resize(K, n + m);
    model.E.resize(n, K);
    model.F.resize(p, K);
    model.free.resize(n + p, K);
    for (Index k = 0; k < K; ++k) {
        const auto& term = terms[static_cast<std::size_t>(k)];
        const auto exponents = term.at("exponents").items();
        if (static_cast<Index>(exponents.size()) != n + m)
            term.at("exponents").refuse("one exponent a state and input, " + std::to_string(n + m));
        for (Index v = 0; v < n + m; ++v)
            model.exponents(k, v) = exponents[static_cast<std::size_t>(v)].count(0, 20);
        if (model.exponents.row(k).sum() == 1)
            term.at("exponents").refuse("a degree that is not 1, as A, B, C and D are of degree 1");
        const auto column = [&term](const char* key, Index rows) {
            const auto values = term.at(key).numbers();
            if (static_cast<Index>(values.size()) != rows)
                term.at(key).refuse(std::to_string(rows) + " numbers");
            for (const double value : values)
                if (!std::isfinite(value))
                    term.at(key).refuse("finite numbers");
            return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(values.data(), rows));
        };
        model.E.col(k) = column("E", n);
        model.F.col(k) = column("F", p);
        const auto free = term.at("free").items();
        if (static_cast<Index>(free.size()) != n + p)
            term.at("free").refuse("one true or false a state and output, " + std::to_string(n + p));
        for (Index r = 0; r < n + p; ++r)
            model.free(r, k) = free[static_cast<std::size_t>(r)].flag();
    }
}

NamedPnlss pnlssFromJson(const JsonField& field)
{
    pnlssFormat.require(field);
    auto linear = stateSpaceFromJson(field.at("linear"));
    NamedPnlss named {field.at("name").text(), linear.inputs, linear.outputs, {}};
    auto& model = named.model;
    model.linear = std::move(linear.model);
    if (model.linear.continuous())
        field.at("linear").at("sampleRate").refuse("a sample rate above 0 Hz: these models are of discrete time");
    readTerms(field.at("terms"), model);
    return named;
}

}  // namespace excursion
