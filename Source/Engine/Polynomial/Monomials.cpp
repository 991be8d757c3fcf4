// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/Monomials.h"

#include "Engine/Error.h"

#include <algorithm>
#include <charconv>
#include <string>

namespace excursion {
namespace {

constexpr std::size_t most = 1'000'000;

/// Appends all ways to spread `degree` over the variables from `from` on, the first variable's power descending.
void spread(std::vector<int>& exponents, std::size_t from, int degree, std::vector<std::vector<int>>& rows)
{
    if (from + 1 == exponents.size()) {
        exponents[from] = degree;
        rows.push_back(exponents);
        if (rows.size() > most)
            throw Error(Error::Kind::usage,
                        "More than a million monomials; lower the degree or the order of the model.");
        return;
    }
    for (int power = degree; power >= 0; --power) {
        exponents[from] = power;
        spread(exponents, from + 1, degree - power, rows);
    }
    exponents[from] = 0;
}

}  // namespace

Exponents monomials(int variables, int lowest, int highest)
{
    if (variables < 1 || lowest < 1 || highest < lowest || highest > 20)
        throw Error(Error::Kind::usage,
                    "Monomials need at least one variable and degrees that ascend from 1 to at most 20.");
    std::vector<std::vector<int>> rows;
    std::vector<int> exponents(static_cast<std::size_t>(variables), 0);
    for (int degree = lowest; degree <= highest; ++degree)
        spread(exponents, 0, degree, rows);
    Exponents result(static_cast<Eigen::Index>(rows.size()), variables);
    for (std::size_t k = 0; k < rows.size(); ++k)
        result.row(static_cast<Eigen::Index>(k)) = Eigen::Map<const Eigen::RowVectorXi>(rows[k].data(), variables);
    return result;
}

namespace {

/// "x2^3" adds 3 to the exponent of x2.
void addFactor(std::string_view factor, int states, int inputs, Eigen::Ref<Eigen::RowVectorXi> exponents)
{
    const auto refuse = [&](const char* why) {
        throw Error(Error::Kind::usage, "The monomials cannot be read: \"" + std::string(factor) + "\" " + why + ".");
    };
    const auto number = [](std::string_view text) {  // 0 where there is none
        int value = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        return error == std::errc() && end == text.data() + text.size() ? value : 0;
    };
    if (factor == "1")
        return;
    const auto hat = factor.find('^');
    const auto variable = factor.substr(0, hat);
    const int power = hat == std::string_view::npos ? 1 : number(factor.substr(hat + 1));
    if (variable.empty() || (variable[0] != 'x' && variable[0] != 'u') || power < 1 || power > 20)
        refuse("is not a variable such as x1 or u, with a power of 1 to 20 or none");
    const bool state = variable[0] == 'x';
    const int index = variable == "u" ? 1 : number(variable.substr(1));
    if (index < 1 || index > (state ? states : inputs))
        refuse("is no state and no input of the model");
    exponents[(state ? 0 : states) + index - 1] += power;
}

/// The parts of a text between separators, blanks around them taken off.
std::vector<std::string_view> parts(std::string_view text, char separator)
{
    std::vector<std::string_view> result;
    for (std::size_t begin = 0; begin <= text.size();) {
        const auto end = std::min(text.find(separator, begin), text.size());
        auto part = text.substr(begin, end - begin);
        while (!part.empty() && part.front() == ' ')
            part.remove_prefix(1);
        while (!part.empty() && part.back() == ' ')
            part.remove_suffix(1);
        result.push_back(part);
        begin = end + 1;
    }
    return result;
}

}  // namespace

Exponents monomialsNamed(std::string_view list, int states, int inputs)
{
    const auto terms = parts(list, ',');
    Exponents result = Exponents::Zero(static_cast<Eigen::Index>(terms.size()), states + inputs);
    for (std::size_t k = 0; k < terms.size(); ++k) {
        Eigen::RowVectorXi row = Eigen::RowVectorXi::Zero(states + inputs);
        for (const auto factor : parts(terms[k], '*'))
            addFactor(factor, states, inputs, row);
        result.row(static_cast<Eigen::Index>(k)) = row;
    }
    return result;
}

std::string_view name(TermMask mask)
{
    switch (mask) {
    case TermMask::full: return "full";
    case TermMask::statesOnly: return "states-only";
    case TermMask::noCrossProducts: return "no-cross-products";
    case TermMask::diagonal: return "diagonal";
    }
    return "";
}

std::vector<TermMask> termMasks()
{
    return {TermMask::full, TermMask::statesOnly, TermMask::noCrossProducts, TermMask::diagonal};
}

Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> allowed(TermMask mask, const Exponents& exponents, int states,
                                                           int outputs)
{
    Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> result(states + outputs, exponents.rows());
    for (Eigen::Index k = 0; k < exponents.rows(); ++k) {
        const bool withInput = exponents.row(k).tail(exponents.cols() - states).sum() > 0;
        const bool pure = (exponents.row(k).array() > 0).count() == 1;
        for (int row = 0; row < states + outputs; ++row)
            switch (mask) {
            case TermMask::full: result(row, k) = true; break;
            case TermMask::statesOnly: result(row, k) = !withInput; break;
            case TermMask::noCrossProducts: result(row, k) = pure; break;
            case TermMask::diagonal:
                result(row, k) = pure && !withInput && (row >= states || exponents(k, row) > 0);
                break;
            }
    }
    return result;
}

}  // namespace excursion
