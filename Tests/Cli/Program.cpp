// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Program.h"

#include "Scratch.h"

#include <algorithm>
#include <chrono>
#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

extern char** environ;

namespace excursion::test {
namespace {

namespace fs = std::filesystem;

std::string takeAway(const fs::path& file)
{
    auto text = bytesOf(file);
    fs::remove(file);
    return text;
}

}  // namespace

Outcome runProgram(const fs::path& scratch, const std::vector<std::string>& arguments, const std::string& early)
{
    const auto out = scratch.string() + ".stdout", err = scratch.string() + ".stderr";
    std::vector<std::string> words {EXCURSION_PROGRAM_PATH};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (auto& word : words)
        argv.push_back(word.data());
    argv.push_back(nullptr);

    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    posix_spawn_file_actions_addopen(&files, STDERR_FILENO, err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    pid_t child = 0;
    const int failed = posix_spawn(&child, EXCURSION_PROGRAM_PATH, &files, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&files);
    REQUIRE(failed == 0);

    Outcome outcome;
    int status = 0;
    if (!early.empty())
        while (waitpid(child, &status, WNOHANG) == 0) {
            outcome.spokeEarly = outcome.spokeEarly || bytesOf(out).find(early) != std::string::npos;
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
    else
        waitpid(child, &status, 0);
    outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
    outcome.out = takeAway(out);
    outcome.err = takeAway(err);
    return outcome;
}

std::vector<std::string> contents(const fs::path& folder)
{
    std::vector<std::string> list;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        list.push_back(entry.path().string()
                       + (entry.is_regular_file() ? " " + std::to_string(entry.file_size()) : ""));
    std::sort(list.begin(), list.end());
    return list;
}

}  // namespace excursion::test
