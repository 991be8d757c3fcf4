// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Document/JsonText.h"
#include "Engine/Document/TextFile.h"
#include "Engine/Error.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/ModelFile.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <filesystem>
#include <limits>

using namespace excursion;

namespace {

/// Every effect of the catalogue, with numbers that have no short decimal form.
Model everything()
{
    auto model = makeModel("electrodynamic");
    model.name = "M\u00fcller \"16\"";
    OperatingRange operatingRange;
    operatingRange.displacement = 0.0051 / 3.0;
    operatingRange.degree = 5;
    for (const auto* effect : catalogue())
        model = withEffect(model, *effect, operatingRange);
    const auto all = parametersOf(model);
    for (std::size_t k = 0; k < all.size(); ++k) {
        all[k]->value = std::min(all[k]->upper, all[k]->value * (1.0 + 1.0 / 3.0) + 1.0 / 7.0);
        if (k % 3 != 0)
            all[k]->standardError = all[k]->value / 97.0;
    }
    const auto size = static_cast<Eigen::Index>(all.size());
    model.covariance = Eigen::MatrixXd::Identity(size, size) / 3.0;
    model.covariance(2, 1) = model.covariance(1, 2) = -0.1;
    model.covariance(0, 0) = std::numeric_limits<double>::quiet_NaN();
    model.microphoneDistance = 0.1 + 0.2;
    return model;
}

nlohmann::json parsed(const Model& model) { return nlohmann::json::parse(jsonText(toJson(model))); }

/// The sentence with which a document is refused; empty when it is read.
std::string refusal(const nlohmann::json& document)
{
    try {
        modelFromJson(document, "some.json");
        return {};
    } catch (const Error& e) {
        CHECK(e.kind() == Error::Kind::input);
        return e.what();
    }
}

}  // namespace

TEST_CASE("A model saved, read and saved again is the same, byte for byte", "[model]")
{
    const auto folder = std::filesystem::temp_directory_path() / "excursion m\u00f6del file";
    const auto first = folder / "1.json", second = folder / "2.json";
    const auto model = everything();
    writeModel(model, first);
    const auto read = readModel(first);
    writeModel(read, second);
    CHECK(readText(first) == readText(second));
    CHECK(read.name == model.name);
    CHECK(read.effectIds() == model.effectIds());
    CHECK(parameterVector(read) == parameterVector(model));
    CHECK(std::isnan(read.covariance(0, 0)));
    CHECK(read.covariance(1, 2) == -0.1);
    CHECK(read.find(catalogue().front()->id())->operatingRange.displacement == 0.0051 / 3.0);
    const auto readParameters = parametersOf(read), parameters = parametersOf(model);
    for (std::size_t k = 0; k < parameters.size(); ++k) {  // the limits of what is plausible are the model's, too
        CHECK(readParameters[k]->prior == parameters[k]->prior);
        CHECK(readParameters[k]->lower == parameters[k]->lower);
        CHECK(readParameters[k]->upper == parameters[k]->upper);
    }
    std::filesystem::remove_all(folder);
}

TEST_CASE("A model file that cannot be is refused in one sentence that names file and field", "[model]")
{
    const auto good = parsed(everything());
    CHECK(refusal(good).empty());

    const auto changed = [&good](const char* pointer, const nlohmann::json& value) {
        auto document = good;
        document[nlohmann::json::json_pointer(pointer)] = value;
        return refusal(document);
    };
    using Catch::Contains;
    CHECK_THAT(changed("/format", "excursion-ladder"),
               Contains("some.json") && Contains("'format'") && Contains("excursion-model"));
    CHECK_THAT(changed("/version", 2), Contains("'version' is 2") && Contains("expected 1"));
    CHECK_THAT(changed("/base/id", "pneumatic"), Contains("base.id") && Contains("electrodynamic or mechanical"));
    CHECK_THAT(changed("/effects/0/id", "ghosts"),
               Contains("effects[0].id") && Contains("ghosts") && Contains(catalogue().back()->id()));
    CHECK_THAT(changed("/effects/1/id", good["effects"][0]["id"]), Contains("only once"));
    CHECK_THAT(changed("/base/parameters/3/value", -0.01), Contains("base.parameters[3].value") && Contains("-0.01"));
    CHECK_THAT(changed("/base/parameters/3/value", 0.0), Contains("a mass above 0 kg"));
    CHECK_THAT(changed("/base/parameters/0/value", nullptr), Contains("a finite number"));
    CHECK_THAT(changed("/base/parameters/0/unit", "mohm"), Contains("\"ohm\""));
    CHECK_THAT(changed("/effects/0/operatingRange/displacement", 0.0), Contains("operatingRange.displacement"));
    CHECK_THAT(changed("/effects/0/operatingRange/highFrequency", 1.0), Contains("more than lowFrequency"));
    CHECK_THAT(changed("/effects/0/operatingRange/degree", 40), Contains("a whole number from 1 to "));
    CHECK_THAT(changed("/effects/0/operatingRange/degree", 6), Contains("lacks the parameter 'c6'"));
    CHECK_THAT(changed("/covariance", nlohmann::json::array({1.0})), Contains("'covariance'") && Contains("rows"));
    CHECK_THAT(changed("/path/microphoneDistance", "near"), Contains("microphoneDistance"));

    auto lacking = good;
    lacking.erase("effects");
    CHECK_THAT(refusal(lacking), Contains("'effects' is missing"));
    lacking = good;
    lacking["base"]["parameters"].erase(2);
    CHECK_THAT(refusal(lacking), Contains("base.parameters"));
    CHECK_THAT(refusal(nlohmann::json::array()), Contains("the document is []"));
}

TEST_CASE("A file from before an effect learned a shape keeps what it knew", "[model]")
{
    auto model = withEffect(makeModel("electrodynamic"), effectNamed("friction"), {});
    model = withEffect(std::move(model), effectNamed("doppler"), {});
    const auto count = parameterVector(model).size();
    model.covariance = Eigen::MatrixXd::Zero(count, count);
    for (Eigen::Index k = 0; k < count; ++k)
        model.covariance(k, k) = 1.0 + static_cast<double>(k);
    auto document = parsed(model);
    const std::size_t lacking = 3, friction = model.components[1].parameters.size(),
                      first = static_cast<std::size_t>(firstParameterOf(model, 1)) + friction - lacking;
    auto& covariance = document["covariance"];
    for (std::size_t n = 0; n < lacking; ++n) {
        document["effects"][0]["parameters"].erase(friction - lacking);
        covariance.erase(first);
    }
    for (auto& row : covariance)
        for (std::size_t n = 0; n < lacking; ++n)
            row.erase(first);
    const auto read = modelFromJson(document, "old.json");
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
        const auto at = static_cast<Eigen::Index>(k);
        CHECK(read.covariance(at, at) == (k >= first && k < first + lacking ? 0.0 : 1.0 + static_cast<double>(k)));
    }
}

TEST_CASE("A driver without a coil reads and writes, and takes no electrical effect", "[model]")
{
    auto document = parsed(makeModel("mechanical"));
    CHECK(refusal(document).empty());
    const auto full = parsed(everything());
    for (const auto& effect : full["effects"])
        if (effectNamed(effect["id"].get<std::string>()).electrical()) {
            document["effects"] = nlohmann::json::array({effect});
            CHECK_THAT(refusal(document), Catch::Contains("no coil"));
        }
}

TEST_CASE("A file that is no JSON is refused with its name", "[model]")
{
    CHECK_THROWS_WITH(readModel("/nowhere/model.json"), Catch::Contains("/nowhere/model.json"));
}
