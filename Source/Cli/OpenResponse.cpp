// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/OpenResponse.h"

#include "Engine/Check/TakeResponse.h"
#include "Engine/Document/JsonField.h"
#include "Engine/Error.h"
#include "Engine/Import/ReadTake.h"

#include <filesystem>

namespace excursion::cli {
namespace {

OpenResponse fromDocument(const std::string& path)
{
    const auto document = readJson(path);
    const JsonField field(document, "", path);
    blaFormat.require(field);
    OpenResponse open;
    open.output = field.at("output").text();
    open.input = field.at("input").text();
    open.frf.frequency = field.at("frequency").numbers();
    const auto re = field.at("re").numbers(), im = field.at("im").numbers();
    if (re.size() != open.frf.frequency.size() || im.size() != re.size())
        field.at("re").refuse("as many numbers as there are frequencies, as in im");
    for (std::size_t k = 0; k < re.size(); ++k)
        open.frf.value.emplace_back(re[k], im[k]);
    for (const auto& [key, target] :
         {std::pair {"noiseVariance", &open.frf.noiseVariance}, std::pair {"totalVariance", &open.frf.totalVariance}})
        if (field.has(key)) {
            *target = field.at(key).numbers();
            if (!target->empty() && target->size() != re.size())
                field.at(key).refuse("as many numbers as there are frequencies, or none");
        }
    return open;
}

}  // namespace

OpenResponse openResponse(const ResponseChoice& choice)
{
    if (std::filesystem::path(choice.path).extension() == ".json" && !std::filesystem::is_directory(choice.path)
        && std::filesystem::path(choice.path).filename() != "measurement.json")
        return fromDocument(choice.path);
    auto found = responseOf(readTake(choice.path), {choice.output, choice.input, choice.level});
    return {std::move(found.frf), std::string(name(found.output)), std::string(name(found.input)),
            found.sampleRate,     found.microphoneDistance,        std::move(found.remarks)};
}

Frf within(const Frf& frf, const std::vector<double>& band)
{
    if (band.empty())
        return frf;
    Frf cut;
    const auto copy = [](const std::vector<double>& from, std::size_t k, std::vector<double>& to) {
        if (!from.empty())
            to.push_back(from[k]);
    };
    for (std::size_t k = 0; k < frf.frequency.size(); ++k)
        if (frf.frequency[k] >= band[0] && frf.frequency[k] <= band[1]) {
            cut.frequency.push_back(frf.frequency[k]);
            cut.value.push_back(frf.value[k]);
            copy(frf.noiseVariance, k, cut.noiseVariance);
            copy(frf.totalVariance, k, cut.totalVariance);
        }
    return cut;
}

}  // namespace excursion::cli
