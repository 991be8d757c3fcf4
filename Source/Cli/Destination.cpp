// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Destination.h"

#include "Engine/Document/DraftFile.h"
#include "Engine/Error.h"
#include "Engine/Take/TakeFile.h"

#include <cctype>
#include <filesystem>
#include <vector>

#ifdef _WIN32
#include <io.h>
#else
#include <unistd.h>
#endif

namespace excursion::cli {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& path, const std::string& why)
{
    throw Error(Error::Kind::input,
                "'" + path + "' cannot be written (" + why + "); choose a folder that you may write to.");
}

bool mayWriteTo(const fs::path& folder)
{
#ifdef _WIN32
    return _waccess(folder.c_str(), 2) == 0;
#else
    return ::access(folder.c_str(), W_OK | X_OK) == 0;
#endif
}

/// The folder that is there already must be one, and writable; the rest of the path can then be created.
void requireWritable(const std::string& path, fs::path folder)
{
    std::error_code error;
    while (!folder.empty() && !fs::exists(folder, error) && folder.has_relative_path())
        folder = folder.parent_path();
    if (folder.empty())
        folder = ".";
    if (!fs::is_directory(folder, error))
        refuse(path, "'" + folder.string() + "' is not a folder");
    if (!mayWriteTo(folder))
        refuse(path, "there is no permission to write to '" + folder.string() + "'");
}

}  // namespace

void requireFilePlace(const std::string& file)
{
    std::error_code error;
    if (file.empty())
        refuse(file, "the name is empty");
    if (fs::is_directory(file, error))
        refuse(file, "it is a folder");
    if (isNoFile(file))
        return;
    requireWritable(file, behindLinks(file).parent_path());
}

void requireFolderPlace(const std::string& folder)
{
    if (folder.empty())
        refuse(folder, "the name is empty");
    requireWritable(folder, folder);
}

void requireApart(const std::string& read, const std::string& written)
{
    std::vector<fs::path> reads {read}, writes {written};
    const std::vector<fs::path> ladder {fs::path(read) / "ladder.json", fs::path(read) / "model.json"};
    for (const auto& files : {filesOfTake(read), filesOfPlan(read), ladder})
        reads.insert(reads.end(), files.begin(), files.end());
    for (const auto& file : filesOfTake(written))
        writes.push_back(file);
    std::error_code none;
    for (const auto& one : reads)
        for (const auto& other : writes)
            if (fs::equivalent(one, other, none))
                throw Error(Error::Kind::usage,
                            "'" + read + "' would be overwritten; give what is written another name.");
}

}  // namespace excursion::cli
