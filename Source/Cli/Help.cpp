// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Help.h"

#include "Cli/Terminal.h"
#include "Engine/Document/Words.h"

namespace excursion::cli {
namespace {

constexpr std::size_t lineWidth = 112;

bool takesMany(const CLI::Option& option) { return option.get_expected_max() > 1; }

std::string valueWord(const CLI::Option& option)
{
    if (option.get_type_size() == 0)
        return "";
    const auto word = valueTypeOf(option).word;
    return " " + word + (option.get_expected_max() > 2 ? ",.." : takesMany(option) ? "," + word : "");
}

/// "[0.5,1.5,4]" as it would be typed.
std::string defaultOf(const CLI::Option& option)
{
    auto text = option.get_default_str();
    if (text.size() > 2 && text.front() == '[' && text.back() == ']')
        text = text.substr(1, text.size() - 2);
    return text;
}

}  // namespace

ValueType valueTypeOf(const CLI::Option& option)
{
    const auto text = option.get_type_name();
    ValueType type;
    type.word = text.substr(0, text.find_first_of(": "));
    if (type.word == "TEXT")
        type.word = "NAME";
    else if (type.word == "FLOAT" || type.word == "INT" || type.word == "UINT")
        type.word = "NUMBER";
    const auto open = text.find('{'), close = text.rfind('}');
    if (open != std::string::npos && close != std::string::npos)
        type.choices = CLI::detail::split(text.substr(open + 1, close - open - 1), ',');
    return type;
}

std::string Help::make_usage(const CLI::App* app, std::string name) const
{
    std::string text = "\nUsage: " + name;
    bool choices = false;
    for (const auto* option : app->get_options())
        if (option->get_positional())
            text += " " + make_option_usage(option);
    for (const auto* option : app->get_options()) {
        if (option->get_positional())
            continue;
        if (option->get_required())
            text += " " + option->get_name() + valueWord(*option);
        else
            choices = choices || option->get_name() != "--help";
    }
    if (!app->get_subcommands([](const CLI::App*) { return true; }).empty())
        return text + " VERB ...\n";
    return text + (choices ? " [OPTIONS]\n" : "\n");
}

std::string Help::make_subcommand(const CLI::App* verb) const
{
    constexpr std::size_t column = 14;
    const auto name = "  " + verb->get_name();
    return wrapped(name + std::string(column - std::min(column, name.size()), ' ') + verb->get_description(), column,
                   lineWidth)
           + "\n";
}

std::string Help::make_option_opts(const CLI::Option* option) const
{
    return option->get_positional() ? "" : valueWord(*option);
}

std::string Help::make_option_desc(const CLI::Option* option) const
{
    auto text = option->get_description();
    if (const auto choices = valueTypeOf(*option).choices; !choices.empty())
        text += "; one of " + joined(choices);
    if (const auto value = defaultOf(*option); !value.empty() && option->get_type_size() != 0)
        text += " [" + value + "]";
    return wrapped(text, 0, lineWidth - get_column_width());
}

}  // namespace excursion::cli
