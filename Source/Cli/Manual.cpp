// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Manual.h"

#include "Cli/Help.h"

#include "Engine/Document/Words.h"
#include "Engine/Loudspeaker/Catalogue.h"

#include <algorithm>
#include <string_view>

namespace excursion::cli {
namespace {

std::vector<const CLI::App*> verbsOf(const CLI::App& app)
{
    return app.get_subcommands([](const CLI::App*) { return true; });
}

/// What a person is shown: options without a group are hidden.
std::vector<const CLI::Option*> shownOptions(const CLI::App& app)
{
    return app.get_options([](const CLI::Option* option) { return !option->get_group().empty(); });
}

/// Text as roff takes it: no minus that is a hyphen, no line that is a request.
std::string roff(std::string_view text)
{
    std::string result;
    bool begins = true;
    for (const char c : text) {
        if (begins && (c == '.' || c == '\''))
            result += "\\&";
        if (c == '\\')
            result += "\\e";
        else if (c == '-')
            result += "\\-";
        else
            result += c;
        begins = c == '\n';
    }
    return result;
}

/// The same in one line, whatever width it was broken for.
std::string oneLine(std::string text)
{
    std::replace(text.begin(), text.end(), '\n', ' ');
    const auto twice = [](char a, char b) { return a == ' ' && b == ' '; };
    text.erase(std::unique(text.begin(), text.end(), twice), text.end());
    const auto first = text.find_first_not_of(' '), last = text.find_last_not_of(' ');
    return first == std::string::npos ? "" : roff(text.substr(first, last - first + 1));
}

std::string asTyped(const std::string& text) { return text.empty() ? "" : ".EX\n" + roff(text) + "\n.EE\n"; }

std::string optionEntry(const Help& help, const CLI::Option& option)
{
    return ".TP\n.B " + oneLine(option.get_name(option.get_positional(), true) + help.make_option_opts(&option)) + "\n"
           + oneLine(help.make_option_desc(&option)) + "\n";
}

std::string verbSection(const Help& help, const CLI::App& verb)
{
    std::string text = ".SS " + roff(verb.get_name()) + "\n" + oneLine(verb.get_description()) + ".\n.PP\n.B "
                       + oneLine(help.make_usage(&verb, "excursion " + verb.get_name())) + "\n";
    for (const auto* option : shownOptions(verb))
        if (option->get_name() != "--help")
            text += optionEntry(help, *option);
    if (const auto footer = verb.get_footer(); !footer.empty())
        text += ".PP\n" + oneLine(footer) + "\n";
    return text;
}

/// Words between blanks, each quoted for the shell.
std::string shellWords(const std::vector<std::string>& words)
{
    const auto text = joined(words, " ");
    return "'" + text + "'";
}

std::vector<std::string> longNames(const CLI::App& app)
{
    std::vector<std::string> names;
    for (const auto* option : shownOptions(app))
        for (const auto& name : option->get_lnames())
            names.push_back("--" + name);
    return names;
}

std::vector<std::string> effectNames()
{
    std::vector<std::string> names;
    for (const auto* effect : catalogue())
        names.push_back(effect->id());
    return names;
}

/// The branches that say what may follow an option.
std::string valueBranches(const CLI::App& verb)
{
    std::string text;
    for (const auto* option : shownOptions(verb)) {
        if (option->get_positional() || option->get_type_size() == 0)
            continue;
        const auto type = valueTypeOf(*option);
        std::string what = "''";  // a number, or a name that is not known here
        if (type.word == "EFFECT")
            what = shellWords(effectNames());
        else if (!type.choices.empty())
            what = shellWords(type.choices);
        else if (type.word == "FILE" || type.word == "DIR" || type.word == "[FILE.json]")
            what = "files";
        for (const auto& name : option->get_lnames())
            text += "    '" + verb.get_name() + " --" + name + "') values=" + what + " ;;\n";
    }
    return text;
}

}  // namespace

std::string manualOf(const CLI::App& app, const std::string& version)
{
    const Help help;
    std::string text =
        ".TH EXCURSION 1 \"\" \"Excursion " + roff(version)
        + "\" \"User Commands\"\n"
          ".SH NAME\nexcursion \\- finds out what a loudspeaker model is missing, and linearizes the loudspeaker\n"
          ".SH SYNOPSIS\n.B excursion\n.I VERB\n\\&...\n"
          ".SH DESCRIPTION\n"
        + asTyped(app.get_description()) + ".SH OPTIONS\nOf every verb:\n";
    for (const auto* option : shownOptions(app))
        text += optionEntry(help, *option);
    std::string group;
    for (const auto* verb : verbsOf(app)) {
        if (verb->get_group() != group)
            text += ".SH \"" + roff(group = verb->get_group()) + "\"\n";
        text += verbSection(help, *verb);
    }
    return text + ".SH EXIT STATUS\n" + asTyped(app.get_footer()) + ".SH SEE ALSO\n.BR gnuplot (1)\n";
}

std::string bashCompletionOf(const CLI::App& app)
{
    std::vector<std::string> verbs;
    std::string options, values = valueBranches(app);
    for (const auto* verb : verbsOf(app)) {
        verbs.push_back(verb->get_name());
        auto names = longNames(*verb);
        for (const auto& name : longNames(app))
            if (name != "--help" && name != "--version")
                names.push_back(name);
        options += "    " + verb->get_name() + ") options=" + shellWords(names) + " ;;\n";
        values += valueBranches(*verb);
    }
    return R"(# bash completion of excursion, printed by excursion --bash-completion
_excursion()
{
    local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]} verb='' word options values=files
    COMPREPLY=()
    for word in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
        case $word in -*) ;; *) verb=$word; break ;; esac
    done
    case $verb in
    '') options=)"
           + shellWords(longNames(app)) + " values=" + shellWords(verbs) + " ;;\n" + options + R"(    *) return ;;
    esac
    case "$verb $prev" in
    'add '*) [[ $prev == -* || $prev == add ]] || values=)"
           + shellWords(effectNames()) + R"( ;;
    'effects '*) values=)"
           + shellWords(effectNames()) + R"( ;;
    esac
    case "$verb $prev" in
)" + values + R"(    esac
    if [[ $cur == -* ]]; then
        COMPREPLY=($(compgen -W "$options" -- "$cur"))
    elif [[ $values == files ]]; then
        compopt -o filenames
        COMPREPLY=($(compgen -f -- "$cur"))
    else   # of a list with commas, the last one
        local before=''
        [[ $cur != *,* ]] || before=${cur%,*},
        COMPREPLY=($(compgen -W "$values" -P "$before" -- "${cur##*,}"))
    fi
}
complete -F _excursion excursion
)";
}

}  // namespace excursion::cli
