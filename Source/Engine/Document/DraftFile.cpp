// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Document/DraftFile.h"

#include "Engine/Error.h"

#include <fstream>
#include <utility>

namespace excursion {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void cannotWrite(const fs::path& target, const std::string& why)
{
    throw Error(Error::Kind::input, "'" + target.string() + "' cannot be written (" + why
                                        + "); choose a folder that you may write to and that has room.");
}

}  // namespace

fs::path behindLinks(fs::path target)
{
    constexpr int mostLinks = 40;  // as the system has it
    std::error_code error;
    for (int n = 0; n < mostLinks && fs::is_symlink(target, error); ++n)
        target = target.parent_path() / fs::read_symlink(target, error);
    return target;
}

bool isNoFile(const fs::path& target)
{
    std::error_code error;
    const auto text = target.generic_string();
    const bool ofSystem = text.starts_with("/dev/") || text.starts_with("/proc/");
    return fs::is_other(target, error)
           || (ofSystem && fs::is_symlink(target, error));  // /dev/stdout is a link to whatever it is
}

DraftFile::DraftFile(fs::path target) : target_(isNoFile(target) ? std::move(target) : behindLinks(std::move(target)))
{
    draft_ = target_;
    if (!isNoFile(target_))
        draft_ += ".tmp";
    std::error_code error;
    if (fs::is_directory(target_, error))
        cannotWrite(target_, "it is a folder");
    if (const auto folder = target_.parent_path(); !folder.empty()) {
        error.clear();
        fs::create_directories(folder, error);
        if (error)
            cannotWrite(target_, error.message());
    }
}

DraftFile::~DraftFile()
{
    std::error_code ignored;
    if (draft_ != target_)
        fs::remove(draft_, ignored);
}

void DraftFile::write(std::string_view bytes)
{
    std::ofstream file(draft_, std::ios::binary | (draft_ == target_ ? std::ios::app : std::ios::trunc));
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.close();
    if (!file)
        cannotWrite(target_, "the disk is full or the folder is read-only");
}

void DraftFile::publish()
{
    std::error_code error;
    if (draft_ != target_)
        fs::rename(draft_, target_, error);
    if (error)
        cannotWrite(target_, error.message());
}

void publish(const std::filesystem::path& target, std::string_view bytes)
{
    DraftFile draft(target);
    draft.write(bytes);
    draft.publish();
}

}  // namespace excursion
