// SPDX-License-Identifier: GPL-3.0-or-later
// The page Identify: what it shows is what the engine's own verbs find of the take.
#include "Engine/Error.h"
#include "Engine/Fractional/FractionalStateSpace.h"
#include "Engine/Linear/Identify.h"
#include "Engine/Linear/Response.h"
#include "Engine/Polynomial/Pnlss/PnlssFile.h"
#include "Engine/Take/TakeFile.h"
#include "Estimate/SyntheticTake.h"
#include "Plugin/Walk.h"

#include <catch2/catch.hpp>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <random>
#include <thread>

using namespace excursion;
using plugin::Editor;
using plugin::IdentifyWish;
using plugin::ModelTime;
using plugin::PageName;
using plugin::Processor;
using plugin::Reducing;
using plugin::ShapeWish;

namespace {

/// A folder with a take of a loudspeaker whose stiffness rises, at a rate that is quick to fit.
class Folder {
public:
    Folder() : path(std::filesystem::temp_directory_path() / "excursion identify take")
    {
        std::filesystem::remove_all(path);
        std::mt19937_64 random(4);
        synthetic::Loudspeaker speaker;
        speaker.oddStiffness = 0.3;
        speaker.evenStiffness = 0.1;
        synthetic::Plan plan;
        plan.sampleRate = 8000.0;
        plan.period = 2048;
        plan.realizations = 4;
        plan.levels = {0.5, 1.5};
        plan.bandHigh = 1500.0;
        plan.noiseDb = -80.0;
        plan.outputs = {Quantity::displacement, Quantity::current};
        writeMeasurement(synthetic::record(speaker, plan, random), path);
    }
    ~Folder() { std::filesystem::remove_all(path); }

    const std::filesystem::path path;
};

template <class Kind>
Kind& named(juce::Component& page, const juce::String& title)
{
    for (auto* one : plugin::all<Kind>(page))
        if (one->getTitle() == title)
            return *one;
    FAIL("no " << title);
    throw std::logic_error("unreachable");
}

juce::TextButton& button(juce::Component& page, const juce::String& text)
{
    for (auto* one : plugin::all<juce::TextButton>(page))
        if (one->getButtonText() == text)
            return *one;
    FAIL("no button " << text);
    throw std::logic_error("unreachable");
}

/// As a person does: only what is enabled can be clicked.
void click(Editor& editor, const juce::String& text)
{
    auto& one = button(editor.identify(), text);
    INFO(text);
    REQUIRE(one.isEnabled());
    one.onClick();
}

void settle(Editor& editor)
{
    editor.processor().session().wait();
    editor.update();
    INFO(editor.status());
    REQUIRE_FALSE(editor.processor().session().status().trouble);
}

std::shared_ptr<const plugin::Identified> linearOf(Editor& editor)
{
    return editor.processor().session().identification().linear;
}

/// With one pair of poles beyond the border, where a fit had none to keep them.
plugin::Identification unstable()
{
    auto found = plugin::identifiedForPictures(ModelTime::continuous);
    auto one = *found.linear;
    StateSpace model;
    model.A = Eigen::MatrixXd {{-50.0, 300.0, 0.0}, {-300.0, -50.0, 0.0}, {0.0, 0.0, 900.0}};
    model.B = Eigen::MatrixXd {{1.0}, {0.0}, {1.0}};
    model.C = Eigen::MatrixXd {{400.0, 0.0, 70.0}};
    model.D = Eigen::MatrixXd {{3.0}};
    one.base = one.model = model;
    one.alpha = 1.0;
    Frf own = frfOf(model, one.data.frequency);
    one.response.frf = own;
    one.data = frequencyDataOf(own);
    one.stable = false;
    return {std::make_shared<const plugin::Identified>(one), nullptr};
}

}  // namespace

