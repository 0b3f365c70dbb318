#pragma once
// What the tests of edited copies share.

#include "image/exr_format.h"
#include "image/io.h"
#include "image/oracle.h"
#include "image/support.h"

namespace brume::oracle {

inline Spec base(Compression c = Compression::zip) {
  Spec s;
  s.channels = all_types();
  s.compression = c;
  s.data = {-5, 7, 61, 77};
  s.attributes = {{"comment", "string", "made for a test"},
                  {"studio/thing", "a_type_nobody_knows", std::string("\0\1\2\377", 4)},
                  {"an_attribute_name_longer_than_thirty_one_letters", "string", "x"}};
  return s;
}

/// Adds 1 to the channels; the rest of the edit as given.
inline Edit changes(std::initializer_list<const char*> names) {
  Edit e;
  for (const char* n : names) e.channels.push_back({n, PixelType::float32});
  return e;
}
inline auto plus_one(int width) {
  return [width](Band& b) {
    for (float* plane : b.out)
      for (std::int64_t i = 0; i < std::int64_t(b.rows) * width; ++i) plane[i] += 1;
  };
}

inline std::map<std::string, std::string> attribute_bytes(
    const std::filesystem::path& path, int part = 0) {
  std::map<std::string, std::string> all;
  const exr::File file(path);
  for (const exr::NamedAttribute& a : file.parts()[part].attributes)
    all[a.name] =
        a.value.type + ":" + std::string(a.value.bytes.begin(), a.value.bytes.end());
  return all;
}

/// A file like this, opened, and where a copy of it goes.
struct Made {
  TempFile in{"in.exr"}, out{"out.exr"};
  std::unique_ptr<const ImageReader> source;
  Made(const Spec& s, unsigned seed, bool odd = false) {
    write(s, in.path, seed, odd);
    source = open_image(in.path);
  }
};

}  // namespace brume::oracle
