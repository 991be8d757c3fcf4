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

DraftFile::DraftFile(fs::path target) : target_(std::move(target))
{
    std::error_code error;
    // A link stays one, and what is no file (/dev/null, a pipe) is written to, not replaced.
    if (const auto real = fs::canonical(target_, error); !error)
        target_ = real;
    error.clear();
    draft_ = target_;
    if (!fs::is_other(target_, error))
        draft_ += ".tmp";
    error.clear();
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
    std::ofstream file(draft_, std::ios::binary | std::ios::trunc);
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