TEST_CASE("The page Identify finds what the engine finds, prunes it while it is looked at, and takes that back",
          "[plugin][identify]")
{
    const Folder folder;
    Processor processor;
    Editor editor(processor);
    editor.go(PageName::identify);
    editor.update();
    CHECK_FALSE(button(editor.identify(), "Identify").isEnabled());
    editor.load(juce::File(folder.path.string()));
    editor.go(PageName::identify);
    settle(editor);
    IdentifyWish wish;
    wish.ports.output = "displacement";
    wish.ports.level = 0;
    wish.order = 6;
    editor.identify().choose(wish);
    CHECK(editor.identify().wish().ports.output == "displacement");
    click(editor, "Identify");
    settle(editor);
    const auto six = linearOf(editor);
    REQUIRE(six);
    IdentifyOptions options;
    options.order = 6;
    const auto take = processor.session().findings()->take;
    const auto direct = identify(frequencyDataOf(responseOf(*take, {"displacement", "", 0}).frf), options);
    CHECK(six->errorDb == Approx(direct.errorDb).margin(0.5));
    CHECK(six->stable);
    CHECK(plugin::all<plugin::PlotView>(editor.identify()).size() == 4);
    for (auto* plot : plugin::all<plugin::PlotView>(editor.identify()))
        if (plot->plot().title == "Gain")
            CHECK(plot->plot().series.back().y.size() == six->shown.frequency.size());

    // The loudspeaker itself is of order 3.
    auto& reducing = named<juce::ComboBox>(editor.identify(), "Reduce");
    auto& dial = named<plugin::Dial>(editor.identify(), "Reduced to order");
    CHECK_FALSE(dial.isEnabled());
    reducing.setSelectedItemIndex(static_cast<int>(Reducing::pruned), juce::sendNotificationSync);
    settle(editor);
    REQUIRE(dial.isEnabled());
    for (const int order : {5, 4, 3}) {
        dial.setValue(order, juce::sendNotificationSync);
        settle(editor);
        CHECK(linearOf(editor)->model.order() <= order + 1);
    }
    CHECK(linearOf(editor)->base.order() == 6);
    const auto three = linearOf(editor);
    REQUIRE(three->model.order() <= 4);
    CHECK(three->errorDb < -40.0);
    CHECK(editor.history().canUndo());
    for (const auto kind : {Reducing::balanced, Reducing::polesAndZeros}) {
        reducing.setSelectedItemIndex(static_cast<int>(kind), juce::sendNotificationSync);
        settle(editor);
        CHECK(linearOf(editor)->model.order() <= 4);
        CHECK(linearOf(editor)->stable);
    }
    editor.undo();
    editor.undo();
    CHECK(linearOf(editor) == three);
    CHECK(reducing.getSelectedItemIndex() == static_cast<int>(Reducing::pruned));
    CHECK(dial.getValue() == 3.0);
    editor.redo();
    CHECK(linearOf(editor) != three);
    // Another take begins anew.
    processor.session().open(folder.path.string());
    settle(editor);
    CHECK_FALSE(linearOf(editor));
}

TEST_CASE("Fractional order is found, and an unstable model is made stable in four ways", "[plugin][identify]")
{
    Processor processor;
    Editor editor(processor);
    editor.go(PageName::identify);
    {
        FractionalStateSpace truth;
        truth.alpha = 0.7;
        truth.form.A = Eigen::MatrixXd {{-20.0, 90.0}, {-90.0, -20.0}};
        truth.form.B = Eigen::MatrixXd {{30.0}, {10.0}};
        truth.form.C = Eigen::MatrixXd {{1.0, 2.0}};
        truth.form.D = Eigen::MatrixXd {{3.0}};
        Spectra spectra;
        Spectra::Channel voltage {Quantity::voltage, "V", {}}, current {Quantity::current, "A", {}};
        for (double f = 5.0; f < 5000.0; f *= 1.05)
            spectra.frequency.push_back(f);
        for (const auto& value : respond(truth, spectra.frequency)) {
            voltage.values.push_back(value(0, 0));
            current.values.emplace_back(1.0);
        }
        spectra.channels = {voltage, current};
        IdentifyWish free;
        free.order = 2;
        free.time = ModelTime::fractionalFree;
        const auto found = plugin::identifiedOf(PreparedTake(spectra), free, "a fractional one");
        CHECK(found.alpha == Approx(0.7).margin(1e-3));
        CHECK(found.errorDb < -80.0);
    }
    processor.session().put(plugin::identifiedForPictures(ModelTime::fractional));
    editor.update();
    CHECK(linearOf(editor)->alpha == 0.7);
    CHECK(linearOf(editor)->stable);
    bool border = false;
    for (auto* plot : plugin::all<plugin::PlotView>(editor.identify()))
        for (const auto& series : plot->plot().series)
            if (series.title == "border of stability") {
                border = true;
                CHECK(series.y.front() == Approx(63.0));  // alpha pi/2
            }
    CHECK(border);

    processor.session().put(unstable());
    editor.update();
    auto& list = named<juce::ComboBox>(editor.identify(), "Stabilize");
    REQUIRE(list.isEnabled());
    for (int k = 1; k < list.getNumItems(); ++k) {
        list.setSelectedItemIndex(k, juce::sendNotificationSync);
        settle(editor);
        INFO(list.getText());
        CHECK(linearOf(editor)->stable);
        CHECK(linearOf(editor)->shape.stabilizing.has_value());
    }
    // What cannot be done is told, and changes nothing.
    list.setSelectedItemIndex(0, juce::sendNotificationSync);
    settle(editor);
    const auto before = linearOf(editor);
    named<juce::ComboBox>(editor.identify(), "Reduce").setSelectedItemIndex(1, juce::sendNotificationSync);
    processor.session().wait();
    editor.update();
    CHECK(processor.session().status().trouble);
    CHECK(editor.status().contains("stable"));
    CHECK(linearOf(editor) == before);
    // The lists name what is shown.
    CHECK(named<juce::ComboBox>(editor.identify(), "Reduce").getSelectedItemIndex() == 0);
    CHECK(editor.identify().shapeWish().reducing == before->shape.reducing);
}

