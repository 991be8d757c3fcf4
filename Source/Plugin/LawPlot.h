// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Driver/Model.h"
#include "Plugin/Juce.h"

namespace excursion::plugin {

/// One law of a model, such as Bl(x), over what was visited, with its value at rest as a line.
class LawPlot : public juce::Component {
public:
    void show(LawCurve);
    void paint(juce::Graphics&) override;

private:
    LawCurve law_;
};

} // namespace excursion::plugin
