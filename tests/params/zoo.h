#pragma once
// A stage's parameters of every kind, for tests.

#include "params/describe.h"

namespace brume {

struct Zoo {
  double density = 0.002;
  Rgb tint{0.25, 0.5, 0.75};
  RgbOr color{{0.5, 0.6, 0.7}, ""};
  RgbOr source{{}, "sky"};
  Vec3 place{1, 2, 3};
  int count = 3;
  bool on = true;
  std::vector<double> heights{10, 20};
  std::vector<std::string> layers{"T"};
  Matrix4 frame{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  std::string note = "plain";
  std::string shape = "box";
  double end = std::numeric_limits<double>::infinity();
  double steps = 8;
  int seed = 1;

  template <class V>
  void describe(V& v) {
    v("density", density,
      {.unit = "1/m", .doc = "Extinction.", .minimum = 0, .maximum = 10});
    v("tint", tint, {.doc = "A colour.", .minimum = 0});
    v("color", color, {.doc = "A colour | or a word.", .words = {"sky", "sun"}});
    v("source", source, {.doc = "A word unless given.", .words = {"sky"}});
    v("place", place, {.unit = "m", .doc = "A point."});
    v("count", count, {.doc = "How many.", .minimum = 1, .maximum = 100});
    v("on", on, {.doc = "Whether."});
    v("heights", heights, {.unit = "m", .doc = "Some heights."});
    v("layers", layers, {.doc = "Some names."});
    v("frame", frame, {.doc = "A transform."});
    v("note", note, {.doc = "A remark."});
    v("shape", shape, {.doc = "A form.", .words = {"box", "ellipsoid"}});
    v("end", end, {.unit = "m", .doc = "Where it ends.", .minimum = 0});
    v("steps", steps, {.doc = "Accuracy.", .minimum = 1, .maximum = 1e6, .knob = true});
    v("seed", seed, {.doc = "Which noise.", .animatable = false});
  }
};

}  // namespace brume
