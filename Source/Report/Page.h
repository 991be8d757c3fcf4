// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plots/Plot.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace excursion {

/// The text with &, <, > and quotes made harmless, for text and attributes alike.
std::string escapeHtml(std::string_view text);

/// One self-contained HTML page, filled from top to bottom. Every text is escaped here; nobody hands markup in. Its
/// pictures are there without a script, for paper and for readers that run none; with one they can be read, zoomed and
/// switched off.
class Page {
public:
    struct Cell {
        Cell(std::string text) : text(std::move(text)) {}
        Cell(const char* text) : text(text) {}
        static Cell bar(double share, std::string text);  ///< a bar of 0..1 with a figure beside it

        std::string text;
        std::optional<double> share;
        bool numeric = false;
    };
    static Cell figure(std::string text);  ///< aligned as a number

    explicit Page(std::string title) : title_(std::move(title)) {}

    void headline(const std::string& text, std::string_view tone);  ///< tone: "good", "warn" or "bad"
    void section(const std::string& text);                          ///< a chapter, listed at the top
    void subsection(const std::string& text);
    void paragraph(const std::string& text);
    void note(const std::string& text);  ///< small print: how to read what stands above
    void table(const std::vector<std::string>& header, const std::vector<std::vector<Cell>>& rows);
    void facts(const std::vector<std::pair<std::string, std::string>>&);  ///< name and value pairs in a row
    /// Pictures side by side in one to three columns; the page sets their size.
    void figures(std::vector<Plot>, int columns, const std::string& howToRead);
    /// In as many columns as leave no hole, at most three.
    void figures(std::vector<Plot>, const std::string& howToRead);

    /// The whole page; draws all plots at once. Throws as draw() does.
    std::string html() const;

private:
    std::string title_, body_, contents_;
    std::vector<Plot> plots_;
    std::vector<std::size_t> places_;  // where in body_ the plots go, ascending
    int sections_ = 0;
};

}  // namespace excursion
