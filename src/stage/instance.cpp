// Calls into plugins, and what is made of their answers.

#include "stage/instance.h"

#include <exception>
#include <limits>
#include <mutex>
#include <new>
#include <vector>

#include "num/error.h"
#include "stage/abi.h"
#include "stage/validate.h"

namespace brume {
namespace {

// One call: the host as the plugin sees it, and what it says meanwhile. A plugin may say
// it from a thread of its own.
class Call {
 public:
  explicit Call(StageCache& cache) : cache_(cache) {}

  const brume_host* host() const { return &host_; }
  std::string said() const {
    const std::lock_guard lock(mutex_);
    return said_;
  }
  bool failed() const {
    const std::lock_guard lock(mutex_);
    return failed_;
  }
  // The first is nearest to the cause.
  void fail(const std::string& message) {
    const std::lock_guard lock(mutex_);
    if (!failed_) said_ = message;
    failed_ = true;
  }

 private:
  static Call& of(const brume_host* host) { return *static_cast<Call*>(host->context); }
  static void on_fail(const brume_host* host, const char* message) {
    try {
      of(host).fail(abi::text(message));
    } catch (...) {
      of(host).fail({});  // no memory for the text
    }
  }
  static const void* on_shared(const brume_host* host, const char* key,
                               void* (*build)(void*), void* argument,
                               void (*destroy)(void*)) {
    try {
      return of(host).cache_.get(key ? key : "", build, argument, destroy);
    } catch (...) {
      return nullptr;
    }
  }

  StageCache& cache_;
  mutable std::mutex mutex_;
  bool failed_ = false;
  std::string said_;
  brume_host host_{sizeof(brume_host), BRUME_ABI, this, on_fail, on_shared};
};

// Takes what a stage publishes, checked, until all of it is known to be good.
struct Collector {
  Call& call;
  int stage;
  const std::string& stage_name;
  World taken;
  brume_publisher table{
      sizeof(brume_publisher), this, medium, light, shadower, interface_, background};

