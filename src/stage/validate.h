#pragma once
// Whether what a stage published makes sense.

#include <string>

#include "plugin.h"

namespace brume::abi {

// Each returns "" or what is wrong, "extinction 1 is nan". Sizes have been checked.
std::string wrong_with(const brume_medium&);
std::string wrong_with(const brume_light&);
std::string wrong_with(const brume_shadower&);
std::string wrong_with(const brume_interface&);
std::string wrong_with(const brume_background&);
std::string wrong_with(const brume_needs&);

}  // namespace brume::abi
