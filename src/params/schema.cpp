#include "params/schema.h"

#include <cmath>

#include "params/text.h"

namespace brume {
namespace {

using detail::float_text;
using detail::quoted;

// A number in its range. JSON knows no infinities; an open end is left out.
std::string number_schema(const ParamSpec& s, const char* type) {
  std::string out = std::string("{\"type\": \"") + type + "\"";
  if (std::isfinite(s.minimum)) out += ", \"minimum\": " + float_text(s.minimum);
  if (std::isfinite(s.maximum)) out += ", \"maximum\": " + float_text(s.maximum);
  return out + "}";
}

std::string array_schema(const std::string& items, int count) {
  std::string out = "{\"type\": \"array\", \"items\": " + items;
  if (count > 0)
    out += ", \"minItems\": " + std::to_string(count) +
           ", \"maxItems\": " + std::to_string(count);
  return out + "}";
}

std::string enum_schema(std::span<const std::string> words) {
  std::string out;
  for (const std::string& w : words) out += (out.empty() ? "" : ", ") + quoted(w);
  return "{\"enum\": [" + out + "]}";
}

std::string any_of(std::initializer_list<std::string> schemas) {
  std::string out;
  for (const std::string& s : schemas)
    if (!s.empty()) out += (out.empty() ? "" : ", ") + s;
  return "{\"anyOf\": [" + out + "]}";
}

std::string plain_schema(const ParamSpec& s) {
  const std::string number = number_schema(s, "number");
  const std::string text = "{\"type\": \"string\"}";
  switch (s.kind) {
    case Kind::number:
      return number;
    case Kind::integer:
      return number_schema(s, "integer");
    case Kind::flag:
      return "{\"type\": \"boolean\"}";
    case Kind::rgb:
      return any_of({number, array_schema(number, 3),
                     s.words.empty() ? std::string() : enum_schema(s.words)});
    case Kind::vec3:
      return array_schema(number, 3);
    case Kind::numbers:
      return any_of({number, array_schema(number, 0)});
    case Kind::matrix:
      return any_of({array_schema(number, 16), array_schema(array_schema(number, 4), 4)});
    case Kind::text:
      return text;
    case Kind::choice:
      return enum_schema(s.words);
    case Kind::texts:
      return any_of({text, array_schema(text, 0)});
  }
  return "{}";
}

// JSON for a default; infinities have none.
std::string default_json(const ParamSpec& s) {
  for (const double x : s.default_numbers)
    if (!std::isfinite(x)) return "";
  return ", \"default\": " + print(s, default_value(s));
}

}  // namespace

std::string value_schema(const ParamSpec& s) {
  std::string doc = s.doc;
  if (!s.unit.empty()) doc += (doc.empty() ? "[" : " [") + s.unit + "]";
  const std::string plain = plain_schema(s);
  std::string out = "{\"description\": " + quoted(doc) + default_json(s);
  if (!s.animatable) return out + ", \"anyOf\": [" + plain + "]}";
  const std::string keys =
      "{\"type\": \"object\", \"required\": [\"frames\", \"values\"], "
      "\"additionalProperties\": false, \"properties\": {"
      "\"frames\": {\"type\": \"array\", \"items\": {\"type\": \"number\"}, "
      "\"minItems\": 1}, \"values\": {\"type\": \"array\", \"items\": " +
      plain +
      ", \"minItems\": 1}, \"interpolation\": {\"enum\": [\"linear\", \"smooth\", "
      "\"step\"]}}}";
  return out + ", \"anyOf\": [" + plain + ", " + keys + "]}";
}

std::string object_schema(std::span<const ParamSpec> specs, const std::string& extra,
                          std::span<const std::string> required) {
  std::string members = extra;
  for (const ParamSpec& s : specs)
    members += (members.empty() ? "" : ",\n") + quoted(s.name) + ": " + value_schema(s);
  std::string must;
  for (const std::string& r : required) must += (must.empty() ? "" : ", ") + quoted(r);
  return "{\"type\": \"object\"" +
         (must.empty() ? std::string() : ", \"required\": [" + must + "]") +
         ", \"additionalProperties\": false, \"properties\": {\n" + members + "\n}}";
}

std::string json_schema(std::string_view owner, std::span<const ParamSpec> specs) {
  return "{\"$schema\": " + quoted(kSchemaDialect) + ", \"title\": " + quoted(owner) +
         ", " + object_schema(specs).substr(1) + "\n";
}

}  // namespace brume
