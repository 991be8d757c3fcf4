// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Import/ImportMat.h"
#include "Fuzz/Target.h"

#include <fstream>
#include <iterator>
#include <matio.h>
#include <unistd.h>

using namespace excursion;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    if (size == 0)
        return 0;
    const fuzz::MemoryFile file(data + 1, size - 1);
    ImportOptions options;
    if ((data[0] & 1) != 0) {
        addMapping(options, "1=voltage");
        addMapping(options, "data(2)=current:mA");
        options.sampleRate = 1000;
    }
    try {
        fuzz::demandSound(importMat(file.path(), options));
    } catch (const Error& e) {
        fuzz::demand(std::string(e.what()).size() > 10, "a sentence");
    }
    return 0;
}

std::vector<std::string> fuzz::seeds()
{
    std::vector<std::string> all;
    const auto name = "/tmp/excursion-fuzz-" + std::to_string(getpid()) + ".mat";
    for (const auto version : {MAT_FT_MAT5, MAT_FT_MAT73, MAT_FT_MAT4})
        for (const auto compression : {MAT_COMPRESSION_NONE, MAT_COMPRESSION_ZLIB}) {
            auto* mat = Mat_CreateVer(name.c_str(), nullptr, version);
            const auto add = [&](const char* variable, std::size_t rows, std::size_t columns,
                                 std::vector<double> values) {
                values.resize(rows * columns, 0.5);
                std::size_t dims[] {rows, columns};
                auto* made = Mat_VarCreate(variable, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, values.data(), 0);
                Mat_VarWrite(mat, made, compression);
                Mat_VarFree(made);
            };
            add("voltage", 1, 6, {1, 2, 3, 4, 5, 6});
            add("current", 6, 1, {1, 2, 3, 4, 5, 6});
            add("data", 2, 6, {1, 2, 3});
            add("fs", 1, 1, {1000});
            Mat_Close(mat);
            std::ifstream file(name, std::ios::binary);
            const std::string bytes {std::istreambuf_iterator<char>(file), {}};
            all.push_back('\0' + bytes);
            all.push_back('\1' + bytes);
            unlink(name.c_str());
        }
    return all;
}
