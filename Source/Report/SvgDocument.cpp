// SPDX-License-Identifier: GPL-3.0-or-later
#include "Report/Draw.h"
#include "Report/Page.h"
#include "Report/Style.h"

namespace excursion {
namespace {

constexpr int titleRoom = 26;  // px above the picture

/// "#1d1d1f" for "--measured": the first of the style sheet, which is that of light pages.
std::string lightColour(std::string_view property)
{
    const auto style = pageStyle();
    const auto at = style.find(std::string(property) + ": ");
    if (at == std::string_view::npos)
        return "currentColor";
    const auto begin = at + property.size() + 2;
    return std::string(style.substr(begin, style.find(';', begin) - begin));
}

std::string withLightColours(std::string_view svg)
{
    std::string result;
    for (;;) {
        const auto begin = svg.find("var(");
        result += svg.substr(0, begin);
        if (begin == std::string_view::npos)
            return result;
        const auto end = svg.find(')', begin);
        result += lightColour(svg.substr(begin + 4, end - begin - 4));
        svg.remove_prefix(end + 1);
    }
}

}  // namespace

std::string svgDocument(const Plot& plot)
{
    const auto picture = withLightColours(draw({plot}).front());
    const int head = plot.title.empty() ? 0 : titleRoom;
    const auto width = std::to_string(plot.width), height = std::to_string(plot.height + head);
    auto text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" "
                "xmlns:xlink=\"http://www.w3.org/1999/xlink\" width=\""
                + width + "\" height=\"" + height + "\" viewBox=\"0 0 " + width + " " + height
                + "\" font-family=\"sans-serif\">\n<title>" + escapeHtml(plot.title)
                + "</title>\n<rect width=\"100%\" height=\"100%\" fill=\"" + lightColour("--card") + "\"/>\n";
    if (head > 0)
        text += "<text x=\"12\" y=\"19\" font-size=\"14\" fill=\"" + lightColour("--ink") + "\">"
                + escapeHtml(plot.title) + "</text>\n";
    return text + "<svg y=\"" + std::to_string(head) + "\" width=\"" + width + "\" height=\""
           + std::to_string(plot.height) + "\">\n" + picture + "\n</svg>\n</svg>\n";
}

}  // namespace excursion
