// SPDX-License-Identifier: GPL-3.0-or-later
// MAT files as MATLAB saves them, written by libmatio: versions 5 and 7.3 (HDF5).
#include "Engine/Import/ImportMat.h"
#include "Engine/Import/ReadTake.h"
#include "Scratch.h"

#include <matio.h>

#include <cmath>

using namespace excursion;
using namespace excursion::test;
using Kind = Error::Kind;

namespace {

/// A MAT file with real matrices of doubles, given column by column.
class MatWriter {
public:
    MatWriter(const std::filesystem::path& path, mat_ft version)
        : path_(path), file_(Mat_CreateVer(path.c_str(), nullptr, version))
    {
        REQUIRE(file_ != nullptr);
    }
    ~MatWriter() { Mat_Close(file_); }
    MatWriter(const MatWriter&) = delete;
    MatWriter& operator=(const MatWriter&) = delete;

    MatWriter& add(const char* name, std::size_t rows, std::size_t columns, std::vector<double> values)
    {
        REQUIRE(values.size() == rows * columns);
        std::size_t dims[] {rows, columns};
        auto* variable = Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, values.data(), 0);
        REQUIRE(Mat_VarWrite(file_, variable, MAT_COMPRESSION_ZLIB) == 0);
        Mat_VarFree(variable);
        return *this;
    }

private:
    std::filesystem::path path_;
    mat_t* file_;
};

ImportOptions mappedTo(std::initializer_list<const char*> mappings)
{
    ImportOptions options;
    for (const char* mapping : mappings)
        addMapping(options, mapping);
    return options;
}

const std::vector<double> fourOfThree {1, 10, 100, 2, 20, 200, 3, 30, 300, 4, 40, 400};  // 3 x 4, column by column
const std::vector<double> threeOfFour {1, 2, 3, 4, 10, 20, 30, 40, 100, 200, 300, 400};  // 4 x 3

}  // namespace

TEST_CASE("Rows and columns of a matrix are mapped by number, in MAT files of both kinds", "[import]")
{
    const Scratch s;
    for (const auto version : {MAT_FT_MAT5, MAT_FT_MAT73})
        for (const bool wide : {true, false}) {
            INFO((version == MAT_FT_MAT5 ? "5" : "7.3") << (wide ? ", 3 x 4" : ", 4 x 3"));
            const auto path = s / ("m" + std::to_string(version) + std::to_string(wide) + ".mat");
            {
                MatWriter mat(path, version);
                wide ? mat.add("data", 3, 4, fourOfThree) : mat.add("data", 4, 3, threeOfFour);
                mat.add("Fs", 1, 1, {48000});
            }
            for (const auto& options :
                 {mappedTo({"2=current:mA", "1=voltage", "3=displacement:um"}),
                  mappedTo({"data(2)=current:mA", "data(1)=voltage", "data(3)=displacement:um"})}) {
                const auto m = importMat(path, options);
                CHECK(m.sampleRate == 48000);
                CHECK(m.input().samples == std::vector<double> {1, 2, 3, 4});
                CHECK(m.find(Quantity::current)->samples[3] == Approx(0.04));
                CHECK(m.find(Quantity::displacement)->samples[1] == Approx(200e-6));
            }
            refused(Kind::usage, "3 signals", [&] { importMat(path, mappedTo({"4=voltage"})); });
            refused(Kind::usage, "data(1)=voltage", [&] { importMat(path, mappedTo({"data=voltage"})); });
            refused(Kind::usage, wide ? "data (3 x 4)" : "data (4 x 3)",
                    [&] { importMat(path, mappedTo({"other=voltage"})); });
            refused(Kind::input, "data(2)=current", [&] { readTake(path); });
        }
}

