// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Import/ImportMat.h"

#include "Engine/Document/TextFile.h"
#include "Engine/Error.h"

#include <hdf5.h>
#include <matio.h>

#include <algorithm>
#include <charconv>
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
        // what is wrong is told in our own words, not by a stack of HDF5's
        H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
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

    /// What a column of a mapping means: "V1" a vector, "data(2)" the second row or column of a matrix, whichever runs
    /// the shorter way; "2" the same of the only matrix of the file.
    std::vector<double> signal(const std::string& column)
    {
        if (has(column))
            return vector(column);
        std::size_t number = 0;
        std::string name;
        if (const auto open = column.find('('); open != std::string::npos && column.back() == ')') {
            name = column.substr(0, open);
            number = numberIn(column.substr(open + 1, column.size() - open - 2));
        } else if ((number = numberIn(column)) > 0) {
            name = onlyMatrix();
        }
        if (number == 0 || !has(name))
            refuse(Kind::usage, "has no variable '" + column + "'; it has " + described() + ".");
        const auto matrix = read(name);
        const std::size_t rows = matrix.rows, columns = matrix.columns, shorter = std::min(rows, columns);
        if (rows == columns)
            refuse(Kind::input, "has a square matrix '" + name
                                    + "', so it does not tell which way time runs; save its signals as vectors.");
        if (number > shorter)
            refuse(Kind::usage, "has " + std::to_string(shorter) + " signals in '" + name + "', but number "
                                    + std::to_string(number) + " was mapped.");
        std::vector<double> signal;
        for (std::size_t n = 0; n < std::max(rows, columns); ++n)
            signal.push_back(matrix.values[rows < columns ? n * rows + number - 1 : (number - 1) * rows + n]);
        return signal;
    }

    std::vector<double> vector(const std::string& name)
    {
        auto matrix = read(name);
        if (matrix.rows != 1 && matrix.columns != 1)
            refuse(Kind::usage, "has a variable '" + name + "' that is a matrix of " + std::to_string(matrix.rows)
                                    + " x " + std::to_string(matrix.columns)
                                    + "; map its signals by number, for example --map '" + name + "(1)=voltage'.");
        return std::move(matrix.values);
    }

    /// "V1 (1 x 500), data (3 x 4000)"; "none".
    std::string described()
    {
        std::string all;
        for (const auto& name : names_) {
            const Variable info(Mat_VarReadInfo(file_.get(), name.c_str()));
            all += (all.empty() ? "" : ", ") + name;
            if (info && info->rank == 2)
                all += " (" + std::to_string(info->dims[0]) + " x " + std::to_string(info->dims[1])
                       + (info->class_type == MAT_C_STRUCT ? " struct)" : ")");
        }
        return all.empty() ? "none" : all;
    }

private:
    [[noreturn]] void refuse(Kind kind, const std::string& why) const { throw Error(kind, "'" + source_ + "' " + why); }

    struct Matrix {
        std::size_t rows = 0, columns = 0;
        std::vector<double> values;  ///< column by column
    };

    /// A number from 1; 0 when the text is none.
    static std::size_t numberIn(const std::string& text)
    {
        std::size_t number = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
        return error == std::errc() && end == text.data() + text.size() ? number : 0;
    }

    std::string onlyMatrix()
    {
        std::string only;
        for (const auto& name : names_) {
            const Variable info(Mat_VarReadInfo(file_.get(), name.c_str()));
            if (!info || info->rank != 2 || info->dims[0] < 2 || info->dims[1] < 2)
                continue;
            if (!only.empty())
                refuse(Kind::usage,
                       "has more than one matrix; say which, for example --map '" + only + "(1)=voltage'.");
            only = name;
        }
        return only;
    }

    Matrix read(const std::string& name)
    {
        if (!has(name))
            refuse(Kind::usage, "has no variable '" + name + "'; it has " + described() + ".");
        const Variable info(Mat_VarReadInfo(file_.get(), name.c_str()));
        if (info && info->class_type == MAT_C_STRUCT)
            refuse(Kind::input, "has a variable '" + name
                                    + "' that is a struct; save its fields as variables of their own (save -struct).");
        const auto count = info ? elements(*info) : 0;
        if (count == 0 || count > mostElements())
            refuse(Kind::input,
                   "does not hold the samples that its variable '" + name + "' claims; it is damaged or empty.");
        const Variable variable(Mat_VarRead(file_.get(), name.c_str()));
        if (!variable || !variable->data || variable->isComplex || variable->rank != 2 || elements(*variable) != count)
            refuse(Kind::input, "has a variable '" + name + "' that is no real matrix of numbers, or is damaged.");
        Matrix matrix {variable->dims[0], variable->dims[1], {}};
        if (variable->nbytes / static_cast<std::size_t>(std::max(1, variable->data_size)) >= count)
            matrix.values = numbersOf(*variable, count);
        if (matrix.values.size() != count)
            refuse(Kind::input, "has a variable '" + name + "' that is no real matrix of numbers, or is damaged.");
        for (std::size_t n = 0; n < count; ++n)
            if (!std::isfinite(matrix.values[n]))
                refuse(Kind::input,
                       "has a variable '" + name + "' whose sample " + std::to_string(n) + " is not a finite number.");
        return matrix;
    }

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

}  // namespace

