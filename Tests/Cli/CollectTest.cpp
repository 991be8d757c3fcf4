// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Chain.h"

using namespace excursion::test;

namespace {

using Json = nlohmann::json;

/// Six ladders: that of the chain's take, each with another stiffness at rest, the fourth far off.
class Batch {
public:
    static const Batch& get()
    {
        static const Batch batch;
        return batch;
    }
    const std::filesystem::path& folder() const { return scratch_.folder(); }
    std::string ladders() const { return (scratch_ / "ladders").string(); }

private:
    Batch()
    {
        const auto first = (scratch_ / "first").string();
        const auto told = runProgram(folder(), {"improve", Chain::get().take(), "--out", first, "--quiet"});
        INFO(told.err);
        REQUIRE(told.code == 0);
        const auto ladder = Json::parse(bytesOf(first + "/ladder.json"));
        const double factors[] = {1.0, 1.004, 0.998, 1.3, 1.002, 0.996};
        for (int k = 0; k < 6; ++k) {
            auto other = ladder;
            other["rungs"].back()["model"]["base"]["parameters"][5]["value"] =
                factors[k] * ladder["rungs"].back()["model"]["base"]["parameters"][5]["value"].get<double>();
            const auto place = scratch_ / ("ladders/unit-" + std::to_string(k + 8)) / "ladder.json";
            std::filesystem::create_directories(place.parent_path());
            std::ofstream(place) << other.dump();
        }
    }

    Scratch scratch_;
};

}  // namespace

TEST_CASE("collect puts the ladders of a batch in one table", "[cli]")
{
    const auto& batch = Batch::get();
    const Scratch scratch;
    const auto csv = (scratch / "units.csv").string(), json = (scratch / "units.json").string();
    const auto limits = scratch.file("limits.json", R"({"fs": {"min": 1, "max": 5000}, "Qts": {"max": 50}})").string();
    const auto told = runProgram(
        scratch.folder(), {"collect", batch.ladders(), "--limits", limits, "--out", csv, "--out", json, "--json"});
    INFO(told.err);
    REQUIRE(told.code == 0);
    const auto document = documentOf(told, "excursion-collection");
    REQUIRE(document.at("units").size() == 6);
    CHECK(document.at("units")[0].at("name") == "unit-8");
    CHECK(document.at("units")[5].at("name") == "unit-13");
    CHECK(document.at("passed") == 6);
    CHECK(document.at("units")[3].at("outlier") == true);
    CHECK(document.at("units")[2].at("outlier") == false);
    CHECK(document.at("golden").is_string());
    CHECK(Json::parse(bytesOf(json)) == document);
    CHECK_THAT(bytesOf(csv), Catch::StartsWith("unit,verdict,"));

    // The answer is no: 1, or 0 for a script that stops at failures.
    const auto tight = scratch.file("tight.json", R"({"fs": {"max": 1}})").string();
    CHECK(runProgram(scratch.folder(), {"collect", batch.ladders(), "--limits", tight, "--quiet"}).code == 1);
    CHECK(runProgram(scratch.folder(), {"--exit-zero", "collect", batch.ladders(), "--limits", tight, "--quiet"}).code
          == 0);
    CHECK(runProgram(scratch.folder(), {"collect", batch.ladders(), "--limits", tight, "--quiet", "--exit-zero"}).code
          == 0);
    // A failure stays one.
    CHECK(runProgram(scratch.folder(), {"--exit-zero", "collect", (scratch / "none").string()}).code == 3);

    // parameters takes a ladder's folder and its document.
    const auto ladder = batch.ladders() + "/unit-8";
    const auto a = runProgram(scratch.folder(), {"parameters", ladder, "--json"}),
               b = runProgram(scratch.folder(), {"parameters", ladder + "/ladder.json", "--json"});
    REQUIRE(a.code == 0);
    CHECK(Json::parse(a.out).at("thieleSmall") == Json::parse(b.out).at("thieleSmall"));
    for (const auto& f : Json::parse(a.out).at("thieleSmall"))
        for (const auto& q : document.at("quantities"))
            if (q.at("name") == f.at("symbol"))
                CHECK(q.at("values")[0] == f.at("sheetValue"));
}

TEST_CASE("collect refuses what is no batch", "[cli]")
{
    const auto& batch = Batch::get();
    const Scratch scratch;
    const auto limits = scratch.file("limits.json", R"({"Fs": {"min": 1}})").string(),
               broken = scratch.file("broken.json", R"({"fs": {"min": )").string();
    refusedWith(3, {"collect", (scratch / "none").string()}, scratch, "none");
    refusedWith(3, {"collect", scratch.folder().string()}, scratch, "holds no ladder.json");
    refusedWith(2, {"collect"}, scratch, "DIR");
    refusedWith(2, {"collect", batch.ladders(), "--limits", limits}, scratch, "\"Fs\"");
    refusedWith(3, {"collect", batch.ladders(), "--limits", broken}, scratch, "broken.json");
    refusedWith(2, {"collect", batch.ladders(), "--out", (scratch / "units.xls").string()}, scratch,
                ".csv, .html or .json");
    refusedWith(2, {"collect", batch.ladders(), "--at", "-0.001"}, scratch, "positive");
    refusedWith(3, {"collect", batch.ladders(), batch.ladders() + "/unit-8"}, scratch, "Two units");
}