TEST_CASE("The sample rate of a MAT file comes from the variables that are usually called so", "[import]")
{
    const Scratch s;
    const auto rateOf = [&](auto fill) {
        const auto path = s / "r.mat";
        {
            MatWriter mat(path, MAT_FT_MAT5);
            mat.add("voltage", 1, 4, {1, 2, 3, 4}).add("current", 4, 1, {1, 2, 3, 4});
            fill(mat);
        }
        return std::get<Measurement>(readTake(path));
    };
    for (const char* name : {"fs", "Fs", "sampleRate", "sample_rate", "sr"}) {
        const auto take = rateOf([name](MatWriter& mat) { mat.add(name, 1, 1, {44100}); });
        CHECK(take.sampleRate == 44100);
        CHECK(take.remarks.empty());
    }
    for (const char* name : {"dt", "Ts"})
        CHECK(rateOf([name](MatWriter& mat) { mat.add(name, 1, 1, {0.001}); }).sampleRate == Approx(1000));
    const auto timed = rateOf([](MatWriter& mat) { mat.add("t", 4, 1, {0, 0.01, 0.02, 0.03}); });
    CHECK(timed.sampleRate == Approx(100));
    REQUIRE(timed.remarks.size() == 1);
    CHECK_THAT(timed.remarks[0], Catch::Contains("seconds"));
    CHECK(rateOf([](MatWriter& mat) {
              mat.add("t", 4, 1, {0, 0.01, 0.02, 0.03}).add("fs", 1, 1, {100});
          }).sampleRate
          == 100);
    refused(Kind::input, "two sample rates", [&] {
        rateOf([](MatWriter& mat) { mat.add("t", 1, 4, {0, 10, 20, 30}).add("fs", 1, 1, {100}); });
    });
    refused(Kind::data, "not evenly", [&] { rateOf([](MatWriter& mat) { mat.add("t", 1, 4, {0, 1, 2, 5}); }); });
    refused(Kind::input, "no positive sample rate", [&] { rateOf([](MatWriter& mat) { mat.add("fs", 1, 1, {0}); }); });
    refused(Kind::usage, "--rate", [&] { rateOf([](MatWriter&) {}); });
    const auto milliseconds = s / "ms.mat";
    {
        MatWriter(milliseconds, MAT_FT_MAT5).add("V1", 1, 3, {1, 2, 3}).add("clock", 1, 3, {0, 0.5, 1});
    }
    CHECK(importMat(milliseconds, mappedTo({"V1=voltage", "clock=time:ms"})).sampleRate == Approx(2000));
}

TEST_CASE("Matrices that cannot be signals are refused", "[import]")
{
    const Scratch s;
    {
        MatWriter(s / "two.mat", MAT_FT_MAT5)
            .add("a", 2, 4, {1, 2, 3, 4, 5, 6, 7, 8})
            .add("b", 2, 4, {1, 2, 3, 4, 5, 6, 7, 8})
            .add("fs", 1, 1, {100});
        MatWriter(s / "square.mat", MAT_FT_MAT5).add("a", 2, 2, {1, 2, 3, 4}).add("fs", 1, 1, {100});
        MatWriter(s / "nan.mat", MAT_FT_MAT5).add("a", 2, 3, {1, 2, 3, std::nan(""), 5, 6}).add("fs", 1, 1, {100});
    }
    refused(Kind::usage, "more than one matrix", [&] { importMat(s / "two.mat", mappedTo({"1=voltage"})); });
    CHECK(importMat(s / "two.mat", mappedTo({"b(2)=voltage"})).input().samples == std::vector<double> {2, 4, 6, 8});
    refused(Kind::input, "square", [&] { importMat(s / "square.mat", mappedTo({"1=voltage"})); });
    refused(Kind::input, "finite", [&] { importMat(s / "nan.mat", mappedTo({"1=voltage"})); });
    refused(Kind::usage, "responses", [&] { importMat(s / "two.mat", mappedTo({"1=impedance.re"})); });
    for (const char* kind : {"1", "9"}) {  // a file that ends early
        const auto version = *kind == '1' ? MAT_FT_MAT5 : MAT_FT_MAT73;
        {
            MatWriter(s / "whole.mat", version)
                .add("voltage", 1, 2000, std::vector<double>(2000, 1.5))
                .add("fs", 1, 1, {100});
        }
        const auto bytes = bytesOf(s / "whole.mat");
        for (const double share : {0.1, 0.5, 0.9}) {
            const auto cut = s.file(
                "cut.mat",
                std::string_view(bytes).substr(0, static_cast<std::size_t>(share * static_cast<double>(bytes.size()))));
            CHECK_THROWS_AS(importMat(cut, {}), Error);
        }
    }
}
