#pragma once
// Tables shared by frames and stages: what brume_host::shared gives.

#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace brume {

/// Objects by key, each built once. Thread-safe. Lives as long as the pipeline and must
/// outlive every instance made with it; destroys what it holds in the reverse of the
/// order in which it was finished, so that a table may refer to one that it asked for.
class StageCache {
 public:
  StageCache() = default;
  ~StageCache();
  StageCache(const StageCache&) = delete;
  StageCache& operator=(const StageCache&) = delete;

  using Build = void* (*)(void* argument);
  using Destroy = void (*)(void*);

  /// The object under `key`. When it is not there, one caller builds and the others wait.
  /// A build may ask for other keys, never in a circle (asking for its own is noticed,
  /// over two threads it would wait forever). Null: the build failed (returned null or
  /// threw); nothing is kept and the next caller tries again.
  const void* get(const std::string& key, Build, void* argument, Destroy);

 private:
  struct Slot {
    bool building = true;
    std::thread::id builder;
    void* object = nullptr;
    Destroy destroy = nullptr;
  };
  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::string, std::shared_ptr<Slot>, std::less<>> slots_;
  std::vector<std::shared_ptr<Slot>> finished_;
};

}  // namespace brume
