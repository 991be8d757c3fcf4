// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/Hammerstein/ParallelHammersteinFile.h"

#include "Engine/Document/JsonText.h"
#include "Engine/Linear/StateSpaceFile.h"

namespace excursion {
namespace {

constexpr DocumentFormat parallelHammersteinFormat {"excursion-parallel-hammerstein"};

}  // namespace

nlohmann::ordered_json toJson(const Named<ParallelHammerstein>& named)
{
    auto document = modelHeader(parallelHammersteinFormat, named.name, named.model.sampleRate, named.input,
                                named.output);
    document["offset"] = named.model.offset;
    document["branches"] = matrixJson(named.model.filters.transpose());
    return document;
}

Named<ParallelHammerstein> parallelHammersteinFromJson(const JsonField& field)
{
    auto named = namedFromHeader<ParallelHammerstein>(field, parallelHammersteinFormat);
    named.model.offset = field.at("offset").number();
    const auto branches = field.at("branches").items();
    if (branches.empty() || branches[0].items().empty())
        field.at("branches").refuse("a list of taps for each power of the input, at least one");
    const auto degree = static_cast<Eigen::Index>(branches.size()),
               length = static_cast<Eigen::Index>(branches[0].items().size());
    named.model.filters = matrixFrom(field.at("branches"), degree, length).transpose();
    return named;
}

}  // namespace excursion
