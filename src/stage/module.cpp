// What a plugin says about itself is checked here, once, so that nothing after this has
// to.

#include "stage/module.h"

#include <dlfcn.h>

#include <cmath>
#include <set>

#include "num/error.h"
#include "stage/abi.h"

namespace brume {
namespace abi {
namespace {

// Bytes of the UTF-8 sequence that begins at s (s[0] is not 0), or 0 when it is broken.
// Overlong forms and surrogates are not told apart: this is for display.
std::size_t utf8_length(const unsigned char* s, std::size_t left) {
  const std::size_t n = s[0] < 0x80                   ? 1
                        : s[0] >= 0xc2 && s[0] < 0xe0 ? 2
                        : s[0] >= 0xe0 && s[0] < 0xf0 ? 3
                        : s[0] >= 0xf0 && s[0] < 0xf5 ? 4
                                                      : 0;
  if (n > left) return 0;
  for (std::size_t i = 1; i < n; ++i)
    if ((s[i] & 0xc0) != 0x80) return 0;
  return n;
}

}  // namespace

std::string text(const char* from, std::size_t longest) {
  std::string out;
  if (!from) return out;
  const std::size_t length = strnlen(from, longest + 1);
  const auto* s = reinterpret_cast<const unsigned char*>(from);
  for (std::size_t i = 0; i < std::min(length, longest);) {
    const std::size_t n = utf8_length(s + i, length - i);
    if (n == 0 || s[i] < 0x20 || s[i] == 0x7f) {
      out += s[i] == '\n' || s[i] == '\t' ? ' ' : '?';
      ++i;
    } else {
      if (i + n > longest) break;
      out.append(from + i, n);
      i += n;
    }
  }
  if (length > longest) out += "...";
  return out;
}

std::string too_small(const char* type, std::size_t found, std::size_t expected) {
  return std::string(type) + " of " + std::to_string(found) +
         " bytes; expected at least " + std::to_string(expected);
}

}  // namespace abi

namespace {

// More than these is no table but garbage.
constexpr std::size_t kMostStages = 1000, kMostParams = 1000, kMostDefaults = 1 << 16,
                      kMostCurve = 1000;

[[noreturn]] void refuse(const std::string& from, const std::string& what,
                         const std::string& hint = {}) {
  throw Error(from, what, hint);
}

bool is_name(const std::string& s) {
  if (s.empty() || s[0] < 'a' || s[0] > 'z') return false;
  for (char c : s)
    if (!((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_')) return false;
  return true;
}

std::vector<std::string> split(const std::string& words) {
  std::vector<std::string> out;
  std::size_t at = 0;
  while (at < words.size()) {
    const std::size_t bar = std::min(words.find('|', at), words.size());
    out.push_back(words.substr(at, bar - at));
    at = bar + 1;
  }
  return out;
}

// What a knob promises: pairs of a value that the parameter may have and a positive
// error, errors falling.
std::vector<double> read_curve(const brume_param& p, const ParamSpec& s,
                               const std::string& owner, const std::string& from) {
  if (p.curve_count == 0) return {};
  if (!p.curve || p.curve_count % 2 || p.curve_count > kMostCurve)
    refuse(from, owner + ": curve_count " + std::to_string(p.curve_count) +
                     " is no list of pairs");
  if (!s.knob || (s.kind != Kind::number && s.kind != Kind::integer))
    refuse(from, owner + ": a curve, but it is no knob of one number");
  std::vector<double> curve(p.curve, p.curve + p.curve_count);
  for (std::size_t i = 0; i < curve.size(); i += 2) {
    const bool within = curve[i] >= s.minimum && curve[i] <= s.maximum;
    const bool falls = i == 0 || curve[i + 1] < curve[i - 1];
    if (!within || !falls || !(curve[i + 1] > 0) || !std::isfinite(curve[i + 1]))
      refuse(from,
             owner + ": its curve makes no sense at " + std::to_string(curve[i]) + ", " +
                 std::to_string(curve[i + 1]),
             "values in its range, errors positive and falling");
  }
  return curve;
}

ParamSpec read_param(const brume_param& p, const std::string& from,
                     const std::string& stage) {
  ParamSpec s;
  s.name = abi::text(p.name);
  if (!is_name(s.name))
    refuse(from, "stage " + stage + " has a parameter named \"" + s.name + "\"",
           "a name is a-z, 0-9 and _, beginning with a letter");
  const std::string owner = stage + "." + s.name;
  // The scene file gives these to every stage.
  for (const char* taken : {"type", "name", "enabled", "mask", "mix", "frames"})
    if (s.name == taken) refuse(from, owner + ": the name is taken by every stage");
  if (!abi::within(p.kind, BRUME_CHOICE))
    refuse(from, owner + ": kind " + std::to_string(abi::raw(p.kind)) +
                     " is none of brume_kind");
  s.kind = Kind(abi::raw(p.kind));
  s.unit = abi::text(p.unit);
  s.doc = abi::text(p.doc, 4000);
  s.minimum = p.minimum;
  s.maximum = p.maximum;
  if (!(p.minimum <= p.maximum))
    refuse(from, owner + ": its range is empty",
           "minimum " + std::to_string(p.minimum) + ", maximum " +
               std::to_string(p.maximum));
  if (p.default_count > kMostDefaults || (p.default_count && !p.default_numbers))
    refuse(from, owner + ": default_count " + std::to_string(p.default_count) +
                     " without numbers");
  s.default_numbers.assign(p.default_numbers, p.default_numbers + p.default_count);
  s.default_text = abi::text(p.default_text, 4000);
  s.words = split(abi::text(p.words, 4000));
  s.knob = p.flags & BRUME_PARAM_KNOB;
  s.animatable = !(p.flags & BRUME_PARAM_STATIC);
  s.infinite = p.flags & BRUME_PARAM_INFINITE;
  s.curve = read_curve(p, s, owner, from);
  if (s.kind == Kind::choice && s.words.empty())
    refuse(from, owner + ": a choice without words");
  try {
    check(s, default_value(s), {.source = from}, stage);
  } catch (const Error& e) {
    refuse(from, "the default of " + owner + " is not allowed", e.what_found);
  }
  return s;
}

std::vector<ParamSpec> read_params(const brume_stage& stage, const std::string& from,
                                   const std::string& name) {
  std::vector<ParamSpec> specs;
  if (stage.param_count == 0) return specs;
  if (!stage.params || stage.param_count > kMostParams)
    refuse(from, "stage " + name + ": param_count " + std::to_string(stage.param_count) +
                     " without parameters");
  // An array of structs whose size is the plugin's.
  const std::size_t stride = stage.params[0].size;
  if (stride < abi::kFirstSize<brume_param> || stride % alignof(brume_param) ||
      stride > 4096)
    refuse(from, "stage " + name + ": " +
                     abi::too_small("brume_param", stride, abi::kFirstSize<brume_param>));
  std::set<std::string> seen;
  for (std::size_t i = 0; i < stage.param_count; ++i) {
    const auto* p = reinterpret_cast<const brume_param*>(
        reinterpret_cast<const char*>(stage.params) + i * stride);
    if (p->size != stride)
      refuse(from, "stage " + name + ": parameters of different sizes",
             std::to_string(stride) + " and " + std::to_string(p->size) + " bytes");
    specs.push_back(read_param(abi::copy(p), from, name));
    if (!seen.insert(specs.back().name).second)
      refuse(from, "stage " + name + " has two parameters named " + specs.back().name);
  }
  return specs;
}

StageType read_stage(const brume_stage* given, const std::string& from,
                     const std::string& version) {
  if (!given) refuse(from, "a stage that is null");
  if (given->size < abi::kFirstSize<brume_stage>)
    refuse(from,
           abi::too_small("brume_stage", given->size, abi::kFirstSize<brume_stage>));
  StageType t;
  t.table = abi::copy(given);
  const brume_stage& s = t.table;
  t.name = abi::text(s.name);
  t.summary = abi::text(s.summary, 4000);
  t.from = from;
  t.version = version;
  if (!is_name(t.name))
    refuse(from, "a stage named \"" + t.name + "\"",
           "a name is a-z, 0-9 and _, beginning with a letter");
  if (!abi::within(s.role, BRUME_LENS))
    refuse(from, "stage " + t.name + ": role " + std::to_string(abi::raw(s.role)) +
                     " is none of brume_role");
  t.role = s.role;
  if (t.role == BRUME_SURFACE && !abi::within(s.step, BRUME_INTERFACE_STEP))
    refuse(from, "stage " + t.name + ": step " + std::to_string(abi::raw(s.step)) +
                     " is none of brume_surface_step");
  if (t.role == BRUME_SURFACE) t.step = s.step;
  const char* missing = !s.create                           ? "create"
                        : !s.destroy                        ? "destroy"
                        : t.role == BRUME_AIR && !s.publish ? "publish"
                        : t.role != BRUME_AIR && !s.run     ? "run"
                                                            : nullptr;
  if (missing) refuse(from, "stage " + t.name + " has no function " + missing);
  t.specs = read_params(s, from, t.name);
  if (s.baseline || s.baseline_run) t.baseline = abi::text(s.baseline_name);
  return t;
}

}  // namespace

std::vector<StageType> read_plugin(brume_plugin_fn entry, const std::string& from) {
  const brume_plugin_info* info = nullptr;
  try {
    info = entry();
  } catch (...) {
    refuse(from, "brume_plugin threw an exception", "it must return a table");
  }
  if (!info) refuse(from, "brume_plugin returned no table");
  if (info->size < offsetof(brume_plugin_info, version))
    refuse(from, abi::too_small("brume_plugin_info", info->size,
                                abi::kFirstSize<brume_plugin_info>));
  // The version comes before the rest, whose meaning depends on it.
  if (info->abi != BRUME_ABI)
    refuse(from, "built for plugin interface " + std::to_string(info->abi),
           "this brume has " + std::to_string(BRUME_ABI));
  if (info->size < abi::kFirstSize<brume_plugin_info>)
    refuse(from, abi::too_small("brume_plugin_info", info->size,
                                abi::kFirstSize<brume_plugin_info>));
  if (!info->stages || info->stage_count == 0 || info->stage_count > kMostStages)
    refuse(from, "a plugin with " + std::to_string(info->stage_count) + " stages" +
                     (info->stages ? "" : " and no list of them"));
  std::vector<StageType> types;
  std::set<std::string> seen;
  for (std::size_t i = 0; i < info->stage_count; ++i) {
    types.push_back(read_stage(info->stages[i], from, abi::text(info->version)));
    if (!seen.insert(types.back().name).second)
      refuse(from, "carries two stages named " + types.back().name);
  }
  return types;
}

std::vector<StageType> open_module(const std::filesystem::path& file) {
  const std::string from = file.string();
  // A path without a slash would be looked up in the system's libraries.
  const std::string path = from.find('/') == std::string::npos ? "./" + from : from;
  void* handle = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!handle) {
    std::string why = abi::text(dlerror());
    // dlerror repeats the file, which stands in front already.
    if (why.starts_with(path + ": ")) why.erase(0, path.size() + 2);
    refuse(from, "cannot be opened as a plugin", why);
  }
  try {
    const auto entry = reinterpret_cast<brume_plugin_fn>(dlsym(handle, "brume_plugin"));
    if (!entry)
      refuse(from, "no symbol brume_plugin", "a stage plugin exports it (src/plugin.h)");
    return read_plugin(entry, from);
  } catch (...) {
    dlclose(handle);
    throw;
  }
}

}  // namespace brume
