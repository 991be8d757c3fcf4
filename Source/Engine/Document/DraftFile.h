// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string_view>

namespace excursion {

/// Where a document for this target goes: links lead on, and stay.
std::filesystem::path behindLinks(std::filesystem::path target);
/// What is written to and never replaced: a pipe, a device, /dev/stdout.
bool isNoFile(const std::filesystem::path& target);

/// A file that is written beside its place ("name.tmp") and put there whole by publish(). Until then
/// what stood there stays; a draft that is never published leaves nothing behind.
class DraftFile {
public:
    /// Creates the folder of `target` when it is missing. Throws Error (input) when it cannot.
    explicit DraftFile(std::filesystem::path target);
    ~DraftFile();
    DraftFile(const DraftFile&) = delete;
    DraftFile& operator=(const DraftFile&) = delete;

    const std::filesystem::path& path() const { return draft_; }  ///< where to write
    void write(std::string_view bytes);                           ///< all of it; throws Error (input)
    void publish();                                               ///< throws Error (input)

private:
    std::filesystem::path target_, draft_;
};

/// The whole of a file at once. Throws Error (input).
void publish(const std::filesystem::path& target, std::string_view bytes);

}  // namespace excursion
