// SPDX-License-Identifier: GPL-3.0-or-later
// Where the processor, which knows of no window, and the window, which shows a processor, are put together.
#include "Plugin/Editor.h"
#include "Plugin/Processor.h"

namespace excursion::plugin {

juce::AudioProcessorEditor* Processor::createEditor() { return new Editor(*this); }

}  // namespace excursion::plugin

juce::AudioProcessor* JUCE_CALLTYPE createPluginFilter() { return new excursion::plugin::Processor(); }
