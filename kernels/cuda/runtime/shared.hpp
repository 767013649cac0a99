// What several simulators of this process share.
#pragma once

#include <map>
#include <memory>
#include <mutex>

namespace evodevo::cuda {

/// Objects by their keys. An object exists as long as somebody holds it. Several threads may use this.
template <class Key, class Object>
class Shared {
 public:
  /// Returns the object of a key. If there is none, it is the result of `make()`.
  template <class Make>
  std::shared_ptr<Object> get(const Key& key, const Make& make) {
    const std::lock_guard lock(mutex_);
    std::weak_ptr<Object>& current = objects_[key];
    std::shared_ptr<Object> object = current.lock();
    if (!object) current = object = make();
    return object;
  }

 private:
  std::mutex mutex_;
  std::map<Key, std::weak_ptr<Object>> objects_;
};

}  // namespace evodevo::cuda