  template <class T>
  static brume_status take(brume_publisher* p, const T* given, const char* type,
                           std::vector<Published<T>> World::*list) {
    auto& c = *static_cast<Collector*>(p->context);
    try {
      std::string wrong;
      if (!given) {
        wrong = "null";
      } else if (given->size < abi::kFirstSize<T>) {
        wrong = abi::too_small(type, given->size, abi::kFirstSize<T>);
      } else {
        Published<T> one{abi::copy(given), c.stage, {}};
        const std::string own = abi::text(one.what.name);
        one.name = own.empty() ? c.stage_name : c.stage_name + "/" + own;
        one.what.name = "";
        wrong = abi::wrong_with(one.what);
        if (wrong.empty()) {
          (c.taken.*list).push_back(std::move(one));
          return BRUME_OK;
        }
        if (!own.empty()) wrong = "\"" + own + "\": " + wrong;
      }
      c.call.fail(std::string("published a ") + type + " that makes no sense: " + wrong);
      return BRUME_FAILED;
    } catch (...) {
      c.call.fail("no memory for what it published");
      return BRUME_NO_MEMORY;
    }
  }
  static brume_status medium(brume_publisher* p, const brume_medium* m) {
    return take(p, m, "brume_medium", &World::media);
  }
  static brume_status light(brume_publisher* p, const brume_light* l) {
    return take(p, l, "brume_light", &World::lights);
  }
  static brume_status shadower(brume_publisher* p, const brume_shadower* s) {
    return take(p, s, "brume_shadower", &World::shadowers);
  }
  static brume_status interface_(brume_publisher* p, const brume_interface* i) {
    return take(p, i, "brume_interface", &World::interfaces);
  }
  static brume_status background(brume_publisher* p, const brume_background* b) {
    return take(p, b, "brume_background", &World::backgrounds);
  }
};

template <class T>
void append(std::vector<Published<T>>& to, std::vector<Published<T>>&& from) {
  to.insert(to.end(), std::make_move_iterator(from.begin()),
            std::make_move_iterator(from.end()));
}

std::vector<std::string> names(const char* const* list, std::size_t count) {
  std::vector<std::string> out;
  // Channel names of an EXR are shorter than 256 bytes.
  for (std::size_t i = 0; i < count; ++i) out.push_back(abi::text(list[i], 255));
  return out;
}

void set(double to[3], const glm::dvec3& from) {
  for (int i = 0; i < 3; ++i) to[i] = from[i];
}

// What a stage is told of a frame.
struct Told {
  brume_frame frame{};
  std::vector<const char*> channels;
  explicit Told(const FrameInfo&);
};

Told::Told(const FrameInfo& f) {
  brume_frame& out = frame;
  out.size = sizeof out;
  out.frame = f.frame;
  out.time = f.time;
  out.fps = f.fps;
  set(out.eye, f.eye);
  set(out.up, f.up);
  set(out.forward, f.forward);
  set(out.camera_right, f.camera_right);
  set(out.camera_up, f.camera_up);
  out.has_camera = f.has_camera;
  out.pixel_footprint = f.pixel_footprint;
  out.orthographic = f.orthographic();
  out.projection = int(f.projection);
  set(out.corner, f.corner);
  set(out.across, f.across);
  set(out.down, f.down);
  out.display_x = f.display.x;
  out.display_y = f.display.y;
  out.display_width = f.display.width;
  out.display_height = f.display.height;
  out.tolerance = f.tolerance;
  out.white = f.white;
  std::copy(f.chromaticities.begin(), f.chromaticities.end(), out.chromaticities);
  out.has_sun = f.sun.has_value();
  if (f.sun) {
    set(out.to_sun, f.sun->to);
    set(out.sun_irradiance, f.sun->irradiance);
  }
  for (const std::string& c : f.channels) channels.push_back(c.c_str());
  out.channels = channels.data();
  out.channel_count = channels.size();
  out.mix = f.mix;
}

}  // namespace

// Calls into the plugin with a host of its own; what comes of it is nothing or an Error.
// `f` returns the status as the number it is (abi::raw): it may be none of brume_status.
template <class F>
void StageInstance::call(const char* function, F&& f) const {
  Call call(*cache_);
  std::string problem;
  bool thrown = false;
  int status = BRUME_OK;
  try {
    status = f(call);
  } catch (const std::bad_alloc&) {
    status = BRUME_NO_MEMORY;
  } catch (const std::exception& e) {
    thrown = true;
    problem = "threw " + abi::text(e.what());
  } catch (...) {
    thrown = true;
    problem = "threw something that is no std::exception";
  }
  if (!thrown) {
    if (call.failed() && !call.said().empty())
      problem = call.said();
    else if (status == BRUME_NO_MEMORY)
      problem = "no memory";
    else if (status == BRUME_FAILED || call.failed())
      problem = "failed and did not say why";
    else if (status != BRUME_OK)
      problem =
          "returned status " + std::to_string(status) + ", which is none of brume_status";
    else
      return;
  }
  const std::string stage =
      name_ == type_->name ? name_ : name_ + " (" + type_->name + ")";
  throw Error(where_.source.empty() ? type_->from : where_.text(),
              stage + ": " + function + ": " + problem,
              where_.source.empty() ? "" : "the plugin is " + type_->from);
}

void FrameInfo::look(const View& view) {
  has_camera = true;
  eye = view.eye;
  forward = view.forward;
  camera_right = view.right;
  camera_up = view.up;
  pixel_footprint = view.pixel_footprint();
  projection = view.projection;
  corner = view.corner;
  across = view.across;
  down = view.down;
}

StageInstance::Self::~Self() {
  if (!destroy) return;
  try {
    destroy(self);
  } catch (...) {
    // Nothing can be told to anyone from here, and nothing depends on it.
  }
}

StageInstance::StageInstance(const StageType& type, std::string name,
                             std::span<const Value> values, StageCache& cache,
                             Location where)
    : type_(&type), name_(std::move(name)), cache_(&cache), where_(std::move(where)) {
  std::vector<brume_value> list;
  for (const Value& v : values)
    list.push_back({v.numbers.data(), v.numbers.size(), v.text.c_str()});
  call("create", [&](Call& c) {
    void* self = nullptr;
    const int status = abi::raw(type_->table.create(c.host(), list.data(), &self));
    if (status == BRUME_OK) {
      self_.self = self;
      self_.destroy = type_->table.destroy;
    }
    return status;
  });
}

StageNeeds StageInstance::needs(const FrameInfo& info) {
  if (!type_->table.needs) return {};
  const Told told(info);
  brume_needs n{};
  n.size = sizeof n;
  n.farthest = std::numeric_limits<double>::infinity();
  call("needs", [&](Call& c) {
    const int status =
        abi::raw(type_->table.needs(self_.self, c.host(), &told.frame, &n));
    const std::string wrong = status == BRUME_OK ? abi::wrong_with(n) : "";
    if (!wrong.empty()) c.fail("its answer makes no sense: " + wrong);
    return status;
  });
  StageNeeds out;
  if (n.idle) {
    out.idle = abi::text(n.idle);
    if (out.idle.empty()) out.idle = "it has nothing to do";
  }
  out.channels = names(n.channels, n.channel_count);
  out.optional = names(n.optional, n.optional_count);
  out.camera = n.needs_camera;
  out.depth = n.needs_depth;
  out.whole_frame = n.whole_frame;
  out.rows_around = n.rows_around;
  out.columns_around = n.columns_around;
  out.changes_alpha = n.changes_alpha;
  for (std::size_t i = 0; i < 4; ++i) out.screen[i] = n.screen[i];
  out.nearest = n.nearest;
  out.farthest = n.farthest;
  out.lights = n.lights;
  out.laws = n.laws;
  out.promise = n.promise;
  return out;
}

void StageInstance::publish(const FrameInfo& info, int stage, World& world) {
  if (!type_->table.publish) return;
  const Told told(info);
  World taken;
  call("publish", [&](Call& c) {
    Collector collector{c, stage, name_, {}};
    const int status = abi::raw(
        type_->table.publish(self_.self, c.host(), &told.frame, &collector.table));
    taken = std::move(collector.taken);
    return status;
  });
  append(world.media, std::move(taken.media));
  append(world.lights, std::move(taken.lights));
  append(world.shadowers, std::move(taken.shadowers));
  append(world.interfaces, std::move(taken.interfaces));
  append(world.backgrounds, std::move(taken.backgrounds));
}

void StageInstance::baseline(const brume_rays& rays, const float* t1, float* const L[3],
                             float* const T[3]) const {
  call("baseline", [&](Call& c) {
    return abi::raw(type_->table.baseline(self_.self, c.host(), &rays, t1, L, T));
  });
}

void StageInstance::run(const brume_tile& tile) const {
  call("run",
       [&](Call& c) { return abi::raw(type_->table.run(self_.self, c.host(), &tile)); });
}

void StageInstance::run_baseline(const brume_tile& tile) const {
  call("baseline", [&](Call& c) {
    return abi::raw(type_->table.baseline_run(self_.self, c.host(), &tile));
  });
}

void StageInstance::truth(const brume_tile& tile, std::span<const int> xy,
                          double* rgb) const {
  call("truth", [&](Call& c) {
    return abi::raw(
        type_->table.truth(self_.self, c.host(), &tile, xy.size() / 2, xy.data(), rgb));
  });
}

}  // namespace brume
