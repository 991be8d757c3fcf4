// SPDX-License-Identifier: GPL-3.0-or-later
// Stands in for libFuzzer: the seeds, then random mutations of them for some seconds. The same seed number, the same
// inputs.
//   fuzz_text [--seconds 3] [--seed 1] [FILE...]     files are replayed alone
#include "Fuzz/Target.h"

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <fcntl.h>
#include <fstream>
#include <iterator>
#include <random>
#include <string_view>
#include <unistd.h>

/// So that a finding of the sanitizer comes by the handler below. Without leaks: libraries keep theirs to the end. A
/// library's malloc of what a header claims may fail, our own new may not.
extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options()
{
    return "abort_on_error=1:detect_leaks=0:allocator_may_return_null=1:max_allocation_size_mb=256";
}

namespace {

std::string current;  // what is being read
constexpr std::size_t largest = 1 << 16;

void keep(int signal)
{
    const int file = open("fuzz-finding", O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (file >= 0) {
        [[maybe_unused]] const auto written = write(file, current.data(), current.size());
        close(file);
    }
    std::signal(signal, SIG_DFL);
    std::raise(signal);
}

class Mutations {
public:
    Mutations(std::vector<std::string> seeds, std::uint64_t seed) : pool_(std::move(seeds)), random_(seed) {}

    std::string next()
    {
        auto text = pool_[below(pool_.size())];
        for (auto steps = 1 + below(6); steps > 0; --steps)
            mutate(text);
        if (text.size() > largest)
            text.resize(largest);
        return text;
    }

private:
    std::size_t below(std::size_t count) { return count == 0 ? 0 : random_() % count; }

    void mutate(std::string& text)
    {
        static constexpr std::string_view tokens[] {"nan",
                                                    "inf",
                                                    "-inf",
                                                    "1e999",
                                                    "-1",
                                                    "0",
                                                    "1e-320",
                                                    "4294967296",
                                                    "18446744073709551616",
                                                    "99999999999",
                                                    "\"",
                                                    "{",
                                                    "}",
                                                    "[",
                                                    "]",
                                                    ",",
                                                    ";",
                                                    "\t",
                                                    "\r\n",
                                                    "\n",
                                                    "*",
                                                    "#",
                                                    "//",
                                                    "\xEF\xBB\xBF",
                                                    "\xFF\xFE",
                                                    "\xC3",
                                                    "\xCE\xA9",
                                                    "Ohm",
                                                    "[Hz]",
                                                    "f",
                                                    "time",
                                                    "(",
                                                    ")",
                                                    "_re",
                                                    "_im",
                                                    "/",
                                                    "dB",
                                                    "phase",
                                                    "null",
                                                    "true",
                                                    "-",
                                                    "e",
                                                    "."};
        const auto at = below(text.size() + 1), length = std::min(below(32), text.size() - at);
        switch (below(9)) {
        case 0:
            if (at < text.size())
                text[at] = static_cast<char>(text[at] ^ (1 << below(8)));
            break;
        case 1:
            if (at < text.size())
                text[at] = static_cast<char>(random_());
            break;
        case 2: text.erase(at, length); break;
        case 3: text.insert(at, tokens[below(std::size(tokens))]); break;
        case 4: text.insert(at, text.substr(below(text.size() + 1), below(64))); break;
        case 5: text.resize(at); break;
        case 6: {  // the rest of another one
            const auto& other = pool_[below(pool_.size())];
            text = text.substr(0, at) + other.substr(below(other.size() + 1));
            break;
        }
        case 7: {  // a number in the file, as a header has it
            const std::uint64_t numbers[] {0,
                                           1,
                                           0x7F,
                                           0x80,
                                           0xFF,
                                           0xFFFF,
                                           0x7FFFFFFF,
                                           0x80000000,
                                           0xFFFFFFFF,
                                           0x7FFFFFFFFFFFFFFF,
                                           0xFFFFFFFFFFFFFFFF,
                                           random_()};
            const auto number = numbers[below(std::size(numbers))];
            for (std::size_t k = 0, bytes = std::size_t(1) << below(4); k < bytes && at + k < text.size(); ++k)
                text[at + k] = static_cast<char>(number >> (8 * k));
            break;
        }
        default: text.replace(at, length, tokens[below(std::size(tokens))]); break;
        }
    }

    std::vector<std::string> pool_;
    std::mt19937_64 random_;
};

/// How long it took of the processor's time, s: the machine may be busy with other things.
double run(std::string input)
{
    current = std::move(input);
    const auto begin = std::clock();
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(current.data()), current.size());
    return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

}  // namespace

int main(int argc, char** argv)
{
    double seconds = 3.0, slowest = 0.0;
    std::uint64_t seed = 1;
    std::vector<std::string> files;
    for (int k = 1; k < argc; ++k) {
        const std::string_view argument = argv[k];
        if (argument == "--seconds" && k + 1 < argc)
            seconds = std::atof(argv[++k]);
        else if (argument == "--seed" && k + 1 < argc)
            seed = static_cast<std::uint64_t>(std::atoll(argv[++k]));
        else
            files.emplace_back(argument);
    }
    for (const int signal : {SIGABRT, SIGSEGV, SIGFPE, SIGBUS})
        std::signal(signal, keep);
    for (const auto& name : files) {
        std::ifstream file(name, std::ios::binary);
        run({std::istreambuf_iterator<char>(file), {}});
    }
    if (!files.empty())
        return 0;
    const auto good = excursion::fuzz::seeds();
    for (const auto& input : good)
        run(input);
    Mutations mutations(good, seed);
    long runs = 0;
    const auto begin = std::chrono::steady_clock::now();
    while (std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() < seconds) {
        const double taken = run(mutations.next());
        if (taken > slowest)
            slowest = taken;
        if (taken > 5.0) {
            std::fprintf(stderr, "an input took %.1f s\n", taken);
            std::abort();
        }
        ++runs;
    }
    std::printf("%zu seeds and %ld mutations of them, the slowest in %.3f s\n", good.size(), runs, slowest);
    return 0;
}
