// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Score.h"
#include "Engine/Diagnosis/Vote.h"
#include "Engine/Loudspeaker/Fit.h"
#include "Engine/Loudspeaker/LinearResponses.h"
#include "Engine/Loudspeaker/OutputError.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace excursion {

/// dB that are left more: an effect that costs no more than that is not needed.
inline constexpr double hardlyNeeded = 0.2;

/// What a model leaves of a record; no channels where a law's memory runs away.
struct Left {
    struct Channel {
        double chiSquaredPerValue = 0.0;  ///< mean squared residual in units of the noise
        double power = 0.0;  ///< of the error over that of the noise; infinite where the noise is not known

        bool isNoise() const { return power <= ErrorPower::most; }
    };
    double chiSquaredPerValue = std::numeric_limits<double>::infinity();  ///< of all channels
    double cost = std::numeric_limits<double>::infinity();
    std::vector<Channel> channels;

    bool areNoise() const
    {
        return !channels.empty()
               && std::all_of(channels.begin(), channels.end(), [](const Channel& c) { return c.isNoise(); });
    }
    bool isNoise() const { return areNoise() && chiSquaredPerValue < atNoise; }
};

/// An effect that a model has, and what the model is without it.
struct Removal {
    Vote vote;
    Model leaner;  ///< fitted again without the effect; no components where that was not tried
    /// by which the mean squared residual grows without it; as if beyond measure where not tried
    double times = std::numeric_limits<double>::infinity();
    bool staysNoise = false;  ///< every channel's error without it
    bool plausible = true;    ///< as it stands in the model; else it stands for something else
    bool suspect = false;     ///< see mayStandIn()
};

/// Where a round of a search has ended.
struct Waypoint {
    std::set<std::string> effects;
    double chiSquaredPerValue = 0.0;
};
using Waypoints = std::vector<Waypoint>;

/// Whether two places have the same effects, and leave the same but for this share.
bool isNear(const Waypoint&, const Waypoint&, double share);

/// Whether an effect is made of resonances that the cone feels. They can be whatever a box or a suspension in a wrong
/// shape lacks, however much they are missed then.
bool mayStandIn(const Model&, const std::string& effect);

/// The effects of a model whose parameters are no longer what their names say.
std::set<std::string> implausibleIn(const Model&);

/// The steps of a search for all effects of a loudspeaker at once: they judge by two realizations a level, and by what
/// a simulation leaves where that is less than what fed laws leave. A removal that fed laws miss much is not played.
class WholeSearch {
public:
    /// @param base  what it has stays in every model; it and the record outlive the search
    /// @param progress  asked for whether to stop
    WholeSearch(const Model& base, const Record&, const FitOptions&, const Progress& = {});

    /// Chooses by which residuals is judged from here on: those that are less for this model.
    void chooseResiduals(const Model&);
    const ScoreOptions& test() const { return test_; }

    Left left(const Model&) const;
    /// The same after a brief fit that follows small moves between the sections of the take; no channels where larger
    /// ones would be, where these explain less than a quarter of what is left, and of a record of which that says
    /// nothing.
    Left leftOfSections(const Model&) const;

    /// By how many dB more a model leaves than another, in the channel that tells most: of the mean over all lines,
    /// beside what is noise for sure, or of the power, which may stand in a few lines, over that of the noise.
    double lost(const Left& more, const Left& less) const;

    FitSummary fit(Model&, const Progress&) const;
    FitSummary fit(Model& model) const { return fit(model, silent_); }
    /// Whether the first two steps of a fit leave so many dB less: near the noise laws are weak, and these go most of
    /// the way.
    bool gainsAtOnce(Model, const Left& before, double dB) const;
    /// From each start of the laws among the newcomers, as what derivatives promise of a start need not come true;
    /// leaves the first one where another leaves 1 dB less.
    FitSummary fitFromEachStart(Model&, const std::set<std::string>& newcomers, const Progress& = {}) const;
    /// @param model  the result: that of the score, whose newest effect is a law, fitted from each of its starts
    FitSummary tryLaw(Model& model, const Score&, const Progress& = {}) const;
    /// Fits from other starts of the laws that a model has: of each law that has several, and of all laws from rest. A
    /// law that came in while others were missing may have done their work, in a shape from which no small step leads
    /// back. Whether one leaves 1 dB less, and less in all; the model and its fit are replaced then.
    bool startAnew(Model&, FitSummary&, const Progress& = {}) const;

