// SPDX-License-Identifier: GPL-3.0-or-later
// All classes of models side by side on drivers that another program simulates, and what a model without physics is
// told to have found.
#include "Bench/Draw.h"
#include "Engine/Error.h"
#include "Engine/Estimate/Bla.h"
#include "Engine/Linear/Identify.h"
#include "Engine/Polynomial/Pnlss/PnlssFit.h"
#include "Engine/Polynomial/TakeRecords.h"
#include "Engine/Ranking/Agreement.h"
#include "Engine/Ranking/Rank.h"
#include "Linear/Problem.h"

#include <catch2/catch.hpp>

#include <algorithm>

using namespace excursion;
using excursion::test::Normal;

namespace {

Measurement takeOf(std::uint64_t seed, const char* hidden, const std::vector<Quantity>& channels)
{
    bench::DrawOptions options;
    options.driver = "seed";
    if (*hidden)
        options.hidden = std::vector<bench::HiddenEffect> {{hidden, 0.3}};
    else
        options.hidden = std::vector<bench::HiddenEffect> {};
    options.noiseDb = -70.0;
    options.sampleRate = 48000.0;
    options.channels = channels;
    options.seconds = 2.0;
    const auto drawn = bench::draw(seed, options);
    return bench::measure(drawn.speaker, drawn.setup);
}

const RankedModel& named(const Ranking& ranking, const std::string& name)
{
    return *std::find_if(ranking.models.begin(), ranking.models.end(),
                         [&](const RankedModel& m) { return m.name == name; });
}

}  // namespace

TEST_CASE("Classes of models are ranked by what they leave of records that they have not seen", "[slow]")
{
    const auto take = takeOf(11, "stiffness", {Quantity::voltage, Quantity::current, Quantity::displacement});
    RankOptions options;
    options.output = Quantity::displacement;
    options.classes = {"linear", "hammerstein", "block", "narx", "pnlss", "driver", "driver-with-effects"};
    const auto ranking = rank(take, options);
    REQUIRE(ranking.models.size() == 7);
    for (const auto& model : ranking.models) {
        CAPTURE(model.name, model.trouble, model.description, model.estimationDb, model.validationDb, model.parameters);
        CHECK(model.trouble.empty());
        CHECK((model.stable || model.name == "narx"));  // whose linear part may be unstable, and is told so
        CHECK(model.load > 0.0);
        CHECK(model.load < 1.0);
        CHECK(model.fitSeconds > 0.0);
    }
    CHECK(std::is_sorted(ranking.models.begin(), ranking.models.end(),
                         [](const auto& a, const auto& b) { return a.validationDb < b.validationDb; }));
    REQUIRE(ranking.noiseDb);
    // Two classes can be right, and are to within the noise; what has no feedback, or no effects, is not.
    CHECK(named(ranking, "driver-with-effects").validationDb < *ranking.noiseDb + 3.0);
    CHECK(named(ranking, "driver-with-effects").description == "Stiffness K(x)");
    CHECK(named(ranking, "pnlss").validationDb < *ranking.noiseDb + 6.0);
    CHECK(named(ranking, "linear").validationDb > *ranking.noiseDb + 20.0);
    CHECK(named(ranking, "driver").validationDb > *ranking.noiseDb + 20.0);
    CHECK(named(ranking, "hammerstein").validationDb > *ranking.noiseDb + 15.0);
    CHECK(named(ranking, "block").validationDb < named(ranking, "linear").validationDb - 6.0);
    CHECK(ranking.sentence.find("driver-with-effects") != std::string::npos);

    // The two that are right take most distortion away, the driver more than what knows no physics; what is linear, or
    // explains too little, takes none, and says so.
    for (const auto& model : ranking.models) {
        const auto& told = model.predistortion;
        CAPTURE(model.name, told.trouble, told.beforeDb, told.modelDb, told.leftDb, told.load, told.latency);
        if (!told.trouble.empty())
            continue;
        CHECK(told.gainDb() >= 3.0);
        CHECK(told.leftDb >= told.modelDb - 1e-9);
        CHECK(told.load > 0.0);
        CHECK(told.load < 0.5);
        CHECK(told.latency > 0.0);
        CHECK(told.latency < 0.01);
    }
    CHECK(named(ranking, "driver-with-effects").predistortion.gainDb() > 40.0);
    CHECK(named(ranking, "pnlss").predistortion.gainDb() > 25.0);
    CHECK(named(ranking, "linear").predistortion.trouble == "It is linear: there is nothing to correct.");
    CHECK_FALSE(named(ranking, "driver").predistortion.trouble.empty());
    CHECK(ranking.straightest == "driver-with-effects");
    CHECK(ranking.straightSentence.find("\"driver-with-effects\" linearizes best") == 0);
}

