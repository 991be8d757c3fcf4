// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Import/PlainText.h"

#include "Engine/Document/TextFile.h"
#include "Engine/Error.h"

#include <algorithm>

namespace excursion {
namespace {

unsigned byteAt(std::string_view bytes, std::size_t k) { return static_cast<unsigned char>(bytes[k]); }

void append(std::string& text, unsigned code)
{
    const auto put = [&text](unsigned byte) { text += static_cast<char>(byte); };
    if (code < 0x80) {
        put(code);
    } else if (code < 0x800) {
        put(0xC0 | code >> 6);
        put(0x80 | (code & 0x3F));
    } else if (code < 0x10000) {
        put(0xE0 | code >> 12);
        put(0x80 | (code >> 6 & 0x3F));
        put(0x80 | (code & 0x3F));
    } else {
        put(0xF0 | code >> 18);
        put(0x80 | (code >> 12 & 0x3F));
        put(0x80 | (code >> 6 & 0x3F));
        put(0x80 | (code & 0x3F));
    }
}

std::string fromUtf16(std::string_view bytes, bool bigEndian)
{
    std::string text;
    text.reserve(bytes.size() / 2);
    const auto unit = [&](std::size_t k) {
        return bigEndian ? byteAt(bytes, k) << 8 | byteAt(bytes, k + 1) : byteAt(bytes, k + 1) << 8 | byteAt(bytes, k);
    };
    for (std::size_t k = 0; k + 1 < bytes.size(); k += 2) {
        unsigned code = unit(k);
        if (code >= 0xD800 && code < 0xDC00 && k + 3 < bytes.size() && unit(k + 2) >= 0xDC00 && unit(k + 2) < 0xE000) {
            code = 0x10000 + ((code - 0xD800) << 10) + (unit(k + 2) - 0xDC00);
            k += 2;
        }
        append(text, code >= 0xD800 && code < 0xE000 ? 0xFFFDu : code);
    }
    return text;
}

bool isUtf8(std::string_view bytes)
{
    for (std::size_t k = 0; k < bytes.size();) {
        const unsigned lead = byteAt(bytes, k++);
        if (lead < 0x80)
            continue;
        const int more = lead >= 0xC2 && lead < 0xE0   ? 1
                         : lead >= 0xE0 && lead < 0xF0 ? 2
                         : lead >= 0xF0 && lead < 0xF5 ? 3
                                                       : -1;
        if (more < 0)
            return false;
        for (int n = 0; n < more; ++n, ++k)
            if (k >= bytes.size() || (byteAt(bytes, k) & 0xC0) != 0x80)
                return false;
    }
    return true;
}

/// 0: no UTF-16; 1: little endian; 2: big endian. A table of numbers has hardly a character beyond Latin-1.
int utf16Without(std::string_view bytes)
{
    const auto looked = std::min<std::size_t>(bytes.size() & ~std::size_t(1), 4096);
    std::size_t even = 0, odd = 0;
    for (std::size_t k = 0; k < looked; k += 2) {
        even += bytes[k] == 0;
        odd += bytes[k + 1] == 0;
    }
    if (looked < 8)
        return 0;
    return odd * 2 > looked * 9 / 10 && even == 0 ? 1 : even * 2 > looked * 9 / 10 && odd == 0 ? 2 : 0;
}

}  // namespace

std::string plainText(std::string_view bytes, const std::string& source)
{
    std::string text;
    if (bytes.starts_with("\xFF\xFE")) {
        text = fromUtf16(bytes.substr(2), false);
    } else if (bytes.starts_with("\xFE\xFF")) {
        text = fromUtf16(bytes.substr(2), true);
    } else if (const int order = utf16Without(bytes)) {
        text = fromUtf16(bytes, order == 2);
    } else {
        if (bytes.starts_with("\xEF\xBB\xBF"))
            bytes.remove_prefix(3);
        if (isUtf8(bytes))
            text = bytes;
        else
            for (const char c : bytes)
                append(text, static_cast<unsigned char>(c));
    }
    if (text.find('\0') != std::string::npos)
        throw Error(Error::Kind::input, "'" + source + "' is no text file: it holds zero bytes.");
    if (text.find('\r') != std::string::npos) {
        std::string lines;
        lines.reserve(text.size());
        for (std::size_t k = 0; k < text.size(); ++k)
            if (text[k] != '\r')
                lines += text[k];
            else if (k + 1 == text.size() || text[k + 1] != '\n')
                lines += '\n';
        text = std::move(lines);
    }
    return text;
}

std::string readPlainText(const std::filesystem::path& path, std::uintmax_t mostBytes)
{
    return plainText(readText(path, mostBytes), path.string());
}

}  // namespace excursion
