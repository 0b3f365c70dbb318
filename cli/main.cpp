// brume: the command line. Errors are caught here, once, and become one line and an exit
// code.

#include <exception>
#include <new>
#include <system_error>

#include "arguments.h"
#include "commands.h"
#include "num/error.h"

int main(int argc, char** argv) {
  using namespace brume::cli;
  Terminal terminal;
  try {
    const Invocation what = parse(argc, argv);
    terminal.loudness = what.loudness;
    return what.run(terminal);
  } catch (const UsageError& e) {
    terminal.error(e.what());
    return kUsage;
  } catch (const brume::Error& e) {
    terminal.error(e.what());
    return kFailed;
  } catch (const std::bad_alloc&) {
    terminal.error("out of memory; fewer --threads or a --proxy need less");
    return kTryAgain;
  } catch (const std::system_error& e) {  // no thread, no descriptor left
    terminal.error(e.what());
    return kTryAgain;
  } catch (const std::exception& e) {
    terminal.error(e.what());
    return kFailed;
  }
}
