// SPDX-License-Identifier: GPL-3.0-or-later
#include "Report/Page.h"

#include "Engine/Document/Engineering.h"
#include "Report/CurveData.h"
#include "Report/Draw.h"
#include "Report/Explore.h"
#include "Report/Style.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

std::string element(std::string_view tag, std::string_view text)
{
    return "<" + std::string(tag) + ">" + escapeHtml(text) + "</" + std::string(tag) + ">\n";
}

std::string cellHtml(const Page::Cell& cell)
{
    if (cell.share) {
        const double share = std::isfinite(*cell.share) ? std::clamp(*cell.share, 0.0, 1.0) : 0.0;
        return "<td class=\"share\"><span class=\"bar\"><i style=\"width:" + fixedText(100.0 * share, 1)
               + "%\"></i></span>" + escapeHtml(cell.text) + "</td>";
    }
    return (cell.numeric ? "<td class=\"figure\">" : "<td>") + escapeHtml(cell.text) + "</td>";
}

}  // namespace

std::string escapeHtml(std::string_view text)
{
    std::string safe;
    for (const char c : text)
        switch (c) {
        case '&': safe += "&amp;"; break;
        case '<': safe += "&lt;"; break;
        case '>': safe += "&gt;"; break;
        case '"': safe += "&quot;"; break;
        case '\'': safe += "&#39;"; break;
        default: safe += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
        }
    return safe;
}

Page::Cell Page::Cell::bar(double share, std::string text)
{
    Cell cell(std::move(text));
    cell.share = share;
    return cell;
}

Page::Cell Page::figure(std::string text)
{
    Cell cell(std::move(text));
    cell.numeric = true;
    return cell;
}

void Page::headline(const std::string& text, std::string_view tone)
{
    body_ += "<p class=\"verdict " + std::string(tone) + "\">" + escapeHtml(text) + "</p>\n";
}

void Page::section(const std::string& text)
{
    const auto id = "s" + std::to_string(++sections_);
    body_ += "<h2 id=\"" + id + "\">" + escapeHtml(text) + "</h2>\n";
    contents_ += "<a href=\"#" + id + "\">" + escapeHtml(text) + "</a>\n";
}

void Page::subsection(const std::string& text) { body_ += element("h3", text); }

void Page::paragraph(const std::string& text) { body_ += element("p", text); }

void Page::note(const std::string& text) { body_ += "<p class=\"note\">" + escapeHtml(text) + "</p>\n"; }

void Page::table(const std::vector<std::string>& header, const std::vector<std::vector<Cell>>& rows)
{
    constexpr std::size_t most = 12;  // columns that fit across a sheet of paper
    body_ += header.size() > most ? "<div class=\"wide many\"><table><thead><tr>"
                                  : "<div class=\"wide\"><table><thead><tr>";
    for (std::size_t c = 0; c < header.size(); ++c) {
        const bool numeric = !rows.empty() && std::all_of(rows.begin(), rows.end(), [c](const auto& row) {
            return c >= row.size() || row[c].numeric;
        });
        body_ += (numeric ? "<th class=\"figure\">" : "<th>") + escapeHtml(header[c]) + "</th>";
    }
    body_ += "</tr></thead><tbody>\n";
    for (const auto& row : rows) {
        body_ += "<tr>";
        for (const auto& cell : row)
            body_ += cellHtml(cell);
        body_ += "</tr>\n";
    }
    body_ += "</tbody></table></div>\n";
}

void Page::facts(const std::vector<std::pair<std::string, std::string>>& pairs)
{
    body_ += "<dl>";
    for (const auto& [name, value] : pairs)
        body_ += "<div><dt>" + escapeHtml(name) + "</dt><dd>" + escapeHtml(value) + "</dd></div>";
    body_ += "</dl>\n";
}

void Page::figures(std::vector<Plot> plots, int columns, const std::string& howToRead)
{
    if (plots.empty())
        return;
    body_ += "<figure><div class=\"grid columns" + std::to_string(columns) + "\">\n";
    for (auto& plot : plots) {
        // about as wide as it will be shown, or its text shrinks
        plot.width = columns == 1 ? 640 : columns == 2 ? 460 : 330;
        plot.height = columns == 1 ? 340 : columns == 2 ? 270 : 240;
        body_ += "<div class=\"picture\"><h4><span>" + escapeHtml(plot.title) + "</span></h4>";
        places_.push_back(body_.size());
        body_ += "</div>\n";
        plots_.push_back(std::move(plot));
    }
    body_ += "</div><figcaption>" + escapeHtml(howToRead) + "</figcaption></figure>\n";
}

void Page::figures(std::vector<Plot> plots, const std::string& howToRead)
{
    const int columns = plots.size() == 1 ? 1 : plots.size() % 3 == 0 ? 3 : 2;
    figures(std::move(plots), columns, howToRead);
}

std::string Page::html() const
{
    const auto pictures = draw(plots_);
    std::string body;
    std::size_t done = 0;
    for (std::size_t k = 0; k < pictures.size(); ++k) {
        body.append(body_, done, places_[k] - done);
        body += pictures[k];
        done = places_[k];
    }
    body.append(body_, done);
    if (!plots_.empty())
        body += "<script type=\"application/json\" id=\"curves\">" + curveData(plots_)
                + "</script>\n<script type=\"module\">\n" + std::string(exploreScript()) + "</script>\n";
    return "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
           "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
           "<meta name=\"color-scheme\" content=\"light dark\">\n"
           // What the page holds is all that it may use: nothing can be loaded, and nothing sent.
           "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; "
           "script-src 'unsafe-inline'\">\n"
           "<title>"
           + escapeHtml(title_) + "</title>\n<style>\n" + std::string(pageStyle())
           + "</style></head>\n<body><main>\n<h1>" + escapeHtml(title_) + "</h1>\n<nav>" + contents_ + "</nav>\n" + body
           + "</main></body></html>\n";
}

}  // namespace excursion
