#include "cuda/runtime/memory_store.hpp"

#include <algorithm>

namespace evodevo::cuda {

std::size_t MemoryStore::available() {
  const std::lock_guard lock(mutex_);
  std::size_t bytes = free_memory();
  for (const auto& memory : idle_) bytes += memory->size();
  return bytes;
}

std::unique_ptr<MirroredMemory> MemoryStore::take(std::size_t mirrored, std::size_t more, std::size_t apart) {
  const std::lock_guard lock(mutex_);
  // the smallest that is large enough; if none is, the largest
  const auto later = [&](const auto& a, const auto& b) {
    const bool enough_a = a->holds(mirrored, more, apart), enough_b = b->holds(mirrored, more, apart);
    if (enough_a != enough_b) return enough_b;
    return enough_a ? a->size() > b->size() : a->size() < b->size();
  };
  const auto best = std::max_element(idle_.begin(), idle_.end(), later);
  auto memory = std::make_unique<MirroredMemory>();
  if (best != idle_.end()) {
    memory = std::move(*best);
    idle_.erase(best);
  }
  try {
    memory->resize(mirrored, more, apart);
  } catch (const OutOfMemory&) {
    if (idle_.empty()) throw;
    idle_.clear();
    memory->resize(mirrored, more, apart);
  }
  return memory;
}

void MemoryStore::give_back(std::unique_ptr<MirroredMemory> memory) {
  const std::lock_guard lock(mutex_);
  idle_.push_back(std::move(memory));
}

void MemoryStore::release_idle() {
  const std::lock_guard lock(mutex_);
  idle_.clear();
}

}  // namespace evodevo::cuda
