// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Error.h"
#include "Engine/Take/Measurement.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

/// A fuzz target reads any bytes: it may refuse them with an Error, and must do nothing else but return something
/// sound. The entry point is libFuzzer's. Without libFuzzer, Replay.cpp calls it with the seeds and with mutations of
/// them.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace excursion::fuzz {

/// Good inputs of the target, small ones, to start from.
std::vector<std::string> seeds();

/// Ends the program when what was read breaks a promise.
void demand(bool holds, const char* promise);

/// Finite values, one a frequency or sample in every channel, frequencies above 0 and ascending, something that drives.
void demandSound(const Take&);

/// A file in memory that readers of paths can open, for as long as this lives.
class MemoryFile {
public:
    MemoryFile(const void* data, std::size_t size);
    ~MemoryFile();
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;
    std::filesystem::path path() const;

private:
    int descriptor_;
};

}  // namespace excursion::fuzz
