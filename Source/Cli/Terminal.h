// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Progress.h"

#include <nlohmann/json_fwd.hpp>

#include <cstddef>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace excursion::cli {

/// Where a verb speaks. Results go to stdout, everything about the work to stderr:
///  - by default text and tables for a person, and a progress bar when stderr is a terminal;
///  - with --json the one document of the verb on stdout, and nothing else;
///  - with --json FILE.json the document in that file, and the text for a person on stdout;
///  - with --quiet nothing but errors (and the document, when --json asks for it too);
///  - with --progress a line "progress 0.31 fitting stiffness" on stderr at each hundredth of the work, for programs
///  that read it.
/// Ctrl-C asks the work to stop (`stop()`); a second Ctrl-C ends the program on the spot.
class Terminal {
public:
    Terminal();
    ~Terminal();
    Terminal(const Terminal&) = delete;
    Terminal& operator=(const Terminal&) = delete;

    std::string jsonFile;   ///< where the document goes: empty: nowhere; "-": stdout
    bool exitZero = false;  ///< an answer that is no is no failure of the program: exit code 0
    bool quiet = false, progressLines = false;
    int answer = 0;  ///< exit code of a verb that ran well: 1 when its answer is no

    /// What long work is given: draws the bar, or prints the lines, and carries the stop of Ctrl-C. Valid as long as
    /// the terminal.
    Progress progress();
    std::stop_token stop() const { return stop_.get_token(); }

    /// What goes on at the moment, in one line on stderr: in the place of the one before where stderr is a terminal
    /// (cut at its width), else as a line of its own. Not with --quiet and --progress.
    void live(std::string_view line);
    bool livesInPlace() const { return stderrIsTerminal_; }

    /// Text for a person, on stdout, ended by a line break.
    void say(std::string_view text);

    /// A table for a person: columns aligned, those of numbers (all cells begin as one) to the right.
    void table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows);

    /// The document of the verb, on stdout or in the file, when --json asked for it.
    void document(const nlohmann::ordered_json&);

    /// One sentence "excursion: ..." on stderr.
    void complain(std::string_view sentence);

private:
    void drawBar(double fraction, std::string_view what);
    void printProgress(double fraction, std::string_view what);
    void clearBar();

    bool stderrIsTerminal_ = false;
    bool barIsDrawn_ = false;
    std::string lastBar_;  ///< or the last line of --progress
    std::stop_source stop_;
    std::jthread interruptWatch_;  ///< a signal handler may not touch a stop_source itself
};

/// "-61.0": a number with a fixed count of decimals, for tables. Locale-free.
std::string fixed(double value, int decimals);

/// "-61.0": the error of a simulation in dB; "-" where it is not known, "runs away" where it is infinite.
std::string errorText(double db);

/// "1.43e-05", "22000" or "3.3": a number with that many significant digits (whole parts in full),
/// without zeros at its end; for tables. Locale-free.
std::string significant(double value, int digits = 4);

/// Columns that UTF-8 text takes, one a code point.
std::size_t columnsOf(std::string_view text);

/// The text in lines of at most `columns`, broken at blanks; all but the first begin with `indent` blanks.
std::string wrapped(std::string_view text, std::size_t indent = 0, std::size_t columns = 110);

}  // namespace excursion::cli
