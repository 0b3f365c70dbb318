#include "interrupt.h"

#include <signal.h>

namespace brume::cli {

namespace {

std::atomic<bool> stop{false};
std::atomic<int> signals{0};

void on_signal(int number) {
  stop.store(true);
  if (signals.fetch_add(1) < 2) return;
  ::signal(number, SIG_DFL);
  ::raise(number);
}

}  // namespace

const std::atomic<bool>& interrupted() { return stop; }

void catch_interrupts() {
  static_assert(std::atomic<bool>::is_always_lock_free);
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before {};
    // One that was ignored when we started (nohup) stays ignored.
    if (::sigaction(number, nullptr, &before) == 0 && before.sa_handler == SIG_IGN)
      continue;
    ::sigaction(number, &action, nullptr);
  }
  // A broken pipe and a file beyond its limit become errors of the write.
  ::signal(SIGPIPE, SIG_IGN);
  ::signal(SIGXFSZ, SIG_IGN);
}

}  // namespace brume::cli
