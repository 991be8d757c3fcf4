// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace excursion::cli {

/// What follows an option.
struct ValueType {
    std::string word;                  ///< for the value, "NUMBER"
    std::vector<std::string> choices;  ///< "pink", "white"; empty when it is free
};

/// CLI11 tells the type of an option and what checks it in one text: "TEXT", "TEXT:{pink,white}", "FLOAT in [1 - 120]".
ValueType valueTypeOf(const CLI::Option&);

/// How --help is set: what must be given stands in the line of usage, an option beside a word for its value, and
/// choices and defaults in the sentence that describes it.
class Help : public CLI::Formatter {
public:
    Help() { column_width(26); }

    std::string make_usage(const CLI::App*, std::string name) const override;
    std::string make_subcommand(const CLI::App*) const override;
    std::string make_option_opts(const CLI::Option*) const override;
    std::string make_option_desc(const CLI::Option*) const override;
};

}  // namespace excursion::cli
