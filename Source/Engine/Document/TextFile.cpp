// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Document/TextFile.h"

#include "Engine/Document/Words.h"
#include "Engine/Error.h"

#include <fstream>

namespace excursion {

namespace fs = std::filesystem;

std::uintmax_t sizeOfFile(const fs::path& path)
{
    const auto refuse = [&path](const std::string& why) {
        throw Error(Error::Kind::input, "'" + path.string() + "' " + why);
    };
    std::error_code error;
    const auto status = fs::status(path, error);
    if (status.type() == fs::file_type::not_found)
        refuse("does not exist; check the path.");
    if (error)
        refuse("cannot be read (" + error.message() + ").");
    if (!fs::is_regular_file(status))
        refuse("is not a file; give the path of a file.");
    const auto size = fs::file_size(path, error);
    if (error)
        refuse("cannot be read (" + error.message() + ").");
    if (size == 0)
        refuse("is empty; it was probably not written to its end.");
    return size;
}

std::string readText(const fs::path& path, std::uintmax_t mostBytes)
{
    const auto size = sizeOfFile(path);
    if (size > mostBytes)
        throw Error(Error::Kind::input, "'" + path.string() + "' has " + std::to_string(size) + " bytes, more than the "
                                            + std::to_string(mostBytes) + " that such a file may have.");
    std::string text(static_cast<std::size_t>(size), '\0');
    std::ifstream file(path, std::ios::binary);
    file.read(text.data(), static_cast<std::streamsize>(text.size()));
    if (!file)
        throw Error(Error::Kind::input, "'" + path.string() + "' cannot be read; check its permissions.");
    if (text.starts_with("\xEF\xBB\xBF"))
        text.erase(0, 3);
    return text;
}

std::string endingOf(const std::filesystem::path& path) { return lowerCase(path.extension().string()); }

}  // namespace excursion
