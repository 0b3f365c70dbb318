#pragma once
// Where in the picture the air can matter: the rays of all other pixels meet no medium,
// and are not even made.

#include <optional>
#include <vector>

#include "scene/view.h"
#include "scene/world.h"

namespace brume {

/// The pixels whose rays may meet media, by row: a row's columns from `first` up to
/// `end`.
class Extent {
 public:
  struct Columns {
    int first = 0, end = 0;
  };

  /// Nothing yet; rows and columns of `picture` are told apart.
  explicit Extent(const Window& picture);

  /// Adds the pixels that may meet the medium, and returns their window, which may be
  /// empty. Null: all of them, and always from then on (no bounds, the eye near or within
  /// them, a view of all around).
  std::optional<Window> add(const brume_medium&, const View&);
  void add_everything() { everywhere_ = true; }

  bool everywhere() const { return everywhere_; }
  /// Of row y, cut to [x0, x1).
  Columns row(int y, int x0, int x1) const;
  /// The smallest window that holds them all; of one pixel where there are none.
  Window bounds() const;

 private:
  Window picture_;
  bool everywhere_ = false;
  std::vector<Columns> rows_;
};

}  // namespace brume
