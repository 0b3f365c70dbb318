#include "image/exr_plan.h"

#include <algorithm>

#include "num/error.h"

namespace brume::exr {
namespace {

// Output channels: the source's by their bits, the edit's as planes. A source that is no
// EXR has no bits to copy: its other channels become planes too.
void plan_channels(CopyPlan& plan, const ImageReader& source, const Edit& edit,
                   const std::string& where) {
  const bool by_bits = dynamic_cast<const Reader*>(&source);
  const std::vector<Channel>& have = source.header().channels;
  struct Planned {
    Channel channel;
    Origin origin;
  };
  std::vector<Planned> all;
  for (std::size_t i = 0; i < edit.channels.size(); ++i) {
    Channel c = edit.channels[i];
    const int from = source.header().find(c.name);
    plan.plane_sources.push_back(from);
    if (from >= 0 && !edit.retype) c = have[from];
    for (const Planned& other : all)
      if (other.channel.name == c.name)
        throw Error(where, "channel " + c.name + " is written twice");
    all.push_back({c, {from, static_cast<int>(i)}});
  }
  for (std::size_t i = 0; i < have.size() && !edit.only_these; ++i) {
    const auto known = std::find_if(all.begin(), all.end(), [&](const Planned& p) {
      return p.channel.name == have[i].name;
    });
    if (known != all.end()) continue;
    Origin origin{static_cast<int>(i), -1};
    if (!by_bits) {
      origin.plane = static_cast<int>(plan.plane_sources.size());
      plan.plane_sources.push_back(static_cast<int>(i));
    }
    all.push_back({have[i], origin});
  }
  std::sort(all.begin(), all.end(), [](const Planned& a, const Planned& b) {
    return a.channel.name < b.channel.name;
  });
  for (Planned& p : all) {
    plan.channels.push_back(p.channel);
    plan.origins.push_back(p.origin);
  }
}

// The output's headers: the source's bytes, but for what changes.
void plan_part(CopyPlan& plan, const ImageReader& source, const Edit& edit,
               const std::string& where) {
  const auto* reader = dynamic_cast<const Reader*>(&source);
  for (const auto& [name, value] : edit.attributes)
    for (const char* fixed : {"channels", "compression", "dataWindow", "displayWindow",
                              "pixelAspectRatio", "lineOrder", "tiles", "type",
                              "chunkCount", "name", "view", "dwaCompressionLevel"})
      if (name == fixed) throw Error(where, "attribute " + name + " cannot be set");
  ImageHeader header = source.header();
  header.channels = plan.channels;
  if (edit.compression) header.compression = *edit.compression;
  if (edit.dwa_level) header.dwa_level = edit.dwa_level;

  std::vector<NamedAttribute> keep;
  if (reader) {
    for (const Part& p : reader->file().parts()) {
      plan.parts.push_back(p);
      plan.parts.back().offsets.clear();
    }
    plan.part = reader->part_index();
    plan.flags = reader->file().flags();
    keep = plan.parts[plan.part].attributes;
  } else {
    plan.parts.resize(1);
    header.deep = false;
    if (header.display_window.empty()) header.display_window = header.data_window;
    if (header.tiled) {
      plan.flags |= kTiledFlag;
      // One level: the pixels of others are not ours to invent.
      Attribute& tiles = header.attributes["tiles"];
      if (tiles.type != "tiledesc" || tiles.bytes.size() != 9)
        tiles = {"tiledesc", {64, 0, 0, 0, 64, 0, 0, 0, 0}};
      tiles.bytes[8] = 0;
    }
  }
  for (const auto& [name, value] : edit.attributes) header.attributes[name] = value;
  Part& part = plan.parts[plan.part];
  part.header = header;
  part.attributes = attributes_of(header, std::move(keep), std::nullopt);
  part.header = {};
  understand(part, plan.flags, where);
  part.attributes = attributes_of(part.header, part.attributes, part.chunk_count());

  plan.copyable = reader && header.channels == source.header().channels &&
                  header.compression == source.header().compression &&
                  header.dwa_level == source.header().dwa_level;
  if (reader && part.tiles && part.tiles->levels != Tiles::Levels::one &&
      (!plan.copyable || !edit.channels.empty()))
    throw Error(source.path().string(),
                "holds mipmap or ripmap levels, which would not follow a change",
                "make a one-level copy first (exrmaketiled without -m or -r)");
}

// Bands hold whole chunks of source and output, and start where the data window does.
void plan_bands(CopyPlan& plan, const ImageReader& source, bool whole_frame) {
  const auto* reader = dynamic_cast<const Reader*>(&source);
  const Part& part = plan.parts[plan.part];
  const int height = part.header.data_window.height;
  plan.band_rows = std::max(part.chunk_lines(), reader ? reader->band_rows() : 1);
  if (!part.tiles) {
    // Work on single rows is all overhead.
    constexpr int kFewestRows = 16;
    plan.band_rows = std::max(plan.band_rows, kFewestRows);
  }
  if (whole_frame) plan.band_rows = height;
  plan.band_rows = std::min(plan.band_rows, height);
  plan.bands = (height + plan.band_rows - 1) / plan.band_rows;
  plan.descending = part.line_order == LineOrder::decreasing;
}

}  // namespace

Window CopyPlan::band_window(int b) const {
  const Window& d = edited().header.data_window;
  const int y = b * band_rows;
  return {d.x, d.y + y, d.width, std::min(band_rows, d.height - y)};
}

std::vector<std::int64_t> CopyPlan::chunks_of(const Window& rows) const {
  const std::int64_t lines = edited().chunk_lines(), across = edited().tiles_across();
  const std::int64_t first = (rows.y - edited().header.data_window.y) / lines;
  const std::int64_t count = (rows.height + lines - 1) / lines;
  std::vector<std::int64_t> chunks;
  for (std::int64_t r = 0; r < count; ++r)
    for (std::int64_t a = 0; a < across; ++a)
      chunks.push_back((first + (descending ? count - 1 - r : r)) * across + a);
  return chunks;
}

CopyPlan plan_copy(const ImageReader& source, const Edit& edit,
                   const std::filesystem::path& out, bool whole_frame) {
  CopyPlan plan;
  plan_channels(plan, source, edit, out.string());
  plan_part(plan, source, edit, out.string());
  plan_bands(plan, source, whole_frame);
  return plan;
}

}  // namespace brume::exr
