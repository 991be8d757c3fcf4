// SPDX-License-Identifier: GPL-3.0-or-later
#include "Report/InlineSvg.h"

#include <algorithm>
#include <array>
#include <charconv>

namespace excursion {
namespace {

std::vector<std::string_view> linesOf(std::string_view text)
{
    std::vector<std::string_view> lines;
    while (!text.empty()) {
        const auto end = text.find('\n');
        lines.push_back(text.substr(0, end));
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    }
    return lines;
}

void cut(std::string& text, std::string_view from, std::string_view to)
{
    for (auto begin = text.find(from); begin != std::string::npos; begin = text.find(from, begin)) {
        const auto end = text.find(to, begin + from.size());
        if (end == std::string::npos)
            return;
        text.erase(begin, end + to.size() - begin);
    }
}

std::string withoutEmptyGroups(const std::string& text)
{
    const auto lines = linesOf(text);
    std::string kept;
    for (std::size_t k = 0; k < lines.size(); ++k) {
        if (lines[k].starts_with("<g fill=") && k + 1 < lines.size() && lines[k + 1] == "</g>") {
            ++k;
            continue;
        }
        if (lines[k].find_first_not_of(" \t") == std::string_view::npos)
            continue;
        kept += lines[k];
        kept += '\n';
    }
    return kept;
}

/// "17,  34, 51" against the stand-ins.
const StandIn* match(std::string_view inside, const std::vector<StandIn>& colours)
{
    std::array<int, 3> rgb {-1, -1, -1};
    for (auto& value : rgb) {
        inside.remove_prefix(std::min(inside.find_first_of("0123456789"), inside.size()));
        const auto end = std::from_chars(inside.data(), inside.data() + inside.size(), value).ptr;
        inside.remove_prefix(static_cast<std::size_t>(end - inside.data()));
    }
    for (const auto& c : colours)
        if (c.red == rgb[0] && c.green == rgb[1] && c.blue == rgb[2])
            return &c;
    return nullptr;
}

std::string withPageColours(std::string_view text, const std::vector<StandIn>& colours)
{
    std::string result;
    for (;;) {
        const auto begin = text.find("rgb(");
        result += text.substr(0, begin);
        if (begin == std::string_view::npos)
            return result;
        text.remove_prefix(begin);
        const auto end = std::min(text.find(')'), text.size() - 1);
        const auto* colour = match(text.substr(4, end - 4), colours);
        result += colour ? "var(" + std::string(colour->property) + ")" : std::string(text.substr(0, end + 1));
        text.remove_prefix(end + 1);
    }
}

}  // namespace

std::vector<std::string> inlineSvgs(std::string_view printed, const std::vector<StandIn>& colours)
{
    std::vector<std::string> pictures;
    for (;;) {
        const auto begin = printed.find("<svg");
        const auto end = printed.find("</svg>", begin == std::string_view::npos ? 0 : begin);
        if (begin == std::string_view::npos || end == std::string_view::npos)
            return pictures;
        std::string svg(printed.substr(begin, end + 6 - begin));
        printed.remove_prefix(end + 6);
        cut(svg, "<title>", "</title>");
        cut(svg, "<desc>", "</desc>");
        if (svg.find("#gpPt", svg.find("</defs>")) == std::string::npos)  // no picture needs the marks of another
            cut(svg, "<defs>", "</defs>");
        cut(svg, " id=\"", "\"");
        svg.replace(0, 4, "<svg class=\"plot\" role=\"img\"");
        pictures.push_back(withPageColours(withoutEmptyGroups(svg), colours));
    }
}

}  // namespace excursion