TEST_CASE("A PNLSS begins at the linear model, is cancelled, is fitted, and goes to the last page",
          "[plugin][identify]")
{
    const Folder folder;
    Processor processor;
    Editor editor(processor);
    editor.load(juce::File(folder.path.string()));
    editor.go(PageName::identify);
    settle(editor);
    IdentifyWish wish;
    wish.ports = {"displacement", "", 1};
    wish.order = 3;
    wish.time = ModelTime::discrete;
    editor.identify().choose(wish);
    CHECK_FALSE(button(editor.identify(), "Fit a PNLSS").isEnabled());
    click(editor, "Identify");
    settle(editor);
    const auto linear = linearOf(editor);
    CHECK_FALSE(button(editor.identify(), "Linearize with it").isEnabled());
    click(editor, "Fit a PNLSS");
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    editor.update();
    CHECK_FALSE(button(editor.identify(), "Identify").isEnabled());
    processor.session().cancel();
    processor.session().wait();
    editor.update();
    CHECK(processor.session().status().words == "Cancelled.");
    CHECK(processor.session().identification() == plugin::Identification {linear, nullptr});
    click(editor, "Fit a PNLSS");
    settle(editor);
    const auto pnlss = processor.session().identification().pnlss;
    REQUIRE(pnlss);
    INFO(pnlss->words);
    REQUIRE(pnlss->validationDb);
    CHECK(*pnlss->validationDb < pnlss->startDb - 20.0);
    CHECK(pnlss->stable);
    CHECK(pnlss->history.size() > 1);
    CHECK(editor.status().contains("PNLSS"));
    click(editor, "Linearize with it");
    CHECK(editor.page(PageName::linearize).isVisible());
    processor.rehearsing().wait();
    editor.update();
    INFO(editor.status());
    CHECK_FALSE(processor.rehearsing().status().trouble);
    REQUIRE(processor.box());
    CHECK(processor.box()->document == pnlss->document);
    REQUIRE(processor.box()->played.rehearsal);
    CHECK(processor.box()->played.rehearsal->gainDb() > 15.0);
    CHECK(processor.parameters().settings().mode == Mode::linearize);  // what the button says
    editor.undo();
    CHECK(processor.parameters().settings().mode == Mode::bypass);
    CHECK(processor.box());
    editor.undo();  // the driver again
    CHECK_FALSE(processor.box());
    editor.undo();  // without the polynomial model
    CHECK(processor.session().identification() == plugin::Identification {linear, nullptr});
}

TEST_CASE("Without a take nothing is identified, and a sentence says so", "[plugin][identify]")
{
    Processor processor;
    auto& session = processor.session();
    const auto refused = [&] {
        session.wait();
        CHECK(session.status().trouble);
        return juce::String(session.status().words);
    };
    session.identify({});
    CHECK(refused().contains("open a take"));
    session.shape({});
    CHECK(refused().contains("identify one first"));
    session.fitPnlss({});
    CHECK(refused().contains("open a take"));
    // An impedance has neither a rate nor time.
    const auto found = plugin::identifiedForPictures(ModelTime::continuous);
    Spectra spectra;
    spectra.frequency = {10.0, 20.0, 40.0, 80.0};
    spectra.channels = {{Quantity::voltage, "V", {4.0, 5.0, 6.0, 7.0}}, {Quantity::current, "A", {1.0, 1.0, 1.0, 1.0}}};
    IdentifyWish discrete;
    discrete.time = ModelTime::discrete;
    CHECK_THROWS_AS(plugin::identifiedOf(PreparedTake(spectra), discrete, ""), Error);
    CHECK_THROWS_AS(plugin::pnlssOf(PreparedTake(spectra), *found.linear, {}), Error);
}
