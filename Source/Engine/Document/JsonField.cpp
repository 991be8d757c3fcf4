// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Document/JsonField.h"

#include "Engine/Document/Figures.h"
#include "Engine/Document/TextFile.h"
#include "Engine/Error.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

std::string expectedWithin(double least, double most)
{
    if (least > std::numeric_limits<double>::lowest() && most < std::numeric_limits<double>::max())
        return "a number from " + shortestText(least) + " to " + shortestText(most);
    if (least > std::numeric_limits<double>::lowest())
        return "a number of at least " + shortestText(least);
    return "a number of at most " + shortestText(most);
}

}  // namespace

JsonField::JsonField(const nlohmann::json& value, std::string path, std::string source)
    : value_(value), path_(std::move(path)), source_(std::move(source))
{
}

void JsonField::refuse(const std::string& expected) const
{
    constexpr std::size_t most = 60;  // characters, and so many items at least
    const bool deep = value_.is_structured()
                      && (value_.size() > most || std::any_of(value_.begin(), value_.end(), [](const auto& v) {
                              return v.is_structured();
                          }));
    auto found = deep ? std::string() : value_.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    if (deep || found.size() > most)
        found = "a long " + std::string(value_.type_name());
    const auto what = path_.empty() ? std::string("the document") : "field '" + path_ + "'";
    throw Error(Error::Kind::input, "'" + source_ + "': " + what + " is " + found + ", expected " + expected + ".");
}

bool JsonField::has(const char* key) const
{
    return value_.is_object() && value_.contains(key) && !value_.at(key).is_null();
}

JsonField JsonField::at(const char* key) const
{
    if (!value_.is_object())
        refuse("an object");
    const auto name = path_.empty() ? std::string(key) : path_ + "." + key;
    if (!value_.contains(key))
        throw Error(Error::Kind::input, "'" + source_ + "': field '" + name
                                            + "' is missing; the file is not whole, or another program wrote it.");
    return {value_.at(key), name, source_};
}

std::vector<JsonField> JsonField::items() const
{
    if (!value_.is_array())
        refuse("an array");
    std::vector<JsonField> fields;
    for (std::size_t i = 0; i < value_.size(); ++i)
        fields.emplace_back(value_[i], path_ + "[" + std::to_string(i) + "]", source_);
    return fields;
}

std::vector<std::string> JsonField::keys() const
{
    if (!value_.is_object())
        refuse("an object");
    std::vector<std::string> names;
    for (const auto& item : value_.items())
        names.push_back(item.key());
    return names;
}

std::string JsonField::text(const std::string& expected) const
{
    if (!value_.is_string())
        refuse(expected);
    return value_.get<std::string>();
}

std::string JsonField::textIn(const char* key) const { return has(key) ? at(key).text() : std::string(); }

bool JsonField::flag() const
{
    if (!value_.is_boolean())
        refuse("true or false");
    return value_.get<bool>();
}

double JsonField::number() const
{
    if (!value_.is_number() || !std::isfinite(value_.get<double>()))
        refuse("a finite number");
    return value_.get<double>();
}

std::optional<double> JsonField::optionalNumber() const
{
    if (isNull())
        return std::nullopt;
    return number();
}

double JsonField::numberOrNaN() const
{
    if (isNull())
        return std::numeric_limits<double>::quiet_NaN();
    if (!value_.is_number() || !std::isfinite(value_.get<double>()))
        refuse("a finite number or null");
    return value_.get<double>();
}

double JsonField::numberWithin(double least, double most) const
{
    const double found = number();
    if (found < least || found > most)
        refuse(expectedWithin(least, most));
    return found;
}

int JsonField::count(int least, int most) const
{
    const double found = value_.is_number() ? value_.get<double>() : std::numeric_limits<double>::quiet_NaN();
    if (!(found >= least && found <= most) || found != std::floor(found))  // 4.0 is as good as 4
        refuse("a whole number from " + std::to_string(least) + " to " + std::to_string(most));
    return static_cast<int>(found);
}

std::vector<double> JsonField::numbers() const
{
    std::vector<double> values;
    for (const auto& item : items())
        values.push_back(item.numberOrNaN());
    return values;
}

std::string JsonField::oneOf(const std::vector<std::string>& known) const
{
    if (value_.is_string() && std::find(known.begin(), known.end(), value_.get<std::string>()) != known.end())
        return value_.get<std::string>();
    std::string list;
    for (std::size_t k = 0; k < known.size(); ++k)
        list += (k == 0 ? "" : k + 1 == known.size() ? " or " : ", ") + known[k];
    refuse(list);
}

void requireShallow(std::string_view text, const std::string& source)
{
    constexpr int deepest = 200;  // far more than any document has, far less than a stack holds
    int depth = 0;
    bool inText = false;
    for (std::size_t k = 0; k < text.size(); ++k) {
        const char c = text[k];
        if (inText && c == '\\')
            ++k;
        else if (c == '"')
            inText = !inText;
        else if (!inText && (c == '[' || c == '{') && ++depth > deepest)
            throw Error(Error::Kind::input, "'" + source + "' is not a document of ours: it is nested more than "
                                                + std::to_string(deepest) + " deep.");
        else if (!inText && (c == ']' || c == '}'))
            --depth;
    }
}

nlohmann::json readJson(const std::filesystem::path& path)
{
    const auto text = readText(path);
    requireShallow(text, path.string());
    try {
        return nlohmann::json::parse(text);
    } catch (const nlohmann::json::exception& e) {  // its text names line and column
        throw Error(Error::Kind::input, "'" + path.string() + "' is not a JSON document: " + e.what() + ".");
    }
}

}  // namespace excursion
