// A module whose entry throws.
#include <stdexcept>

#include "plugin.h"

extern "C" BRUME_EXPORT const brume_plugin_info* brume_plugin() {
  throw std::runtime_error("not today");
}
