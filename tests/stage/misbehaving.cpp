// Two stages whose parameter `how` says what they do wrong when they are called:
// `misbehaves` is air, `spoils` a lens. Written against plugin.h alone, in C++ only
// because it throws.

#include <cmath>
#include <cstring>
#include <new>
#include <stdexcept>
#include <string>

#include "plugin.h"

namespace {

struct State {
  std::string how;
  std::string text;
};

int alive = 0;

const brume_param kHow = {sizeof(brume_param),
                          "how",
                          BRUME_TEXT,
                          "",
                          "What it does wrong.",
                          -INFINITY,
                          INFINITY,
                          nullptr,
                          0,
                          "",
                          "",
                          0,
                          nullptr,
                          0};

bool is(const State& s, const char* how) { return s.how == how; }

// Ways to fail that every function has: "create silent", "run throws" ...
brume_status fail_somehow(const std::string& how, const brume_host* host) {
  if (how == "says why") host->fail(host, "out of cheese");
  if (how == "twice") {
    host->fail(host, "the cause");
    host->fail(host, "what followed from it");
  }
  if (how == "null message") host->fail(host, nullptr);
  if (how == "long message") host->fail(host, std::string(3 << 20, 'x').c_str());
  if (how == "not utf-8") host->fail(host, "bad \xff\xfe bytes\nand a line");
  if (how == "fails but returns ok") {
    host->fail(host, "said to fail");
    return BRUME_OK;
  }
  if (how == "garbage status") return brume_status(1234567);
  if (how == "negative status") return brume_status(-1);
  if (how == "no memory") return BRUME_NO_MEMORY;
  if (how == "throws") throw std::runtime_error("thrown over the border");
  if (how == "throws bad_alloc") throw std::bad_alloc();
  if (how == "throws int") throw 42;
  return BRUME_FAILED;
}

// "create throws" fails in create with "throws".
bool here(const State& s, const char* function, std::string* way) {
  const std::string prefix = std::string(function) + " ";
  if (s.how.compare(0, prefix.size(), prefix) != 0) return false;
  *way = s.how.substr(prefix.size());
  return true;
}

brume_status create(const brume_host* host, const brume_value* values, void** self) {
  State s{values[0].text, {}};
  std::string way;
  if (here(s, "create", &way)) {
    const brume_status status = fail_somehow(way, host);
    if (status != BRUME_OK) return status;
  }
  ++alive;
  *self = new State(s);
  return BRUME_OK;
}

brume_status needs(void* self, const brume_host* host, const brume_frame*,
                   brume_needs* out) {
  State& s = *static_cast<State*>(self);
  std::string way;
  if (here(s, "needs", &way)) return fail_somehow(way, host);
  static const char* const list[] = {"N.X", nullptr};
  if (is(s, "counts without a list")) out->channel_count = 3;
  if (is(s, "absurd count")) {
    out->channels = list;
    out->channel_count = std::size_t(-1);
  }
  if (is(s, "null channel")) {
    out->channels = list;
    out->channel_count = 2;
  }
  if (is(s, "negative rows")) out->rows_around = -1;
  if (is(s, "nan distance")) out->nearest = NAN;
  if (is(s, "farthest before nearest")) out->nearest = 10, out->farthest = 5;
  if (is(s, "nan promise")) out->promise = NAN;
  if (is(s, "idle")) out->idle = "it is Sunday";
  return BRUME_OK;
}

brume_medium good_medium() {
  brume_medium m;
  std::memset(&m, 0, sizeof m);
  m.size = sizeof m;
  m.name = "mist";
  m.extinction[0] = m.extinction[1] = m.extinction[2] = 0.1;
  m.direction[2] = 1;
  m.max_opacity = 1;
  return m;
}

brume_status publish(void* self, const brume_host* host, const brume_frame*,
                     brume_publisher* world) {
  State& s = *static_cast<State*>(self);
  brume_medium good = good_medium(), m = good;
  // One good medium comes first: it must not reach the World of a stage that fails.
  if (world->medium(world, &good) != BRUME_OK) return BRUME_FAILED;
  std::string way;
  if (here(s, "publish", &way)) return fail_somehow(way, host);
  if (is(s, "null medium")) return world->medium(world, nullptr);
  if (is(s, "small medium")) m.size = 8;
  if (is(s, "nan extinction")) m.extinction[1] = NAN;
  if (is(s, "negative extinction")) m.extinction[1] = -1;
  if (is(s, "infinite extinction")) m.extinction[2] = INFINITY;
  if (is(s, "albedo above 1")) m.albedo[0] = 1.5;
  if (is(s, "g of 1")) m.g = 1;
  if (is(s, "opacity above 1")) m.max_opacity = 1.01;
  if (is(s, "nan start")) m.start = NAN;
  if (is(s, "unknown shape")) m.shape = brume_shape(-3);
  if (is(s, "unknown profile")) m.profile = brume_profile(99);
  if (is(s, "unknown source")) m.source = brume_source(99);
  if (is(s, "unknown phase")) m.phase = brume_phase(3);
  if (is(s, "direction no unit vector"))
    m.profile = BRUME_EXPONENTIAL, m.direction[2] = 0.5;
  if (is(s, "nan falloff")) m.profile = BRUME_EXPONENTIAL, m.falloff = NAN;
  if (is(s, "negative lorentzian")) m.profile = BRUME_LORENTZIAN, m.falloff = -1;
  if (is(s, "nan bounds")) m.shape = BRUME_BOX, m.local_from_world[7] = NAN;
  if (is(s, "custom profile without functions")) m.profile = BRUME_CUSTOM;
  if (is(s, "custom source without functions")) m.source = BRUME_SOURCE_CUSTOM;
  if (is(s, "wavelengths without functions")) m.wavelengths = 3;
  if (is(s, "absurd wavelengths")) m.wavelengths = 1 << 30;
  if (is(s, "name of garbage")) m.name = "\x01\xc3(";
  if (std::memcmp(&m, &good, sizeof m) != 0) {
    // Whether it heeds the answer or not, the host has to know.
    const brume_status answer = world->medium(world, &m);
    return is(s, "albedo above 1") ? BRUME_OK : answer;
  }
  brume_light l;
  std::memset(&l, 0, sizeof l);
  l.size = sizeof l;
  l.kind = BRUME_SPOT;
  l.direction[0] = 1;
  l.cone = 0.5;
  if (is(s, "negative power")) l.power[0] = -1;
  if (is(s, "cone wider than pi")) l.cone = 4;
  if (is(s, "unknown light")) l.kind = brume_light_kind(17);
  if (is(s, "sun without direction")) l.kind = BRUME_SUN, l.direction[0] = 0;
  if (is(s, "lamp nowhere")) l.position[1] = INFINITY;
  if (l.power[0] != 0 || l.cone != 0.5 || l.kind != BRUME_SPOT || l.position[1] != 0)
    return world->light(world, &l);
  if (is(s, "hollow shadower")) {
    const brume_shadower x{sizeof x, "", nullptr, nullptr};
    return world->shadower(world, &x);
  }
  if (is(s, "hollow interface")) {
    const brume_interface x{sizeof x, "", nullptr, nullptr};
    return world->interface_(world, &x);
  }
  if (is(s, "hollow background")) {
    const brume_background x{sizeof x, "", nullptr, nullptr};
    return world->background(world, &x);
  }
  return BRUME_OK;
}

brume_status run(void* self, const brume_host* host, const brume_tile*) {
  std::string way;
  if (here(*static_cast<State*>(self), "run", &way)) return fail_somehow(way, host);
  return BRUME_OK;
}

void destroy(void* self) {
  --alive;
  const State* s = static_cast<State*>(self);
  const bool throws = s->how == "throws in destroy";
  delete s;
  if (throws) throw std::runtime_error("too late");
}

const brume_stage kAir = {sizeof(brume_stage),
                          "misbehaves",
                          "Fails as it is told to.",
                          BRUME_AIR,
                          BRUME_BACKGROUND_STEP,
                          &kHow,
                          1,
                          create,
                          needs,
                          publish,
                          nullptr,
                          destroy,
                          nullptr,
                          nullptr,
                          nullptr,
                          nullptr};
const brume_stage kLens = {sizeof(brume_stage),
                           "spoils",
                           "Fails as it is told to, on pixels.",
                           BRUME_LENS,
                           BRUME_BACKGROUND_STEP,
                           &kHow,
                           1,
                           create,
                           needs,
                           nullptr,
                           run,
                           destroy,
                           nullptr,
                           nullptr,
                           nullptr,
                           nullptr};
const brume_stage* const kStages[] = {&kAir, &kLens};
const brume_plugin_info kInfo = {sizeof(brume_plugin_info), BRUME_ABI, "0.1", kStages, 2};

}  // namespace

extern "C" BRUME_EXPORT const brume_plugin_info* brume_plugin() { return &kInfo; }

/// How many stages were created and not destroyed.
extern "C" BRUME_EXPORT int misbehaving_alive() { return alive; }
