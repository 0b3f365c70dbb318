// Tables, each built once.

#include "stage/cache.h"

#include <iterator>

namespace brume {

StageCache::~StageCache() {
  for (auto it = finished_.rbegin(); it != finished_.rend(); ++it)
    if ((*it)->destroy) (*it)->destroy((*it)->object);
}

const void* StageCache::get(const std::string& key, Build build, void* argument,
                            Destroy destroy) {
  std::unique_lock lock(mutex_);
  // Wait while another thread builds; if it fails, its slot is gone and we try ourselves.
  for (;;) {
    const auto found = slots_.find(key);
    if (found == slots_.end()) break;
    const std::shared_ptr<Slot> slot = found->second;
    if (!slot->building) return slot->object;
    if (slot->builder == std::this_thread::get_id()) return nullptr;
    changed_.wait(lock, [&] { return !slot->building; });
    if (slot->object) return slot->object;
  }
  const auto slot = std::make_shared<Slot>();
  slot->builder = std::this_thread::get_id();
  slot->destroy = destroy;
  slots_.emplace(key, slot);

  lock.unlock();
  void* object = nullptr;
  try {
    object = build ? build(argument) : nullptr;
  } catch (...) {
    // Nothing crosses the border; a plugin that wants to say why does so through fail.
  }
  lock.lock();

  slot->building = false;
  slot->object = object;
  if (object)
    finished_.push_back(slot);
  else
    slots_.erase(key);
  changed_.notify_all();
  return object;
}

}  // namespace brume
