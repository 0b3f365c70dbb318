#include "json.h"

#include <fmt/format.h>

#include <cmath>

#include "params/text.h"

namespace brume::cli {

void Json::line() { text_ += '\n' + std::string(2 * levels_.size(), ' '); }

void Json::next() {
  if (after_key_) {
    after_key_ = false;
    return;
  }
  if (levels_.empty()) return;
  if (!levels_.back().empty) text_ += ',';
  levels_.back().empty = false;
  line();
}

Json& Json::open(char c) {
  next();
  text_ += c;
  levels_.push_back({c == '{' ? '}' : ']'});
  return *this;
}

Json& Json::end() {
  const Level level = levels_.back();
  levels_.pop_back();
  if (!level.empty) line();
  text_ += level.close;
  return *this;
}

Json& Json::key(std::string_view name) {
  next();
  text_ += detail::quoted(name) + ": ";
  after_key_ = true;
  return *this;
}

Json& Json::value(std::string_view text) {
  next();
  text_ += detail::quoted(text);
  return *this;
}

Json& Json::value(double number) {
  if (!std::isfinite(number)) return value(fmt::format("{}", number));
  next();
  text_ += fmt::format("{}", number);
  return *this;
}

Json& Json::value(bool flag) { return raw(flag ? "true" : "false"); }

Json& Json::raw(std::string_view json) {
  next();
  text_ += json;
  return *this;
}

}  // namespace brume::cli
