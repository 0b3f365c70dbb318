#include "image/exr_writer.h"

namespace brume::exr {

Writer::Writer(const std::filesystem::path& path, std::span<const Part> parts,
               std::uint32_t flags)
    : file_(path), parts_(parts), multi_part_(flags & kMultiPartFlag) {
  std::vector<std::vector<NamedAttribute>> attributes;
  for (const Part& part : parts) attributes.push_back(part.attributes);
  const std::vector<std::uint8_t> header = serialize(attributes, flags);
  file_.append(header.data(), header.size());
  tables_at_ = file_.size();
  for (const Part& part : parts) {
    offsets_.emplace_back(part.chunk_count(), 0);
    file_.append(offsets_.back().data(), 8 * offsets_.back().size());
  }
}

void Writer::add(int p, std::int64_t i, std::span<const std::uint8_t> payload) {
  flush();
  const Part& part = parts_[p];
  std::int32_t head[6];
  int ints = 0;
  if (multi_part_) head[ints++] = p;
  if (part.tiles) {
    head[ints++] = static_cast<std::int32_t>(i % part.tiles_across());
    head[ints++] = static_cast<std::int32_t>(i / part.tiles_across());
    head[ints++] = 0;
    head[ints++] = 0;
  } else {
    head[ints++] = part.chunk_window(i).y;
  }
  head[ints++] = static_cast<std::int32_t>(payload.size());
  offsets_[p][i] = file_.size();
  file_.append(head, 4 * ints);
  file_.append(payload.data(), payload.size());
}

void Writer::copy(int p, std::int64_t i, const File& from, const File::Extent& at) {
  constexpr std::uint64_t kMost = 16 << 20;  // now and then, for progress
  if (&from != from_ || at.offset != from_end_ || from_end_ - from_begin_ > kMost) {
    flush();
    from_ = &from;
    from_begin_ = at.offset;
  }
  from_end_ = at.offset + at.size();
  offsets_[p][i] = file_.size() + (at.offset - from_begin_);
}

void Writer::flush() {
  if (from_) from_->copy(from_begin_, from_end_ - from_begin_, file_);
  from_ = nullptr;
}

void Writer::commit() {
  flush();
  std::uint64_t at = tables_at_;
  for (const auto& table : offsets_) {
    file_.write_at(at, table.data(), 8 * table.size());
    at += 8 * table.size();
  }
  file_.commit();
}

}  // namespace brume::exr
