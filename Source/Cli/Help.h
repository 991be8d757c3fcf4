// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/CLI.hpp>

namespace excursion::cli {

/// How --help is set: what must be given stands in the line of usage, an option beside a word for its value, and choices and
/// defaults in the sentence that describes it.
class Help : public CLI::Formatter {
public:
    Help() { column_width(26); }

    std::string make_usage(const CLI::App*, std::string name) const override;
    std::string make_subcommand(const CLI::App*) const override;
    std::string make_option_opts(const CLI::Option*) const override;
    std::string make_option_desc(const CLI::Option*) const override;
};

} // namespace excursion::cli
