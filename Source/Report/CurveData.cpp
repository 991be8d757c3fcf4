// SPDX-License-Identifier: GPL-3.0-or-later
#include "Report/CurveData.h"

#include "Report/RoleStyle.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>

namespace excursion {
namespace {

using Json = nlohmann::ordered_json;

std::string arrayText(const std::vector<double>& values, std::size_t size)
{
    std::string text = "[";
    for (std::size_t k = 0; k < size; ++k) {
        text += k == 0 ? "" : ",";
        if (!std::isfinite(values[k])) {
            text += "null";
            continue;
        }
        constexpr int digits = 6;
        std::array<char, 64> number {};
        const auto end = std::to_chars(number.data(), number.data() + number.size(), values[k],
                                       std::chars_format::general, digits)
                             .ptr;
        text.append(number.data(), end);
    }
    return text + "]";
}

/// Arrays, each kept once.
class Arrays {
public:
    std::size_t place(const std::vector<double>& values, std::size_t size)
    {
        const auto [at, isNew] = places_.try_emplace(arrayText(values, std::min(size, values.size())), places_.size());
        if (isNew)
            text_ += (text_.empty() ? "" : ",\n") + at->first;
        return at->second;
    }
    std::string text() const { return "[" + text_ + "]"; }

private:
    std::map<std::string, std::size_t> places_;
    std::string text_;
};

Json axisJson(const Axis& axis)
{
    Json json {{"title", axis.title}, {"unit", axis.unit}, {"log", axis.logarithmic}};
    if (axis.least < axis.most) {
        json["least"] = axis.least;
        json["most"] = axis.most;
    }
    if (!axis.names.empty())
        json["names"] = axis.names;
    return json;
}

Json seriesJson(const Series& series, Arrays& arrays)
{
    const auto& style = styleOf(series.role);
    const auto size = std::min(series.x.size(), series.y.size());
    Json json {{"title", series.title},
               {"colour", style.colour.property},
               {"width", style.width},
               {"dash", series.dash > 0 ? series.dash : style.dash},
               {"x", arrays.place(series.x, size)},
               {"y", arrays.place(series.y, size)}};
    if (!series.lower.empty()) {
        json["lower"] = arrays.place(series.lower, size);
        json["upper"] = arrays.place(series.upper, size);
    }
    if (series.shape == Series::Shape::pointsAndLine)
        json["points"] = true;
    if (!series.told.empty())
        json["told"] = series.told;
    if (!series.names.empty())
        json["names"] = series.names;
    if (!series.facets.empty())
        json["facets"] = series.facets;
    if (series.hidden)
        json["hidden"] = true;
    return json;
}

/// A text that opens an element would end the script's, or begin a comment.
std::string withoutMarkup(const std::string& json)
{
    std::string text;
    for (const char c : json)
        if (c == '<')
            text += "\\u003c";
        else
            text += c;
    return text;
}

}  // namespace

std::string curveData(const std::vector<Plot>& plots)
{
    Arrays arrays;
    Json list = Json::array();
    for (const auto& plot : plots) {
        Json json {{"title", plot.title},
                   {"width", plot.width},
                   {"height", plot.height},
                   {"x", axisJson(plot.x)},
                   {"y", axisJson(plot.y)}};
        if (!plot.facets.empty())
            json["facets"] = plot.facets;
        json["series"] = Json::array();
        for (const auto& series : plot.series)
            json["series"].push_back(seriesJson(series, arrays));
        list.push_back(std::move(json));
    }
    return "{\"arrays\":" + arrays.text()
           + ",\n\"plots\":" + withoutMarkup(list.dump(-1, ' ', false, Json::error_handler_t::replace)) + "}";
}

}  // namespace excursion
