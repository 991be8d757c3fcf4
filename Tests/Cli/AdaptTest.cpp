// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Chain.h"

#include <fstream>
#include <map>

using namespace excursion::test;

namespace {

/// The chain's model with parameters of its base changed, as if the driver had been that when it was fitted.
std::string changed(const Scratch& scratch, const std::map<std::string, double>& factors)
{
    auto model = nlohmann::json::parse(bytesOf(Chain::get().model()));
    for (auto& parameter : model["base"]["parameters"])
        if (const auto found = factors.find(parameter["name"]); found != factors.end())
            parameter["value"] = parameter["value"].get<double>() * found->second;
    const auto file = (scratch / "old.json").string();
    std::ofstream(file) << model.dump(2);
    return file;
}

}  // namespace

TEST_CASE("adapt finds what has drifted, tells it, and leaves the rest", "[cli][adapt]")
{
    const auto& chain = Chain::get();
    const Scratch scratch;
    const auto old = changed(scratch, {{"Re", 0.9}, {"K", 1.25}}), out = (scratch / "new.json").string();
    const auto told = runProgram(scratch.folder(), {"adapt", old, chain.take(), "--out", out, "--json"});
    INFO(told.out << told.err);
    REQUIRE(told.code == 0);
    const auto document = documentOf(told, "excursion-adapt");
    REQUIRE(document.at("drift").size() == 3);
    for (const auto& one : document.at("drift")) {
        const auto name = one.at("name").get<std::string>();
        const double ratio = one.at("after").get<double>() / one.at("before").get<double>(),
                     truth = name == "Re"  ? 1.0 / 0.9
                             : name == "K" ? 0.8
                                           : 1.0;
        INFO(name);
        // The model is linear, and what bends the driver is another one for other parameters.
        CHECK(ratio == Approx(truth).epsilon(0.02));
        CHECK(one.at("afterError").get<double>() > 0.0);
    }
    CHECK(document.at("warmer").get<double>() == Approx((1.0 / 0.9 - 1.0) / 0.0039).epsilon(0.05));
    CHECK(document.at("figures").at(0).at("name") == "f0");
    CHECK(document.at("errorBefore").at("current").at("db").get<double>()
          > document.at("error").at("current").at("db").get<double>() + 3.0);
    // What was held is as it was.
    const auto before = nlohmann::json::parse(bytesOf(old)), after = nlohmann::json::parse(bytesOf(out));
    for (std::size_t k = 0; k < before["base"]["parameters"].size(); ++k) {
        const auto &was = before["base"]["parameters"][k], &is = after["base"]["parameters"][k];
        if (const auto name = was["name"].get<std::string>(); name != "Re" && name != "K" && name != "Rms")
            CHECK(was == is);
    }
    const auto said = runProgram(scratch.folder(), {"adapt", old, chain.take(), "--out", out});
    for (const auto* text :
         {"parameter", "was", "std error", "K warmer than it was", "f0", "\u03c7\u00b2/value before", "Wrote "})
        CHECK_THAT(said.out, Catch::Contains(text));
    const auto one = runProgram(scratch.folder(),
                                {"adapt", old, chain.take(), "--parameters", "K", "--out", out, "--json"});
    CHECK(documentOf(one, "excursion-adapt").at("drift").size() == 1);
    CHECK(documentOf(one, "excursion-adapt").at("warmer").is_null());
}

TEST_CASE("adapt refuses what it cannot follow", "[cli][adapt][bad-input]")
{
    const auto& chain = Chain::get();
    const Scratch scratch;
    const auto out = (scratch / "new.json").string(), model = chain.model();
    refusedWith(2, {"adapt", model, chain.take()}, scratch, "--out");
    refusedWith(2, {"adapt", model, chain.take(), "--parameters", "Mms", "--out", out}, scratch, "Mms");
    refusedWith(3, {"adapt", (scratch / "absent.json").string(), chain.take(), "--out", out}, scratch, "absent.json");
    refusedWith(3, {"adapt", model, (scratch / "absent").string(), "--out", out}, scratch, "absent");
}
