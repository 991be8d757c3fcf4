// SPDX-License-Identifier: GPL-3.0-or-later
#include "Diagnosis/DuffingTake.h"
#include "Diagnosis/SyntheticLadder.h"

#include "Engine/Diagnosis/DiagnosisFile.h"
#include "Engine/Document/JsonText.h"
#include "Engine/Error.h"

#include <catch2/catch.hpp>

using namespace excursion;

TEST_CASE("A ladder saved, read and saved again is the same, byte for byte", "[files]")
{
    const auto first = jsonText(toJson(test::syntheticLadder()));
    const auto read = ladderFromJson(nlohmann::json::parse(first), "ladder.json");
    CHECK(jsonText(toJson(read)) == first);
    CHECK(read.ladder.rungs.size() == 4);
    CHECK(read.ladder.rungs[2].model.effectIds().size() == 2);
}

TEST_CASE("A ladder's responses are those of the periods, also where the take does not tell its excitation", "[files]")
{
    const auto told = test::duffingTake(0.1, -60.0, 3);
    auto untold = told;
    untold.excitation.reset();
    const auto with = makeLadderFile(test::syntheticLadder().ladder, told, "take"),
               without = makeLadderFile(test::syntheticLadder().ladder, untold, "take");
    CHECK(without.take.levels.size() == with.take.levels.size());
    CHECK(without.take.periods > 0);
    REQUIRE(without.responses.size() == with.responses.size());
    for (std::size_t c = 0; c < with.responses.size(); ++c) {
        REQUIRE(without.responses[c].frequency.size() == with.responses[c].frequency.size());
        for (std::size_t k = 0; k < with.responses[c].value.size(); ++k)
            CHECK(std::abs(without.responses[c].value[k] - with.responses[c].value[k])
                  < 1e-2 * std::abs(with.responses[c].value[k]));
    }
}

TEST_CASE("A diagnosis has the fields that scripts read", "[files]")
{
    auto diagnosis = test::syntheticLadder().ladder.rungs[1].diagnosis;
    diagnosis.problems = {
        {"channel-delay", Quantity::current, 3.4, "samples", true, "The current is late by 3.4 samples."},
        {"dropout", std::nullopt, 2.0, "1", false, "Samples are missing."}};
    diagnosis.error[Quantity::current].noiseFloorDb.reset();
    const auto document = toJson(diagnosis);
    CHECK(document["format"] == "excursion-diagnosis");
    CHECK(document["version"] == 1);
    CHECK(document["verdict"] == "missing-effect");
    CHECK(document["error"]["current"]["db"].is_number());
    CHECK(document["error"]["current"]["noiseFloorDb"].is_null());
    CHECK(document["ranking"][0]["effect"] == diagnosis.ranking.front().effect);
    CHECK(document["ranking"][0]["predictedErrorDb"]["current"].is_number());
    CHECK(document["ranking"][0]["confirmedErrorDb"]["current"].is_number());
    CHECK(document["ranking"].back()["confirmedErrorDb"].is_null());
    CHECK(document["problems"][0]["channel"] == "current");
    CHECK(document["problems"][0]["value"] == 3.4);
    CHECK(document["problems"][1]["channel"].is_null());
    CHECK(document["indistinguishable"].size() == 1);
    const nlohmann::json plain = document;
    CHECK(jsonText(toJson(diagnosisFromJson({plain, "", "d.json"}))) == jsonText(document));
}

TEST_CASE("A ladder of the version before, whose fields had other names, is read", "[files]")
{
    const auto text = jsonText(toJson(test::syntheticLadder()));
    auto before = text;
    const auto replace = [&before](const std::string& name, const std::string& by) {
        std::size_t count = 0;
        for (auto at = before.find(name); at != std::string::npos; at = before.find(name, at + by.size()), ++count)
            before.replace(at, name.size(), by);
        CHECK(count > 0);
    };
    replace("\"predictedChiSquaredPerValue\"", "\"predictedChi\"");
    replace("\"confirmedChiSquaredPerValue\"", "\"confirmedChi\"");
    replace("\"operatingRange\"", "\"extent\"");
    // of a fit, which has the member behind its substeps, and of an error
    for (auto at = before.find("\"substeps\""); at != std::string::npos; at = before.find("\"substeps\"", at + 1)) {
        const std::string name = "\"chiSquaredPerValue\"";
        before.replace(before.find(name, at), name.size(), "\"costPerResidual\"");
    }
    replace("\"chiSquaredPerValue\"", "\"chi\"");
    CHECK(jsonText(toJson(ladderFromJson(nlohmann::json::parse(before), "before.json"))) == text);
}

TEST_CASE("Numbers that are not finite are written as null", "[files]")
{
    Comparison comparison;
    comparison.chiSquaredPerValue = std::numeric_limits<double>::quiet_NaN();
    comparison.levels = {std::numeric_limits<double>::infinity()};
    ChannelComparison channel;
    channel.total.db = -std::numeric_limits<double>::infinity();
    comparison.channels = {channel};
    const auto text = jsonText(toJson(comparison));
    CHECK(text.find("nan") == std::string::npos);
    CHECK(text.find("inf") == std::string::npos);
    CHECK(toJson(comparison)["error"]["current"]["db"].is_null());
}

TEST_CASE("A ladder that cannot be is refused with file and field", "[files]")
{
    const auto good = nlohmann::json::parse(jsonText(toJson(test::syntheticLadder())));
    const auto refusal = [&good](const char* pointer, const nlohmann::json& value) -> std::string {
        auto document = good;
        document[nlohmann::json::json_pointer(pointer)] = value;
        try {
            ladderFromJson(document, "ladder.json");
            return {};
        } catch (const Error& e) {
            return e.what();
        }
    };
    using Catch::Contains;
    CHECK_THAT(refusal("/verdict", "perhaps"),
               Contains("ladder.json") && Contains("'verdict'") && Contains("missing-effect"));
    CHECK_THAT(refusal("/rungs/1/model/version", 7), Contains("rungs[1].model.version"));
    CHECK_THAT(refusal("/rungs/0/comparison/channels/0/levels/0/spectrum/model", nlohmann::json::array({1.0})),
               Contains("as many numbers"));
    CHECK_THAT(refusal("/rungs/0/comparison/channels/0/quantity", "taste"), Contains("quantity"));
    CHECK_THAT(refusal("/responses/0/re", nlohmann::json::array()), Contains("responses[0].re"));
}

TEST_CASE("Beside a rest that jumps nothing is complete", "[diagnosis]")
{
    const std::vector<Problem> jump {{"rest-jump", Quantity::displacement, 1e-3, "m", false, "It jumps by 1 mm."}},
        hum {{"hum", Quantity::current, -50.0, "dB", false, "It hums."}};
    Diagnosis diagnosis;
    diagnosis.verdict = Verdict::complete;
    diagnosis.sentence = "The model is complete.";
    tell(diagnosis, hum);
    CHECK(diagnosis.verdict == Verdict::complete);
    CHECK(diagnosis.problems.size() == 1);
    tell(diagnosis, jump);
    CHECK(diagnosis.verdict == Verdict::unknownEffect);
    CHECK(diagnosis.sentence.find("It jumps by 1 mm.") != std::string::npos);
    diagnosis.verdict = Verdict::missingEffect;
    diagnosis.sentence = "Friction is missing.";
    tell(diagnosis, jump);
    CHECK(diagnosis.verdict == Verdict::missingEffect);
    CHECK(diagnosis.sentence == "Friction is missing.");
}
