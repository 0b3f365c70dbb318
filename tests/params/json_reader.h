#pragma once
// Whether a text is JSON (RFC 8259), by its grammar alone.

#include <cctype>
#include <cstring>
#include <string_view>

namespace brume {

class JsonReader {
 public:
  explicit JsonReader(std::string_view s) : s_(s) {}
  bool document() {
    const bool good = value();
    space();
    return good && i_ == s_.size();
  }

 private:
  void space() {
    while (i_ < s_.size() && std::strchr(" \t\r\n", s_[i_])) ++i_;
  }
  bool take(char c) {
    space();
    if (i_ >= s_.size() || s_[i_] != c) return false;
    ++i_;
    return true;
  }
  bool word(std::string_view w) {
    if (s_.substr(i_, w.size()) != w) return false;
    i_ += w.size();
    return true;
  }
  bool text() {
    if (!take('"')) return false;
    for (; i_ < s_.size() && s_[i_] != '"'; ++i_) {
      if (static_cast<unsigned char>(s_[i_]) < 0x20) return false;
      if (s_[i_] == '\\' && (++i_ >= s_.size() || !std::strchr("\"\\/bfnrtu", s_[i_])))
        return false;
    }
    return take('"');
  }
  bool digits() {
    const std::size_t from = i_;
    while (i_ < s_.size() && std::isdigit(static_cast<unsigned char>(s_[i_]))) ++i_;
    return i_ > from;
  }
  bool number() {
    word("-");
    if (s_.substr(i_, 1) == "0")
      ++i_;
    else if (!digits())
      return false;
    if (word(".") && !digits()) return false;
    if (word("e") || word("E")) {
      if (!word("+")) word("-");
      return digits();
    }
    return true;
  }
  template <class Item>
  bool items(char close, Item item) {
    if (take(close)) return true;
    do {
      if (!item()) return false;
    } while (take(','));
    return take(close);
  }
  bool value() {
    space();
    if (word("true") || word("false") || word("null")) return true;
    if (take('{')) return items('}', [&] { return text() && take(':') && value(); });
    if (take('[')) return items(']', [&] { return value(); });
    return i_ < s_.size() && s_[i_] == '"' ? text() : number();
  }

  std::string_view s_;
  std::size_t i_ = 0;
};

inline bool is_json(std::string_view s) { return JsonReader(s).document(); }

}  // namespace brume
