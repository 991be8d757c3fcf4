// SPDX-License-Identifier: GPL-3.0-or-later
#include "Report/Gnuplot.h"

#include "Engine/Error.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <fcntl.h>
#include <spawn.h>
#include <string_view>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace excursion {
namespace {

/// A pipe whose ends close themselves.
class Pipe {
public:
    Pipe()
    {
        if (::pipe(ends_.data()) != 0)
            throw Error(Error::Kind::numerical,
                        "The report cannot be drawn: the system has no pipe left; close other programs.");
        for (const int end : ends_)
            ::fcntl(end, F_SETFD, FD_CLOEXEC);  // a child that held a writing end would keep the reader waiting
    }
    ~Pipe()
    {
        closeEnd(0);
        closeEnd(1);
    }
    Pipe(const Pipe&) = delete;
    Pipe& operator=(const Pipe&) = delete;

    int reading() const { return ends_[0]; }
    int writing() const { return ends_[1]; }
    void closeEnd(std::size_t end)
    {
        if (ends_[end] >= 0)
            ::close(ends_[end]);
        ends_[end] = -1;
    }

private:
    std::array<int, 2> ends_ {-1, -1};
};

std::string readAll(int from)
{
    std::string text;
    std::vector<char> buffer(1 << 16);
    for (;;) {
        const auto got = ::read(from, buffer.data(), buffer.size());
        if (got > 0)
            text.append(buffer.data(), static_cast<std::size_t>(got));
        else if (got == 0 || errno != EINTR)
            return text;
    }
}

void writeAll(int to, std::string_view text)
{
    // A gnuplot that has died must not take this program with it.
    sigset_t pipes;
    sigemptyset(&pipes);
    sigaddset(&pipes, SIGPIPE);
    pthread_sigmask(SIG_BLOCK, &pipes, nullptr);
    while (!text.empty()) {
        const auto put = ::write(to, text.data(), text.size());
        if (put > 0)
            text.remove_prefix(static_cast<std::size_t>(put));
        else if (errno != EINTR)
            break;
    }
    // The blocked signal would wait for this thread, which ends here.
}

/// The environment without what would make gnuplot's numbers or its start depend on the user.
std::vector<std::string> plainEnvironment()
{
    std::vector<std::string> result {"LC_ALL=C.UTF-8", "GNUTERM=svg"};
    for (char** entry = environ; *entry != nullptr; ++entry) {
        const std::string_view text(*entry);
        if (!text.starts_with("LC_") && !text.starts_with("LANG") && !text.starts_with("GNU"))
            result.emplace_back(text);
    }
    return result;
}

}  // namespace

std::string runGnuplot(const std::string& script)
{
    Pipe input, output, complaints;
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, input.reading(), 0);
    posix_spawn_file_actions_adddup2(&actions, output.writing(), 1);
    posix_spawn_file_actions_adddup2(&actions, complaints.writing(), 2);

    std::string program = "gnuplot", noStartFiles = "-d", fromInput = "-";
    std::array<char*, 4> arguments {program.data(), noStartFiles.data(), fromInput.data(), nullptr};
    auto environment = plainEnvironment();
    std::vector<char*> pointers;
    for (auto& entry : environment)
        pointers.push_back(entry.data());
    pointers.push_back(nullptr);
    pid_t process = 0;
    const int failure = posix_spawnp(&process, program.c_str(), &actions, nullptr, arguments.data(), pointers.data());
    posix_spawn_file_actions_destroy(&actions);
    if (failure != 0)
        throw Error(Error::Kind::numerical, "The report's plots are drawn by gnuplot, which was not found; install it "
                                            "(on Debian: apt install gnuplot-nox) and run excursion report again.");
    input.closeEnd(0);
    output.closeEnd(1);
    complaints.closeEnd(1);

    // Three pipes at once, or a full one would stop both sides for ever.
    std::string said;
    std::jthread writer([&] {
        writeAll(input.writing(), script);
        input.closeEnd(1);
    });
    std::jthread listener([&] { said = readAll(complaints.reading()); });
    auto text = readAll(output.reading());
    writer.join();
    listener.join();
    int status = 0;
    while (waitpid(process, &status, 0) < 0 && errno == EINTR) {}
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
        throw Error(Error::Kind::numerical, "gnuplot failed to draw the report's plots: "
                                                + (said.empty() ? std::string("it said nothing") : said.substr(0, 400))
                                                + "; see whether gnuplot runs by itself.");
    return text;
}

}  // namespace excursion
