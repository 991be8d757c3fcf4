// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>
#include <string>

namespace excursion {

/// The one exception the engine throws on purpose. Its text is one clear sentence: which file or
/// option, which field, what was found, what was expected and what to do about it.
class Error : public std::runtime_error {
public:
    /// Scripts see the kind as the exit code of the command.
    enum class Kind {
        usage = 2,  ///< an option or argument makes no sense
        input = 3,  ///< a file is missing, unreadable, truncated, of the wrong version or not finite
        /// the file is well formed but cannot answer the question (too short, a channel is missing)
        data = 4,
        numerical = 5,  ///< a computation did not converge or left the finite numbers
        cancelled = 6   ///< the caller asked to stop
    };

    Error(Kind kind, const std::string& sentence) : std::runtime_error(sentence), kind_(kind) {}

    Kind kind() const noexcept { return kind_; }
    int exitCode() const noexcept { return static_cast<int>(kind_); }

private:
    Kind kind_;
};

}  // namespace excursion
