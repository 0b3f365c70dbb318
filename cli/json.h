#pragma once
// JSON for standard output: values in the order they are written, two spaces a level.

#include <string>
#include <string_view>
#include <vector>

namespace brume::cli {

class Json {
 public:
  Json& object() { return open('{'); }
  Json& array() { return open('['); }
  Json& end();

  /// The next value's name, inside an object.
  Json& key(std::string_view);

  Json& value(std::string_view text);
  Json& value(const char* text) { return value(std::string_view(text)); }
  Json& value(double);  ///< shortest that reads back; infinite and NaN as text
  Json& value(int n) { return value(double(n)); }
  Json& value(bool);
  Json& raw(std::string_view json);  ///< a value that is JSON already

  template <class List>
  Json& values(const List& list) {
    array();
    for (const auto& v : list) value(v);
    return end();
  }

  /// The document, with a line end. All that was opened must be closed.
  std::string text() const { return text_ + '\n'; }

 private:
  struct Level {
    char close;
    bool empty = true;
  };
  Json& open(char);
  void next();
  void line();

  std::string text_;
  std::vector<Level> levels_;
  bool after_key_ = false;
};

}  // namespace brume::cli
