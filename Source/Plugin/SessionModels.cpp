// SPDX-License-Identifier: GPL-3.0-or-later
// What a session does with other models than those of the ladder: those of the page Identify, and one that has drifted.
#include "Engine/Error.h"
#include "Engine/Upkeep/Adaptation.h"
#include "Plugin/Session.h"

#include <utility>

namespace excursion::plugin {

Identification Session::identification() const
{
    const std::lock_guard lock(mutex_);
    return identification_;
}

void Session::put(const Identification& models)
{
    const std::lock_guard lock(mutex_);
    if (std::exchange(identification_, models) != models)
        ++status_.models;
}

std::shared_ptr<const Findings> Session::taken() const
{
    auto now = findings();
    if (!now)
        throw Error(Error::Kind::usage, "There is nothing to identify a model of yet: open a take first.");
    return now;
}

void Session::identify(const IdentifyWish& wish)
{
    order([this, wish](const Progress& progress) {
        const auto now = taken();
        const auto linear = std::make_shared<const Identified>(identifiedOf(*now->take, wish, now->source, progress));
        put({linear, nullptr});
        say(wordsOf(*linear));
    });
}

void Session::shape(const ShapeWish& wish)
{
    {
        const std::lock_guard lock(mutex_);
        if (std::exchange(shape_, wish))
            return;
    }
    order([this](const Progress& progress) {
        ShapeWish latest;
        {
            const std::lock_guard lock(mutex_);
            if (!shape_)
                return;
            latest = *std::exchange(shape_, std::nullopt);
        }
        const auto before = identification().linear;
        if (!before)
            throw Error(Error::Kind::usage, "There is no model to shape yet: identify one first.");
        const auto linear = std::make_shared<const Identified>(shapedOf(*before, latest, progress));
        put({linear, nullptr});
        say(wordsOf(*linear));
    });
}

void Session::fitPnlss(const PnlssWish& wish)
{
    order([this, wish](const Progress& progress) {
        const auto now = taken();
        const auto linear = identification().linear;
        if (!linear)
            throw Error(Error::Kind::usage, "A PNLSS begins at a linear model: identify one first.");
        const auto fitted = std::make_shared<const FittedPnlss>(pnlssOf(*now->take, *linear, wish, progress));
        put({linear, fitted});
        say(fitted->words);
    });
}

void Session::adapt(const Model& model, std::uint64_t version)
{
    order([this, model, version](const Progress& progress) {
        const auto now = findings();
        if (!now)
            throw Error(Error::Kind::usage,
                        "There is no take to adapt the model to: record or open a short one first.");
        if (!now->report.fitForUse())
            throw Error(Error::Kind::data, now->report.verdict());
        const auto adapted = adaptTo(model, *now->take, driftingParameters(model), progress);
        const auto words = wordsOn(adapted);
        {
            const std::lock_guard lock(mutex_);
            adapted_ = Adapted {adapted.drift.model, words, version};
        }
        say(words);
    });
}

std::optional<Adapted> Session::takeAdapted()
{
    const std::lock_guard lock(mutex_);
    return std::exchange(adapted_, std::nullopt);
}

}  // namespace excursion::plugin
