#pragma once
// A stage plugin in C++: what plugin.h asks for, said once. Header-only; a module needs
// nothing of the library to link with.
//
//   struct Mist : brume::Stage {
//     static constexpr brume::StageAbout about{"mist", "Even mist.", BRUME_AIR};
//     double density = 0.01;
//     template <class V>
//     void describe(V& v) {
//       v("density", density, {.unit = "1/m", .doc = "Extinction.", .minimum = 0});
//     }
//     void publish(const brume_frame&, brume::Publisher& world) override {
//       brume_medium m = brume::new_medium();
//       ...
//       world.medium(m);
//     }
//   };
//   BRUME_STAGES(Mist)
//
// One object is made per frame, its members set from the scene. Throw std::exception to
// fail: the text reaches the user with file and stage before it. Nothing else crosses the
// border.

#include <cstddef>
#include <exception>
#include <limits>
#include <memory>
#include <new>
#include <span>
#include <stdexcept>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "params/describe.h"
#include "plugin.h"
#include "stage/needs.h"

namespace brume {

/// What a stage is, beside its parameters.
struct StageAbout {
  const char* name;     ///< "height_fog"
  const char* summary;  ///< one sentence
  brume_role role;
  brume_surface_step step = BRUME_BACKGROUND_STEP;  ///< surface stages only
  const char* baseline = nullptr;  ///< names what Stage::baseline (air) or
                                   ///< Stage::run_baseline does; null: nothing
  bool has_truth = false;          ///< there is a Stage::truth
};

/// Tables shared by frames and stages (brume_host::shared).
class Shared {
 public:
  explicit Shared(const brume_host* host) : host_(host) {}

  /// The table known under `key`, made by `build()` (returns std::unique_ptr<T>) when it
  /// is not there; one thread builds, others wait. Lives as long as the pipeline. `key`
  /// begins with the plugin's name and holds everything the table depends on. Throws what
  /// build throws, as text.
  template <class T, class Build>
  const T& table(const std::string& key, Build&& build) const;

 private:
  const brume_host* host_;
};

/// What a stage hands to the world in publish. Structs are copied; `self` and functions
/// in them must live as long as the stage: members of the stage object do.
class Publisher {
 public:
  explicit Publisher(brume_publisher* to) : to_(to) {}
  void medium(const brume_medium& m) { check(to_->medium(to_, &m)); }
  void light(const brume_light& l) { check(to_->light(to_, &l)); }
  void shadower(const brume_shadower& s) { check(to_->shadower(to_, &s)); }
  void interface(const brume_interface& i) { check(to_->interface_(to_, &i)); }
  void background(const brume_background& b) { check(to_->background(to_, &b)); }

  /// The host refused a struct and has said why.
  struct Refused {};

 private:
  static void check(brume_status s) {
    if (s != BRUME_OK) throw Refused{};
  }
  brume_publisher* to_;
};

class Stage {
 public:
  Stage() = default;
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;
  virtual ~Stage() = default;

