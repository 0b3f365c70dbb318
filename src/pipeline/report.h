#pragma once
// Plans and reports as JSON.

#include <string>

#include "pipeline/frame_file.h"

namespace brume {

/// The library's version, "0.1.0".
const char* version();

/// A plan as JSON on one line: what `brume/report` holds.
std::string plan_json(const Plan&);

}  // namespace brume
