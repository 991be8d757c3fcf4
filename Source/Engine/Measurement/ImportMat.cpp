// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Measurement/ImportMat.h"

#include "Engine/Document/TextFile.h"
#include "Engine/Error.h"

#include <matio.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>

namespace excursion {
namespace {

using Kind = Error::Kind;

struct CloseFile {
    void operator()(mat_t* file) const { Mat_Close(file); }
};
struct FreeVariable {
    void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};
using MatFile = std::unique_ptr<mat_t, CloseFile>;
using Variable = std::unique_ptr<matvar_t, FreeVariable>;

template <class Number>
std::vector<double> converted(const void* data, std::size_t count)
{
    const auto* numbers = static_cast<const Number*>(data);
    return {numbers, numbers + count};
}

std::vector<double> numbersOf(const matvar_t& variable, std::size_t count)
{
    switch (variable.class_type) {
    case MAT_C_DOUBLE: return converted<double>(variable.data, count);
    case MAT_C_SINGLE: return converted<float>(variable.data, count);
    case MAT_C_INT8: return converted<std::int8_t>(variable.data, count);
    case MAT_C_UINT8: return converted<std::uint8_t>(variable.data, count);
    case MAT_C_INT16: return converted<std::int16_t>(variable.data, count);
    case MAT_C_UINT16: return converted<std::uint16_t>(variable.data, count);
    case MAT_C_INT32: return converted<std::int32_t>(variable.data, count);
    case MAT_C_UINT32: return converted<std::uint32_t>(variable.data, count);
    default: return {};
    }
}

/// A MAT file and the sentences about it.
class Reader {
public:
    explicit Reader(const std::filesystem::path& path) : source_(path.string())
    {
        size_ = sizeOfFile(path);
        file_.reset(Mat_Open(source_.c_str(), MAT_ACC_RDONLY));
        if (!file_)
            refuse(Kind::input, "is not a readable MATLAB MAT file.");
        std::size_t count = 0;
        auto* const* names = Mat_GetDir(file_.get(), &count);
        for (std::size_t i = 0; names && i < count; ++i)
            if (names[i])
                names_.emplace_back(names[i]);
    }

    const std::vector<std::string>& names() const { return names_; }

    bool has(const std::string& name) const { return std::find(names_.begin(), names_.end(), name) != names_.end(); }

    std::vector<double> vector(const std::string& name)
    {
        if (!has(name)) {
            std::string all;
            for (const auto& other : names_)
                all += (all.empty() ? "" : ", ") + other;
            refuse(Kind::usage, "has no variable '" + name + "'; it has " + (all.empty() ? "none" : all) + ".");
        }
        const Variable info(Mat_VarReadInfo(file_.get(), name.c_str()));
        const auto count = info ? elements(*info) : 0;
        if (count == 0 || count > mostElements())
            refuse(Kind::input, "does not hold the samples that its variable '" + name + "' claims; it is damaged or empty.");
        const Variable variable(Mat_VarRead(file_.get(), name.c_str()));
        if (!variable || !variable->data || variable->isComplex || variable->rank != 2
            || (variable->dims[0] != 1 && variable->dims[1] != 1))
            refuse(Kind::input, "has a variable '" + name + "' that is not a real vector of numbers, or is damaged.");
        const auto numbers = variable->nbytes / std::max(1, variable->data_size) >= count ? numbersOf(*variable, count)
                                                                                          : std::vector<double> {};
        if (numbers.size() != count)
            refuse(Kind::input, "has a variable '" + name + "' that is not a real vector of numbers, or is damaged.");
        for (std::size_t n = 0; n < count; ++n)
            if (!std::isfinite(numbers[n]))
                refuse(Kind::input, "has a variable '" + name + "' whose sample " + std::to_string(n) + " is not a finite number.");
        return numbers;
    }

private:
    [[noreturn]] void refuse(Kind kind, const std::string& why) const { throw Error(kind, "'" + source_ + "' " + why); }

    /// The elements of a variable; 0 when their count overflows.
    static std::size_t elements(const matvar_t& info)
    {
        std::size_t count = 1;
        for (int d = 0; d < info.rank; ++d)
            if (__builtin_mul_overflow(count, info.dims[d], &count))
                return 0;
        return count;
    }

    /// zlib cannot compress more than about 1032 to one, so nothing larger can be in the file.
    std::uintmax_t mostElements() const { return size_ * 1100; }

    std::string source_;
    std::uintmax_t size_ = 0;
    MatFile file_;
    std::vector<std::string> names_;
};

} // namespace

Measurement importMat(const std::filesystem::path& path, const ImportOptions& options)
{
    Reader file(path);
    auto columns = options.columns;
    if (columns.empty())
        for (const auto& name : file.names())
            if (const auto found = columnNamed(name))
                columns.push_back(*found);
    double sampleRate = options.sampleRate;
    for (const char* name : {"fs", "Fs", "sampleRate", "sample_rate"})
        if (sampleRate == 0 && file.has(name))
            sampleRate = file.vector(name).front();
    std::vector<std::vector<double>> samples;
    for (const auto& mapped : columns)
        samples.push_back(file.vector(mapped.column));
    return measurementOfColumns(columns, samples, sampleRate, options, path.string());
}

} // namespace excursion
