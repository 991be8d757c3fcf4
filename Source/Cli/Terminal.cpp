// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Terminal.h"

#include "Engine/Document/JsonText.h"
#include "Engine/Error.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <chrono>
#include <cmath>
#include <csignal>
#include <iostream>

#ifdef _WIN32
#include <io.h>
#else
#include <sys/ioctl.h>
#include <unistd.h>
#endif

namespace excursion::cli {
namespace {

std::atomic<bool> interrupted {false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may only touch lock-free atomics");

extern "C" void onInterrupt(int signal)
{
    interrupted = true;
    std::signal(signal, SIG_DFL);  // the second Ctrl-C is for work that does not listen
}

bool isStderrATerminal()
{
#ifdef _WIN32
    return _isatty(_fileno(stderr)) != 0;
#else
    return isatty(STDERR_FILENO) != 0;
#endif
}

std::size_t terminalColumns()
{
#if defined(TIOCGWINSZ)
    winsize size {};
    if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1)
        return size.ws_col;
#endif
    return 80;
}

bool startsAsNumber(std::string_view text)
{
    if (!text.empty() && (text.front() == '-' || text.front() == '+'))
        text.remove_prefix(1);
    return !text.empty() && text.front() >= '0' && text.front() <= '9';
}

std::string padded(const std::string& text, std::size_t to, bool right)
{
    const std::string blanks(to - std::min(to, columnsOf(text)), ' ');
    return right ? blanks + text : text + blanks;
}

double shareFrom(double fraction) { return std::isfinite(fraction) ? std::clamp(fraction, 0.0, 1.0) : 0.0; }

std::string formatted(double value, std::chars_format format, int precision)
{
    std::array<char, 400> text {};  // a fixed 1e308 has 309 digits
    const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value, format, precision);
    return error == std::errc() ? std::string(text.data(), end) : std::string("?");
}

}  // namespace

std::size_t columnsOf(std::string_view text)
{
    return static_cast<std::size_t>(
        std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

Terminal::Terminal() : stderrIsTerminal_(isStderrATerminal())
{
    std::signal(SIGINT, onInterrupt);
    interruptWatch_ = std::jthread([this](const std::stop_token& ended) {
        while (!ended.stop_requested() && !interrupted)
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        if (interrupted)
            stop_.request_stop();
    });
}

Terminal::~Terminal() { clearBar(); }

Progress Terminal::progress()
{
    Progress progress;
    progress.stop = stop_.get_token();
    if (progressLines)
        progress.report = [this](double fraction, std::string_view what) { printProgress(fraction, what); };
    else if (stderrIsTerminal_ && !quiet)
        progress.report = [this](double fraction, std::string_view what) { drawBar(fraction, what); };
    return progress;
}

void Terminal::say(std::string_view text)
{
    clearBar();
    if (jsonFile != "-" && !quiet)
        std::cout << text << '\n' << std::flush;
}

void Terminal::table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows)
{
    std::vector<std::size_t> widths;
    std::vector<bool> numeric(header.size(), true);
    for (const auto& title : header)
        widths.push_back(columnsOf(title));
    for (const auto& row : rows)
        for (std::size_t c = 0; c < std::min(row.size(), header.size()); ++c) {
            widths[c] = std::max(widths[c], columnsOf(row[c]));
            numeric[c] = numeric[c] && (row[c].empty() || row[c] == "-" || startsAsNumber(row[c]));
        }
    const auto line = [&](const std::vector<std::string>& cells) {
        std::string text;
        for (std::size_t c = 0; c < header.size(); ++c)
            text.append("  ").append(padded(c < cells.size() ? cells[c] : std::string(), widths[c], numeric[c]));
        while (!text.empty() && text.back() == ' ')
            text.pop_back();
        return text + '\n';
    };
    std::string text = line(header);
    std::vector<std::string> rule;
    for (const auto w : widths)
        rule.emplace_back(w, '-');
    text += line(rule);
    for (const auto& row : rows)
        text += line(row);
    text.pop_back();
    say(text);
}

void Terminal::document(const nlohmann::ordered_json& document)
{
    clearBar();
    if (jsonFile == "-") {
        std::cout << jsonText(document) << std::flush;
        if (!std::cout)
            throw Error(Error::Kind::input,
                        "The document cannot be written to the standard output; its disk is full, or nobody reads it.");
    } else if (!jsonFile.empty()) {
        writeJson(document, jsonFile);
    }
}

void Terminal::complain(std::string_view sentence)
{
    clearBar();
    std::cerr << "excursion: " << sentence << '\n' << std::flush;
}

void Terminal::printProgress(double fraction, std::string_view what)
{
    auto line = "progress " + fixed(shareFrom(fraction), 2) + " " + std::string(what);
    if (line == lastBar_)
        return;
    std::cerr << line << '\n' << std::flush;
    lastBar_ = std::move(line);
}

void Terminal::drawBar(double fraction, std::string_view what)
{
    constexpr int cells = 32;
    const double shown = shareFrom(fraction);
    const auto full = static_cast<std::size_t>(std::lround(shown * cells));
    std::string bar = padded(std::string(full, '='), cells, false);
    bar.append("| ").append(padded(fixed(100 * shown, 0), 3, true)).append(" %  ").append(what.substr(0, 40));
    if (bar == lastBar_)
        return;
    std::cerr << "\r\x1b[K|" << bar << std::flush;
    lastBar_ = bar;
    barIsDrawn_ = true;
}

void Terminal::live(std::string_view line)
{
    if (quiet || progressLines)
        return;
    if (!stderrIsTerminal_) {
        std::cerr << line << '\n' << std::flush;
        return;
    }
    std::cerr << "\r\x1b[K" << line.substr(0, terminalColumns() - 1) << std::flush;
    barIsDrawn_ = true;
}

void Terminal::clearBar()
{
    if (barIsDrawn_)
        std::cerr << "\r\x1b[K" << std::flush;
    barIsDrawn_ = false;
    lastBar_.clear();
}

std::string fixed(double value, int decimals)
{
    auto text = formatted(value, std::chars_format::fixed, decimals);
    if (text.starts_with('-') && text.find_first_not_of("-0.") == std::string::npos)
        text.erase(0, 1);  // a rounded zero has no sign
    return text;
}

std::string errorText(double db) { return std::isnan(db) ? "-" : std::isfinite(db) ? fixed(db, 1) : "runs away"; }

std::string significant(double value, int digits)
{
    const double size = std::abs(value);
    if (!(size >= 1e-3 && size < 1e7))
        return formatted(value, std::chars_format::general, digits);
    auto text = fixed(value, std::max(0, digits - 1 - static_cast<int>(std::floor(std::log10(size)))));
    if (text.find('.') != std::string::npos)
        text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.')
        text.pop_back();
    return text;
}

std::string wrapped(std::string_view text, std::size_t indent, std::size_t columns)
{
    std::string result;
    std::size_t used = 0;
    for (bool first = true; !text.empty(); first = false) {
        const auto word = text.substr(0, text.find(' '));
        text.remove_prefix(std::min(text.size(), word.size() + 1));
        if (used > indent && used + 1 + columnsOf(word) > columns) {
            result += '\n' + std::string(indent, ' ');
            used = indent;
        } else if (!first) {
            result += ' ';
            ++used;
        }
        result += word;
        used += columnsOf(word);
    }
    return result;
}

}  // namespace excursion::cli