  /// What it wants to read and change, or why it has nothing to do at this frame.
  virtual void needs(const brume_frame&, StageNeeds&) {}
  /// Tables that publish or run use. Called once, after the members are set.
  virtual void prepare(const Shared&) {}
  /// What there is in the world.
  virtual void publish(const brume_frame&, Publisher&) {}
  /// Changes pixels (surface and lens). Called from several threads at once.
  virtual void run(const brume_tile&) const {}
  /// The same as the document does it that the effect comes from (surface and lens); for
  /// comparison only, likewise.
  virtual void run_baseline(const brume_tile&) const {}
  /// What run must make of pixels (xy[0], xy[1]), ... of the tile, in double and by
  /// another way, however slow: 3 numbers a pixel. For comparison only, likewise.
  virtual void truth(const brume_tile&, std::span<const int> /*xy*/,
                     double* /*rgb*/) const {}
  /// L and T of its air alone over [0, t1[i]] of ray i, as the document does it that the
  /// effect comes from; for comparison only. From several threads at once, after publish.
  virtual void baseline(const brume_rays&, const float* /*t1*/, float* const /*L*/[3],
                        float* const /*T*/[3]) const {}
};

/// Structs with every field at its plain value: present everywhere, uniform, clear.
inline brume_medium new_medium() {
  brume_medium m{};
  m.size = sizeof m;
  m.name = "";
  m.shape = BRUME_EVERYWHERE;
  m.local_from_world[0] = m.local_from_world[5] = m.local_from_world[10] = 1;
  m.profile = BRUME_UNIFORM;
  m.direction[2] = 1;
  m.max_opacity = 1;
  return m;
}
inline brume_light new_light() {
  brume_light l{};
  l.size = sizeof l;
  l.name = "";
  l.kind = BRUME_POINT;
  l.direction[2] = 1;
  l.attenuated = 1;
  return l;
}
inline brume_shadower new_shadower() {
  brume_shadower s{};
  s.size = sizeof s;
  s.name = "";
  return s;
}
inline brume_interface new_interface() {
  brume_interface i{};
  i.size = sizeof i;
  i.name = "";
  return i;
}
inline brume_background new_background() {
  brume_background b{};
  b.size = sizeof b;
  b.name = "";
  return b;
}

namespace detail {

/// Runs `body`; what it throws becomes a status and a message to the host.
template <class F>
brume_status at_border(const brume_host* host, F&& body) noexcept {
  try {
    body();
    return BRUME_OK;
  } catch (const Publisher::Refused&) {
    return BRUME_FAILED;
  } catch (const std::bad_alloc&) {
    return BRUME_NO_MEMORY;
  } catch (const std::exception& e) {
    host->fail(host, e.what());
  } catch (...) {
    host->fail(host, "an exception that is no std::exception");
  }
  return BRUME_FAILED;
}

/// A stage as the host holds it, with the memory behind its last answer to needs.
template <class T>
struct Held {
  T stage;
  StageNeeds needs;
  std::vector<const char*> channels, optional;
};

inline std::vector<const char*> pointers(const std::vector<std::string>& texts) {
  std::vector<const char*> p;
  for (const std::string& t : texts) p.push_back(t.c_str());
  return p;
}

inline Value value_from(const brume_value& v) {
  Value out;
  out.numbers.assign(v.numbers, v.numbers + v.count);
  if (v.text) out.text = v.text;
  return out;
}

/// The functions of brume_stage for a Stage type.
template <class T>
struct Entry {
  using Object = Held<T>;

  static brume_status create(const brume_host* host, const brume_value* values,
                             void** self) {
    return at_border(host, [&] {
      auto object = std::make_unique<Object>();
      std::vector<Value> list;
      const std::size_t count = specs_of<T>().size();
      for (std::size_t i = 0; i < count; ++i) list.push_back(value_from(values[i]));
      assign(object->stage, std::span<const Value>(list));
      object->stage.prepare(Shared(host));
      *self = object.release();
    });
  }

  static brume_status needs(void* self, const brume_host* host, const brume_frame* frame,
                            brume_needs* out) {
    return at_border(host, [&] {
      auto& o = *static_cast<Object*>(self);
      o.needs = {};
      o.stage.needs(*frame, o.needs);
      const StageNeeds& n = o.needs;
      o.channels = pointers(n.channels);
      o.optional = pointers(n.optional);
      out->idle = n.idle.empty() ? nullptr : n.idle.c_str();
      out->channels = o.channels.data();
      out->channel_count = o.channels.size();
      out->optional = o.optional.data();
      out->optional_count = o.optional.size();
      out->needs_camera = n.camera;
      out->needs_depth = n.depth;
      out->whole_frame = n.whole_frame;
      out->rows_around = n.rows_around;
      out->columns_around = n.columns_around;
      out->changes_alpha = n.changes_alpha;
      for (int i = 0; i < 4; ++i) out->screen[i] = n.screen[std::size_t(i)];
      out->nearest = n.nearest;
      out->farthest = n.farthest;
      out->lights = n.lights;
      if (out->size > offsetof(brume_needs, laws)) out->laws = n.laws;
      if (out->size > offsetof(brume_needs, promise)) out->promise = n.promise;
    });
  }

  static brume_status publish(void* self, const brume_host* host,
                              const brume_frame* frame, brume_publisher* to) {
    return at_border(host, [&] {
      Publisher publisher(to);
      static_cast<Object*>(self)->stage.publish(*frame, publisher);
    });
  }

  static brume_status run(void* self, const brume_host* host, const brume_tile* tile) {
    return at_border(host, [&] { static_cast<const Object*>(self)->stage.run(*tile); });
  }

  static brume_status baseline(void* self, const brume_host* host, const brume_rays* rays,
                               const float* t1, float* const light[3],
                               float* const through[3]) {
    return at_border(host, [&] {
      static_cast<const Object*>(self)->stage.baseline(*rays, t1, light, through);
    });
  }

