// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/Identify.h"

#include <optional>

namespace excursion {

/// Models of several orders on the same data ([B 4.4.2] plots their error against the order), and which one to take.
///
/// From the largest order down: besides its own starts each order is offered the next larger model without its least
/// section, so the error never rises with the order except by what a local minimum hides.
struct OrderSweepOptions {
    std::vector<int> orders;   ///< ascending
    IdentifyOptions identify;  ///< its order is not used
    bool isValid(std::string* reason = nullptr) const;
};

/// Of orders that nobody has asked for those that a response can tell: as long as a model has no more than half as many
/// parameters as the response has values; the lowest one in any case.
std::vector<int> ordersWithin(const std::vector<int>& orders, const FrequencyData&);

struct OrderSweepEntry {
    int order = 0;
    LinearIdentification found;
    double mdl = 0.0;                    ///< minimum description length, see below
    std::optional<double> validationDb;  ///< unweighted relative error on the validation data
};

/// Minimum description length (Rissanen 1978) of N real values (two a complex one) by P = n (m + p) + m p parameters:
///     2 sum |e|^2/deviation^2 + P ln N     with deviations: the likelihood itself
///     N ln(cost) + P ln N                  without: the noise is estimated from what is left
struct OrderSweep {
    std::vector<OrderSweepEntry> entries;  ///< by ascending order
    std::size_t chosen = 0;                ///< index of the entry
    std::string sentence;                  ///< why that one
};

/// The lowest validation error chooses where there is validation data, the order being the smallest within 0.5 dB of
/// it; else the lowest MDL.
OrderSweep sweepOrders(const FrequencyData&, const OrderSweepOptions&, const FrequencyData* validation = nullptr,
                       const Progress& = {});

}  // namespace excursion
