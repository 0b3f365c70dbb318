#pragma once
// Which channels of which files a frame is made from: internal to src/pipeline.

#include <string>
#include <vector>

#include "pipeline/pipeline.h"

namespace brume {

/// "file:channel" or "channel" taken apart. The file part is what stands before the last
/// colon and has a dot or a slash in it (channel names have neither colon).
struct ChannelName {
  std::string file, channel;
};
ChannelName parse_channel(const std::string& text);

/// Collects the input channels of a frame, each once, and checks that they are there.
class InputList {
 public:
  InputList(const FrameSource& source, std::vector<InputChannel>& inputs)
      : source_(source), inputs_(inputs) {}

  /// Index of the channel among the inputs. Throws Error when the file has no such
  /// channel, or the file is not there, with the nearest name.
  int add(const std::string& text, const std::string& purpose);
  int add(const std::string& file, const std::string& channel,
          const std::string& purpose);
  /// The same, but -1 when the frame has no such channel.
  int add_if_present(const std::string& text, const std::string& purpose);

  /// Header of the frame's own file ("") or another.
  const ImageHeader& header(const std::string& file) const;
  std::string where(const std::string& file) const {
    return file.empty() ? source_.name : file;
  }

 private:
  const FrameSource& source_;
  std::vector<InputChannel>& inputs_;
};

/// Red, green and blue of a layer: "" finds the colour of the file (R G B, else a layer
/// *.Combined, rgba, RGBA, beauty, or the only R G B there is); a layer name takes its .R
/// .G .B (or .r .g .b). Throws Error when it is not there or not clear.
struct ColorNames {
  std::string rgb[3], alpha;  ///< alpha "" when there is none
  std::string why;
};
ColorNames find_color(const ImageHeader&, const std::string& layer,
                      const std::string& where);

/// Names of a three-component layer: "N" gives N.X N.Y N.Z, or .x, or .R .G .B. Throws
/// Error.
std::vector<std::string> find_vector(const ImageHeader&, const std::string& layer,
                                     const std::string& where);

}  // namespace brume
