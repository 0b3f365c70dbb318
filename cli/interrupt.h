#pragma once
// Ctrl-C, SIGTERM and SIGHUP: stop without leaving half a file.

#include <atomic>

namespace brume::cli {

/// Set once a signal has come. From then on everything ends as soon as it can clean up; a
/// third signal ends the program as it stands.
const std::atomic<bool>& interrupted();

/// Catches the signals for the rest of the process. Broken pipes and
/// files beyond their limit become write errors.
void catch_interrupts();

}  // namespace brume::cli