TEST_CASE("The class that explains most is a stable one, be there a better one that is not")
{
    const auto ranked = [](const char* name, double errorDb, int parameters, bool stable) {
        RankedModel model;
        model.name = name;
        model.validationDb = errorDb;
        model.parameters = parameters;
        model.stable = stable;
        return model;
    };
    std::vector<RankedModel> models {ranked("narx", -60.0, 10, false), ranked("pnlss", -50.0, 80, true),
                                     ranked("block", -49.8, 20, true), ranked("linear", -20.0, 7, true)};
    REQUIRE(explainingMost(models));
    CHECK(explainingMost(models)->name == "block");
    models[1].trouble = models[2].trouble = "It was not fitted.";
    CHECK(explainingMost(models)->name == "linear");
    models[3].stable = false;
    CHECK_FALSE(explainingMost(models));
    CHECK_FALSE(explainingMost({}));
}

TEST_CASE(
    "A polynomial model of a record without periods comes to its noise in a ranking, whatever the sensor's offset")
{
    // A resonance with a hardening spring, amid a swing, and heard with noise 60 dB below and an offset
    Measurement take;
    take.sampleRate = 1000.0;
    Channel voltage, displacement;
    displacement.quantity = Quantity::displacement;
    displacement.unit = "m";
    Normal normal(11);
    double x = 0.0, v = 1.0;
    for (int t = 0; t < 1800; ++t) {
        const double u = normal();
        voltage.samples.push_back(u);
        displacement.samples.push_back(x + 0.3 + 6e-4 * normal());
        const double next = x + 0.3 * v;
        v = 0.8 * v - 0.3 * x - 0.05 * x * x * x + 0.2 * u;
        x = next;
    }
    voltage.fullScale = displacement.fullScale = 100.0;
    take.channels = {voltage, displacement};
    RankOptions options;
    options.classes = {"linear", "pnlss"};
    options.order = 2;
    const auto ranking = rank(take, options);
    REQUIRE(ranking.models.size() == 2);
    const auto& model = named(ranking, "pnlss");
    CAPTURE(model.trouble, model.description, model.estimationDb, model.validationDb);
    CHECK(model.trouble.empty());
    CHECK(model.validationDb < -50.0);
    CHECK(ranking.best == "pnlss");
}

TEST_CASE("A Hammerstein model rings as long as a woofer at 48 kHz", "[slow]")
{
    const auto take = takeOf(12, "", {Quantity::voltage, Quantity::displacement});
    RankOptions options;
    options.classes = {"linear", "hammerstein"};
    const auto ranking = rank(take, options);
    const auto& model = named(ranking, "hammerstein");
    CAPTURE(model.description, model.validationDb, model.fitSeconds, *ranking.noiseDb);
    CHECK(model.validationDb < -40.0);
    CHECK(model.fitSeconds < 120.0);
}

TEST_CASE("A ranking of what cannot be ranked is refused, and a class that does not fit the take is told so")
{
    const auto take = takeOf(12, "", {Quantity::voltage, Quantity::displacement});
    RankOptions options;
    options.classes = {"linear", "fractional"};
    const auto ranking = rank(take, options);
    REQUIRE(ranking.models.size() == 2);
    CHECK(ranking.models.front().name == "linear");
    CHECK(ranking.models.front().validationDb < *ranking.noiseDb + 3.0);  // nothing is hidden
    CHECK(ranking.models.back().trouble == "The class is one of a current under a voltage.");
    CHECK(ranking.straightest.empty());
    CHECK(ranking.straightSentence == "No class of models linearizes this take.");
    options.classes = {"oracle"};
    CHECK_THROWS_AS(rank(take, options), Error);
    options = {};
    options.output = Quantity::pressure;
    CHECK_THROWS_AS(rank(take, options), Error);
    options = {};
    options.level = 9;
    CHECK_THROWS_AS(rank(take, options), Error);
    for (const auto& known : modelClasses())
        CHECK_FALSE(known.sentence.empty());
}

TEST_CASE("What a polynomial model has found without physics is told as the law that was hidden", "[slow]")
{
    const char* hidden = "force-factor";
    const auto output = Quantity::current;
    const auto take = takeOf(21, hidden, {Quantity::voltage, output});
    const auto records = recordsOf(take, take.input(), *take.find(output));
    IdentifyOptions identifying;
    identifying.order = 3;
    identifying.sampleRate = take.sampleRate;
    PnlssFitOptions fitting;
    fitting.maximumIterations = 25;
    const auto linear = identify(frequencyDataOf(bla(take, output, 2).frf), identifying).model;
    const auto fit = fitPnlss(withTerms(linear, 3), records.estimation, records.validation, fitting);
    const auto found = agreement(take, output, [&](const Eigen::MatrixXd& u) { return simulate(fit.model, u); });
    CAPTURE(fit.validationDb, found.sentence, found.baseDb, found.leftDb);
    REQUIRE_FALSE(found.effects.empty());
    CHECK(found.effects.front() == hidden);
    CHECK(found.leftDb < found.baseDb - 15.0);

    const auto other = takeOf(22, "", {Quantity::voltage, Quantity::displacement});
    CHECK_THROWS_AS(
        agreement(other, Quantity::displacement, [](const Eigen::MatrixXd& u) -> Eigen::MatrixXd { return u / 0.0; }),
        Error);
    CHECK_THROWS_AS(agreement(other, Quantity::pressure, [](const Eigen::MatrixXd& u) { return u; }), Error);
}