    /// What is worth trying once at a place: it would come to the same again.
    enum class Attempt { otherStarts, laws };
    /// Whether that has not been tried yet at such a place; from now on it has.
    bool beginAt(const Waypoint&, Attempt);
    void findPartsAnew(Model&) const;  ///< see FindAnew.h
    void raiseDegrees(Model&) const;   ///< of laws, as far as it pays

    using Removals = std::map<std::string, Removal>;
    /// Every effect of a model but those of the base. By derivatives it says little of an effect that has become a
    /// large part of the linear model, so one that seems to be needed little is really taken out.
    /// @param thorough  what seems to be missed, but by less than 6 dB, is fitted with a simulation's own slopes before
    ///                  that is believed: where laws rule the motion those of fed laws lead no further than near the
    ///                  least error
    /// @param before    of a model that had these effects and others: what it missed clearly is not tried again
    Removals tryWithout(const Model&, bool thorough, const Removals& before = {}) const;

    /// Takes the effects out of which the others do not lose what `keeps` asks for, the least needed first. Whether
    /// there were any.
    /// @param tried  before as for tryWithout(), after what was found of each effect
    bool takeOut(Model&, bool thorough, const std::function<bool(const Removal&)>& keeps, Removals& tried) const;

    /// Puts parts of effects at rest that stand for something else, where others of their effect do not (see
    /// FitResponse.h). Whether there were any; the model is to be fitted again then.
    bool restImplausibleParts(Model&) const;

    /// Takes out what stands for something else, and fits the rest; returns the effects that went. Of those that have
    /// plausible parts only the others go. Where only noise is left they go one at a time, the least missed first: one
    /// that stands for something else bends others, too, and these come right without it. A linear effect that is much
    /// missed is found anew there before it would go.
    std::set<std::string> takeOutImplausible(Model&) const;

    /// The model with the linear effects among these that it needs, found on the responses: of those that are
    /// plausible as they are the one that leaves least comes first, the others are tried beside it. Where no plausible
    /// one leaves less, one that is not comes in on trust, as another may have bent it; if something stays implausible
    /// in the end, the model from before that is returned.
    Model withLinear(const std::vector<const Effect*>&, Model, const Progress& = {}) const;

    /// Exchanges linear effects, on trial, for those that the model does not have: one may have come in for another,
    /// of which nothing is left to be seen then. Whether one of those stayed. Fits the model briefly first, and
    /// chooses residuals.
    bool exchangeStandIns(Model&, const Progress& = {});

private:
    static constexpr LeastSquaresOptions full {12, 1e-3}, brief {5, 1e-2}, glance {1, 1e-1};
    static constexpr double barelyMissed = 6.0;  // dB

    /// What a model leaves by the residuals that were chosen, and by those of fed laws.
    struct Asked {
        Left chosen, fed;
    };
    struct Leaner {
        std::string effect;  ///< that went
        Model model;
    };

    FitOptions within(const LeastSquaresOptions&) const;
    FitSummary fit(Model&, const LeastSquaresOptions&, const Progress&) const;
    FitSummary fit(Model& model, const LeastSquaresOptions& steps) const { return fit(model, steps, silent_); }
    FitSummary fitExactly(Model&) const;
    FitSummary orBetter(Model&, FitSummary, std::vector<Model> others, const Progress&) const;
    FitSummary glanceAt(Model&) const;
    Left left(const Model&, bool played) const;
    Left leftBy(const std::vector<SectionFit>&) const;
    std::set<std::string> strangeIn(const Model&) const;
    bool hasBecomeStrange(const Model&, const Model& before) const;
    std::set<std::string> takeOutOneByOne(Model&) const;
    std::optional<Leaner> withoutOneOf(const std::set<std::string>& effects, const Model&) const;
    bool bringBack(Model&, const std::string& effect, const Left& without) const;
    bool reshape(Model&, const Left& now, const Left& enough, const LinearResponses& still) const;
    Removal without(const Model&, const Asked& now, const std::string& effect, const Vote&, bool thorough,
                    std::optional<LinearResponses>& still) const;
    Vote votedBy(const std::string& effect, const Vote&, const Left& without, const Left& with, bool atNoise) const;

    const Model& base_;
    const Record& record_;
    std::vector<std::size_t> sections_;
    ScoreOptions test_;
    FitOptions options_;
    Progress silent_;  ///< of steps that report nothing; they stop when asked to
    std::map<Attempt, Waypoints> tried_;
};

}  // namespace excursion
