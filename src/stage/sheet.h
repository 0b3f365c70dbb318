#pragma once
// A frame's planes as surface and lens stages are given them: what a tile points into.

#include <cstddef>
#include <vector>

#include "image/image.h"
#include "plugin.h"

namespace brume {

/// Pixels in planes, with `around` more on each side (copies of the edge, or what lies
/// there) for what a stage may look at. Every plane has the same layout; empty ones are
/// not there.
struct Sheet {
  int x = 0, y = 0;  ///< display pixel of its corner
  int width = 1, height = 1, around = 0;
  std::ptrdiff_t stride = 1;  ///< from row to row, >= width + 2 around
  std::vector<float> rgb[3], alpha, t, d[3], o[3];
  std::vector<std::vector<float>> channels;

  int size() const { return width * height; }
  std::size_t at(int column, int row) const {
    return std::size_t((row + around) * stride + column + around);
  }
  std::size_t at(int i) const { return at(i % width, i / width); }

  /// Lays out planes of this size, rows `wide` floats longer than need be: black, and
  /// covered. All others are empty.
  void resize(int width, int height, int around, int wide = 0);
  /// A plane of width x height, laid out; empty stays empty.
  std::vector<float> lay(const std::vector<float>& plane) const;
  /// Copies the edge pixels outward.
  void replicate();
  /// The same pixels with rows so much longer, everything so many floats farther on.
  Sheet moved(int wide) const;

  /// A part of it, or all, as a stage is given it. Points into the sheet, which must stay
  /// as it is; moves, does not copy.
  class Tile {
   public:
    Tile(Sheet&, const Window& part, const brume_world*);
    Tile(Tile&&) = default;
    Tile& operator=(Tile&&) = default;
    operator const brume_tile&() const { return tile_; }

   private:
    std::vector<const float*> channels_;
    brume_tile tile_{};
  };
  /// `part` counts from the sheet's corner.
  Tile tile(const Window& part, const brume_world* world) { return {*this, part, world}; }
  Tile tile(const brume_world* world) { return tile({0, 0, width, height}, world); }
};

}  // namespace brume
