#include "store.h"

#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string_view>

namespace brume::sky {
namespace {

namespace fs = std::filesystem;

constexpr char kMagic[8] = {'b', 'r', 'u', 'm', 'e', 's', 'k', 'y'};
constexpr std::size_t kMostFiles = 64;  // of .3 to 3 MB each

// FNV-1a (Fowler, Noll, Vo), over words of eight bytes for speed.
std::uint64_t hash(std::string_view bytes, std::uint64_t h = 0xcbf29ce484222325) {
  for (std::size_t i = 0; i < bytes.size(); i += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data() + i, std::min<std::size_t>(8, bytes.size() - i));
    h = (h ^ word) * 0x100000001b3;
    h ^= h >> 32;
  }
  return h;
}

std::string_view bytes_of(const std::vector<float>& v) {
  return {reinterpret_cast<const char*>(v.data()), v.size() * sizeof(float)};
}

// What stands before the numbers; the key follows it.
struct Header {
  char magic[8];
  std::uint64_t key_size, numbers, sum;
};

Header header_of(const std::string& key, std::span<std::vector<float>* const> tables) {
  Header h{};
  std::memcpy(h.magic, kMagic, sizeof kMagic);
  h.key_size = key.size();
  h.sum = hash(key);
  for (const auto* t : tables) h.numbers += t->size(), h.sum = hash(bytes_of(*t), h.sum);
  return h;
}

bool read(std::ifstream& in, void* to, std::size_t size) {
  return bool(in.read(static_cast<char*>(to), static_cast<std::streamsize>(size)));
}

void forget_oldest(const fs::path& folder) {
  std::vector<std::pair<fs::file_time_type, fs::path>> files;
  for (const auto& f : fs::directory_iterator(folder))
    // Those that a process left half written among them.
    if (f.path().filename().string().find(".sky") != std::string::npos)
      files.emplace_back(f.last_write_time(), f.path());
  std::sort(files.begin(), files.end());
  for (std::size_t i = 0; i + kMostFiles < files.size(); ++i) fs::remove(files[i].second);
}

}  // namespace

std::string store_folder() {
  const auto value = [](const char* name) {
    const char* v = std::getenv(name);
    return std::string(v ? v : "");
  };
  if (const std::string own = value("BRUME_CACHE"); !own.empty())
    return own == "off" ? "" : own;
  // The XDG base directory specification: a relative path is to be ignored.
  if (const std::string xdg = value("XDG_CACHE_HOME"); xdg.starts_with('/'))
    return xdg + "/brume";
  if (const std::string home = value("HOME"); home.starts_with('/'))
    return home + "/.cache/brume";
  return "";
}

std::string file_of(const std::string& key) {
  const std::string folder = store_folder();
  if (folder.empty()) return "";
  char name[32];
  std::snprintf(name, sizeof name, "/%016llx.sky",
                static_cast<unsigned long long>(hash(key)));
  return folder + name;
}

bool recall(const std::string& key, std::span<std::vector<float>* const> tables) noexcept
    try {
  const std::string file = file_of(key);
  if (file.empty()) return false;
  std::ifstream in(file, std::ios::binary);
  const Header wanted = header_of(key, tables);
  Header h;
  if (!in || !read(in, &h, sizeof h) ||
      std::memcmp(h.magic, kMagic, sizeof kMagic) != 0 || h.key_size != wanted.key_size ||
      h.numbers != wanted.numbers)
    return false;
  std::string there(key.size(), ' ');
  if (!read(in, there.data(), there.size()) || there != key) return false;
  std::vector<std::vector<float>> found;
  std::vector<std::vector<float>*> to;
  for (const auto* t : tables) {
    auto& one = found.emplace_back(t->size());
    if (!read(in, one.data(), one.size() * sizeof(float))) return false;
  }
  for (auto& one : found) to.push_back(&one);
  if (header_of(key, to).sum != h.sum || in.peek() != std::ifstream::traits_type::eof())
    return false;
  // In place: others point there.
  for (std::size_t i = 0; i < found.size(); ++i)
    std::copy(found[i].begin(), found[i].end(), tables[i]->begin());
  return true;
} catch (...) {
  return false;
}

void keep(const std::string& key, std::span<std::vector<float>* const> tables) noexcept
    try {
  const std::string file = file_of(key);
  if (file.empty()) return;
  const fs::path folder = fs::path(file).parent_path();
  fs::create_directories(folder);
  std::string beside = file + ".XXXXXX";
  const int fd = mkstemp(beside.data());
  if (fd < 0) return;
  std::FILE* out = fdopen(fd, "wb");
  const Header h = header_of(key, tables);
  bool good = out && std::fwrite(&h, sizeof h, 1, out) == 1 &&
              std::fwrite(key.data(), 1, key.size(), out) == key.size();
  for (const auto* t : tables)
    good = good && std::fwrite(t->data(), sizeof(float), t->size(), out) == t->size();
  good = (out ? std::fclose(out) : close(fd)) == 0 && good;
  if (!good || std::rename(beside.c_str(), file.c_str()) != 0)
    fs::remove(beside);
  else
    forget_oldest(folder);
} catch (...) {
}

}  // namespace brume::sky