namespace {

/// From the variables that are usually called so; where several tell it they must agree.
double sampleRateIn(Reader& file, const ImportOptions& options, const std::string& source,
                    std::vector<std::string>& remarks)
{
    double rate = 0.0;
    std::string toldBy;
    const auto tell = [&](double value, const std::string& name) {
        if (!(std::isfinite(value) && value > 0.0))
            throw Error(Kind::input, "'" + source + "' has a variable '" + name
                                         + "' that gives no positive sample rate; give --rate.");
        if (rate > 0.0 && std::abs(value / rate - 1.0) > 0.001)
            throw Error(Kind::input, "'" + source + "' tells two sample rates, " + std::to_string(rate) + " Hz by '"
                                         + toldBy + "' and " + std::to_string(value) + " Hz by '" + name
                                         + "'; give the right one with --rate.");
        if (rate == 0.0) {
            rate = value;
            toldBy = name;
        }
    };
    const auto tellSeconds = [&](double value, const std::string& name) {
        if (rate == 0.0)
            remarks.push_back("The sample rate of '" + source + "' is that of its variable '" + name
                              + "', taken as seconds.");
        tell(value, name);
    };
    if (options.axis) {
        tell(sampleRateOf(file.signal(options.axis->column), options.axis->factor, source), options.axis->column);
        return rate;
    }
    const auto isMapped = [&](const char* name) {
        return std::any_of(options.columns.begin(), options.columns.end(),
                           [name](const auto& c) { return c.column == name; });
    };
    for (const char* name : {"fs", "Fs", "FS", "fS", "f_s", "sampleRate", "SampleRate", "samplerate", "sample_rate",
                             "sampling_rate", "SamplingRate", "sr", "SR"})
        if (file.has(name) && !isMapped(name))
            tell(file.vector(name).front(), name);
    for (const char* name : {"dt", "Dt", "delta_t", "Ts", "T_s", "sampleTime", "SampleTime"})
        if (file.has(name) && !isMapped(name))
            tellSeconds(1.0 / file.vector(name).front(), name);
    for (const char* name : {"t", "time", "Time", "t_s", "time_s"})
        if (file.has(name) && !isMapped(name))
            if (const auto times = file.vector(name); times.size() > 2)
                tellSeconds(sampleRateOf(times, 1.0, source), name);
    return rate;
}

}  // namespace

Measurement importMat(const std::filesystem::path& path, const ImportOptions& options)
{
    const auto source = path.string();
    if (!options.responses.empty() || options.as || options.minimumPhase || (options.axis && !options.axis->isTime))
        throw Error(Kind::usage, "'" + source
                                     + "' is a MAT file, of which only time signals are read, no responses; save a "
                                       "response as a text file.");
    Reader file(path);
    auto columns = options.columns;
    if (columns.empty())
        for (const auto& name : file.names())
            if (const auto found = columnNamed(name))
                columns.push_back(*found);
    if (columns.empty())
        throw Error(Kind::input, "'" + source
                                     + "' has no variable whose name says its quantity; map them with --map of "
                                       "excursion import, for example --map V1=voltage or "
                                       "--map 'data(2)=current'. It has "
                                     + file.described() + ".");
    std::vector<std::string> remarks;
    const double sampleRate = options.sampleRate > 0.0 ? options.sampleRate
                                                       : sampleRateIn(file, options, source, remarks);
    std::vector<std::vector<double>> samples;
    for (const auto& mapped : columns)
        samples.push_back(file.signal(mapped.column));
    auto measurement = measurementOfColumns(columns, samples, sampleRate, options, source);
    measurement.remarks = std::move(remarks);
    return measurement;
}

}  // namespace excursion