  static brume_status baseline_run(void* self, const brume_host* host,
                                   const brume_tile* tile) {
    return at_border(
        host, [&] { static_cast<const Object*>(self)->stage.run_baseline(*tile); });
  }

  static brume_status truth(void* self, const brume_host* host, const brume_tile* tile,
                            std::size_t n, const int* xy, double* rgb) {
    return at_border(host, [&] {
      static_cast<const Object*>(self)->stage.truth(*tile, {xy, 2 * n}, rgb);
    });
  }

  static void destroy(void* self) { delete static_cast<Object*>(self); }
};

/// The table of a stage type, made once from its declaration.
template <class T>
class StageTable {
 public:
  StageTable() : specs_(specs_of<T>()) {
    words_.reserve(specs_.size());
    for (const ParamSpec& s : specs_) {
      std::string words;
      for (const std::string& w : s.words) words += (words.empty() ? "" : "|") + w;
      words_.push_back(std::move(words));
      if (s.kind == Kind::texts)
        throw std::logic_error(s.name +
                               ": a stage has no parameters that are lists of texts");
      std::uint32_t flags = 0;
      if (s.knob) flags |= BRUME_PARAM_KNOB;
      if (!s.animatable) flags |= BRUME_PARAM_STATIC;
      if (s.infinite) flags |= BRUME_PARAM_INFINITE;
      params_.push_back({sizeof(brume_param), s.name.c_str(), brume_kind(s.kind),
                         s.unit.c_str(), s.doc.c_str(), s.minimum, s.maximum,
                         s.default_numbers.data(), s.default_numbers.size(),
                         s.default_text.c_str(), words_.back().c_str(), flags,
                         s.curve.data(), s.curve.size()});
    }
    stage_ = {sizeof(brume_stage), T::about.name,     T::about.summary, T::about.role,
              T::about.step,       params_.data(),    params_.size(),   Entry<T>::create,
              Entry<T>::needs,     Entry<T>::publish, Entry<T>::run,    Entry<T>::destroy,
              T::about.baseline,   nullptr,           nullptr,          nullptr};
    const bool air = T::about.role == BRUME_AIR;
    if (T::about.baseline && air) stage_.baseline = Entry<T>::baseline;
    if (T::about.baseline && !air) stage_.baseline_run = Entry<T>::baseline_run;
    if (T::about.has_truth && !air) stage_.truth = Entry<T>::truth;
  }
  const brume_stage* stage() const { return &stage_; }

 private:
  std::vector<ParamSpec> specs_;
  std::vector<std::string> words_;
  std::vector<brume_param> params_;
  brume_stage stage_{};
};

/// What brume_plugin returns for these stages; null when there is no memory for it.
template <class... T>
const brume_plugin_info* plugin_info(const char* version) noexcept {
  try {
    static const std::tuple<StageTable<T>...> tables;
    static const brume_stage* const stages[] = {
        std::get<StageTable<T>>(tables).stage()...};
    static const brume_plugin_info info{sizeof(brume_plugin_info), BRUME_ABI, version,
                                        stages, sizeof...(T)};
    return &info;
  } catch (...) {
    return nullptr;
  }
}

}  // namespace detail

template <class T, class Build>
const T& Shared::table(const std::string& key, Build&& build) const {
  // The build runs inside a C function: what it throws waits here until that returns.
  struct Job {
    std::remove_reference_t<Build>* build;
    std::string error;
  } job{&build, {}};
  const void* made = host_->shared(
      host_, key.c_str(),
      [](void* j) -> void* {
        Job& waiting = *static_cast<Job*>(j);
        try {
          return std::unique_ptr<T>((*waiting.build)()).release();
        } catch (const std::exception& e) {
          waiting.error = e.what();
        } catch (...) {
          waiting.error = "an exception that is no std::exception";
        }
        return nullptr;
      },
      &job, [](void* t) { delete static_cast<T*>(t); });
  if (!made)
    throw std::runtime_error(job.error.empty() ? "its table could not be made"
                                               : job.error);
  return *static_cast<const T*>(made);
}

}  // namespace brume

#ifndef BRUME_PLUGIN_VERSION
#define BRUME_PLUGIN_VERSION ""
#endif

/// Exports the stages of a plugin, once, at the end of one of its files.
#define BRUME_STAGES(...)                                                   \
  extern "C" BRUME_EXPORT const brume_plugin_info* brume_plugin() {         \
    return ::brume::detail::plugin_info<__VA_ARGS__>(BRUME_PLUGIN_VERSION); \
  }
