// SPDX-License-Identifier: GPL-3.0-or-later
#include "Audio/Stream.h"
#include "Cli/Terminal.h"
#include "Cli/Verbs.h"
#include "Engine/Document/DocumentFormat.h"
#include "Engine/Document/Words.h"
#include "Engine/Error.h"

#include <Eigen/Core>
#include <ceres/version.h>
#include <fftw3.h>
#include <nlohmann/json.hpp>
#include <sndfile.h>
#include <soxr.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <thread>

#if __has_include(<dlfcn.h>)
#include <dlfcn.h>
#endif

namespace excursion::cli {
namespace {

namespace fs = std::filesystem;

/// One thing that Excursion is made of, or can use.
struct Finding {
    std::string id, what;
    std::optional<std::string> found;  ///< which, or where; empty: missing
    std::string advice;                ///< what to do where it is missing, and what for
};

std::vector<fs::path> foldersOf(const char* variable, char separator)
{
    std::vector<fs::path> folders;
    const char* const list = std::getenv(variable);
    std::string rest = list != nullptr ? list : "";
    while (!rest.empty()) {
        const auto end = rest.find(separator);
        if (const auto folder = rest.substr(0, end); !folder.empty())
            folders.emplace_back(folder);
        rest = end == std::string::npos ? "" : rest.substr(end + 1);
    }
    return folders;
}

std::optional<std::string> firstOf(const std::vector<fs::path>& folders, const std::vector<std::string>& names)
{
    std::error_code none;
    for (const auto& name : names)
        for (const auto& folder : folders)
            if (fs::exists(folder / name, none))
                return (folder / name).string();
    return std::nullopt;
}

#ifdef _WIN32
constexpr char pathSeparator = ';';
#else
constexpr char pathSeparator = ':';
#endif

std::optional<std::string> program(const std::vector<std::string>& names)
{
    return firstOf(foldersOf("PATH", pathSeparator), names);
}

/// A shared library that other parts load when it is there.
std::optional<std::string> sharedLibrary(const std::string& name)
{
#if __has_include(<dlfcn.h>)
    if (void* const handle = dlopen(name.c_str(), RTLD_LAZY | RTLD_LOCAL)) {
        dlclose(handle);
        return name;
    }
#endif
    return std::nullopt;
}

/// The sound cards that ALSA names, "0 PCH, 1 USB".
std::optional<std::string> soundCards()
{
    std::string cards, line;
    std::ifstream file("/proc/asound/cards");  // " 0 [PCH            ]: HDA-Intel - HDA Intel PCH"
    while (std::getline(file, line)) {
        const auto open = line.find('['), close = line.find(']');
        if (open == std::string::npos || close == std::string::npos || line.find_first_not_of(' ') > open)
            continue;
        const auto number = line.substr(0, open), name = line.substr(open + 1, close - open - 1);
        cards += (cards.empty() ? "" : ", ") + std::string(trimmed(number)) + " " + std::string(trimmed(name));
    }
    return cards.empty() ? std::nullopt : std::optional(cards);
}

std::string processor()
{
#if defined(__x86_64__) && defined(__GNUC__)
    const bool today = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")
                       && __builtin_cpu_supports("bmi2");
    const std::string kind = today ? "x86-64 with AVX2 and FMA, which are used"
                                   : "x86-64 without AVX2: what runs all the time is slower";
#else
    const std::string kind = "no kernels of its own";
#endif
    return kind + "; " + std::to_string(std::thread::hardware_concurrency()) + " threads";
}

std::string builtWith()
{
#if defined(__clang__)
    const std::string compiler = "clang " + std::to_string(__clang_major__) + "." + std::to_string(__clang_minor__);
#elif defined(__GNUC__)
    const std::string compiler = "gcc " + std::to_string(__GNUC__) + "." + std::to_string(__GNUC_MINOR__);
#else
    const std::string compiler = "a compiler that is not known here";
#endif
    return compiler + ", Eigen " + std::to_string(EIGEN_WORLD_VERSION) + "." + std::to_string(EIGEN_MAJOR_VERSION) + "."
           + std::to_string(EIGEN_MINOR_VERSION) + ", Ceres " + CERES_VERSION_STRING + ", " + fftw_version + ", "
           + sf_version_string() + ", " + soxr_version();
}

/// Where plugins of a format are looked for: the user's folder, the system's, and what a variable names.
std::vector<fs::path> pluginFolders(const std::string& format, const char* variable)
{
    auto folders = variable != nullptr ? foldersOf(variable, pathSeparator) : std::vector<fs::path> {};
    if (const char* const home = std::getenv("HOME"))
        folders.push_back(fs::path(home) / ("." + format));
    for (const char* const folder : {"/usr/local/lib", "/usr/lib"})
        folders.push_back(fs::path(folder) / format);
    return folders;
}

/// Beside the program, wherever it was installed; without /proc where it usually is.
std::optional<std::string> presets()
{
    std::error_code none;
    std::vector<fs::path> folders {"/usr/local/share/excursion", "/usr/share/excursion"};
    if (const auto self = fs::read_symlink("/proc/self/exe", none); !none)
        folders.insert(folders.begin(), self.parent_path().parent_path() / "share/excursion");
    return firstOf(folders, {"presets"});
}

/// What `measure` reaches devices through.
Finding audioBackends()
{
    Finding finding {"audio", "audio backends", std::nullopt, ""};
    try {
        finding.found = audio::openSystem()->description();
    } catch (const Error& e) {
        finding.advice = e.what();
    }
    return finding;
}

std::vector<Finding> examine()
{
    const std::string plugin = "a build with -DEXCURSION_PLUGIN=ON has it";
    return {
        {"version", "Excursion", EXCURSION_VERSION, ""},
        {"built-with", "built with", builtWith(), ""},
        {"processor", "processor", processor(), ""},
        {"presets", "factory presets", presets(), "they come with cmake --install; in the sources they are in Presets"},
        {"gnuplot", "gnuplot", program({"gnuplot", "gnuplot.exe"}),
         "for the plots of reports: apt install gnuplot-nox"},
        audioBackends(),
        {"alsa", "ALSA", sharedLibrary("libasound.so.2"), "for measuring: apt install libasound2"},
        {"sound-cards", "sound cards", soundCards(), "for measuring: connect an interface with two inputs"},
        {"jack", "JACK", sharedLibrary("libjack.so.0"),
         "optional, for measuring through a JACK server: apt install libjack-jackd2-0"},
        {"app", "app", program({"excursion-app"}), plugin},
        {"vst3", "VST3 plugin", firstOf(pluginFolders("vst3", nullptr), {"Excursion.vst3"}), plugin},
        {"lv2", "LV2 plugin", firstOf(pluginFolders("lv2", "LV2_PATH"), {"Excursion.lv2"}), plugin},
        {"host", "plugin host",
         program({"ardour", "ardour8", "ardour7", "carla", "reaper", "bitwig-studio", "qtractor", "zrythm", "jalv"}),
         "to use the plugin: apt install ardour, or any host of VST3 or LV2"},
    };
}

void run(Terminal& terminal)
{
    nlohmann::ordered_json document = DocumentFormat {"excursion-doctor"}.with();
    document["findings"] = nlohmann::ordered_json::array();
    std::vector<std::vector<std::string>> rows;
    for (const auto& finding : examine()) {
        rows.push_back({finding.what, finding.found.value_or("missing: " + finding.advice)});
        document["findings"].push_back({{"id", finding.id},
                                        {"what", finding.what},
                                        {"present", finding.found.has_value()},
                                        {"found", finding.found ? nlohmann::ordered_json(*finding.found) : nullptr},
                                        {"advice", finding.found ? nullptr : nlohmann::ordered_json(finding.advice)}});
    }
    terminal.table({"part", "found"}, rows);
    terminal.document(document);
}

}  // namespace

void addDoctor(CLI::App& app, Terminal& terminal)
{
    auto* verb = app.add_subcommand(
                        "doctor",
                        "Which parts of Excursion and of its optional tools are installed, and how to install the rest")
                     ->group(step::around);
    verb->footer("Something missing is not a failure: the exit code is 0.");
    verb->callback([&terminal] { run(terminal); });
}

}  // namespace excursion::cli
