// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/MotorCone.h"

#include "Cli/Terminal.h"

#include "Engine/Document/JsonText.h"
#include "Engine/Estimate/PhysicalDelay.h"
#include "Engine/GreyBox/MotorCone.h"
#include "Engine/GreyBox/MotorConeFile.h"
#include "Engine/Take/Air.h"

#include <nlohmann/json.hpp>

#include <filesystem>

namespace excursion::cli {

void identifyMotorAndCone(const MotorConeArguments& arguments, Terminal& terminal)
{
    const auto open = [&](const char* output) {
        auto choice = arguments.response;
        choice.output = output;
        return openResponse(choice);
    };
    const auto displacement = open("displacement"), pressure = open("pressure");
    MotorConeOptions options;
    options.motorOrder = arguments.motorOrder;
    options.coneOrder = arguments.coneOrder;
    options.delay = arguments.delay ? *arguments.delay : pressure.microphoneDistance.value_or(0.0) / speedOfSound;
    options.thorough = !arguments.quick;
    const auto found = identifyMotorCone(frequencyDataOf(within(displacement.frf, arguments.band)),
                                         frequencyDataOf(within(pressure.frf, arguments.band)), options,
                                         terminal.progress());

    const auto name = std::filesystem::path(arguments.response.path).stem().string();
    const NamedMotorCone named {arguments.response.path,
                                name,
                                options.delay,
                                found.motorErrorDb,
                                found.coneErrorDb,
                                found.errorDb,
                                found.motorChiSquared,
                                found.chiSquared,
                                found.refined,
                                found.toldUpTo,
                                found.sentence,
                                found.stable,
                                {name, {displacement.input}, {"displacement", "velocity", "acceleration"}, found.motor},
                                {name, {"acceleration"}, {"pressure"}, found.cone},
                                {name, {displacement.input}, {"pressure"}, found.cascade, -options.delay}};
    const auto document = toJson(named);
    if (!arguments.out.empty())
        writeJson(document, arguments.out);

    terminal.say("motor and cone, the sound " + significant(1e3 * options.delay, 4) + " ms on its way");
    terminal.table(
        {"from", "to", "order", "error dB"},
        {{displacement.input, "displacement", std::to_string(found.motor.order()), fixed(found.motorErrorDb, 1)},
         {"acceleration", "pressure", std::to_string(found.cone.order()), fixed(found.coneErrorDb, 1)},
         {displacement.input, "pressure", std::to_string(found.cascade.order()), fixed(found.errorDb, 1)}});
    terminal.say(wrapped(found.sentence));
    if (!found.stable)
        terminal.say("These models are not both stable.");
    if (!arguments.out.empty())
        terminal.say("Wrote " + arguments.out + ".");
    terminal.document(document);
    if (!found.stable)
        terminal.answer = 1;
}

}  // namespace excursion::cli
