#pragma once
// JSON schema (draft 2020-12) of what the params say, for editors that complete and check
// TOML while it is typed.

#include <span>
#include <string>

#include "params/params.h"

namespace brume {

/// The schema of one parameter's value: its plain forms, and keyframes where it may be
/// animated.
std::string value_schema(const ParamSpec&);

/// {"type": "object", "properties": {...}, "additionalProperties": false}; `extra`: more
/// properties as ready JSON members, `required`: names that must be there.
std::string object_schema(std::span<const ParamSpec>, const std::string& extra = {},
                          std::span<const std::string> required = {});

inline constexpr const char* kSchemaDialect =
    "https://json-schema.org/draft/2020-12/schema";

}  // namespace brume
