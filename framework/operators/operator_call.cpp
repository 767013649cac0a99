#include "operators/operator_call.hpp"

#include <pthread.h>

#include <atomic>
#include <csignal>
#include <iostream>
#include <map>
#include <memory>
#include <mutex>
#include <set>

#include "base/line.hpp"

namespace evodevo {
namespace {

/// Size of the alternate stack for signal handlers, bytes. They need it if a thread's own stack has overflowed.
constexpr std::size_t handler_stack_size = 1 << 16;

/// The call that a thread is executing. Other threads and signal handlers may read it. There is no lock, since the
/// process may fork at any time and a signal handler may interrupt the thread anywhere.
struct Slot {
  std::atomic<std::uint64_t> version = 0;  ///< odd while the other members are being written
  std::atomic<const OperatorTitle*> title = nullptr;
  std::atomic<std::int64_t> individual = CallSubject::none, cycle = CallSubject::none, seed = CallSubject::none;

  std::atomic<bool> taken = true;
  Slot* next = nullptr;
  const char* lowest_of_stack = nullptr;
  std::unique_ptr<char[]> handler_stack;

  void set(const OperatorCall& call) {
    const std::uint64_t before = version.load(std::memory_order_relaxed);
    version.store(before + 1, std::memory_order_relaxed);
    title.store(call.title, std::memory_order_release);
    individual.store(call.subject.individual, std::memory_order_release);
    cycle.store(call.subject.cycle, std::memory_order_release);
    seed.store(call.seed, std::memory_order_release);
    version.store(before + 2, std::memory_order_release);
  }
  OperatorCall get() const {
    return {title.load(std::memory_order_acquire),
            {individual.load(std::memory_order_acquire), cycle.load(std::memory_order_acquire)},
            seed.load(std::memory_order_acquire)};
  }
};

/// The list of all slots. Slots are never freed; a new thread takes over the slot of a thread that has ended.
std::atomic<Slot*> slots = nullptr;
thread_local Slot* slot_of_thread = nullptr;

Slot& free_slot() {
  for (Slot* slot = slots; slot != nullptr; slot = slot->next)
    if (!slot->taken.exchange(true)) return *slot;
  auto* slot = new Slot;
  slot->handler_stack = std::make_unique<char[]>(handler_stack_size);
  slot->next = slots;
  while (!slots.compare_exchange_weak(slot->next, slot)) {
  }
  return *slot;
}

const char* find_lowest_of_stack() {
  pthread_attr_t attributes;
  void* lowest = nullptr;
  std::size_t size = 0;
  if (pthread_getattr_np(pthread_self(), &attributes) != 0) return nullptr;
  pthread_attr_getstack(&attributes, &lowest, &size);
  pthread_attr_destroy(&attributes);
  return static_cast<const char*>(lowest);
}

/// Holds a thread's slot from the thread's first call of an operator until the thread ends.
class SlotOfThread {
 public:
  SlotOfThread() : slot_(free_slot()) {
    slot_.lowest_of_stack = find_lowest_of_stack();
    stack_t stack{}, present{};
    stack.ss_sp = slot_.handler_stack.get();
    stack.ss_size = handler_stack_size;
    // if a sanitizer has set an alternate stack already, it will also remove that stack itself
    sigaltstack(nullptr, &present);
    gives_stack_ = (present.ss_flags & SS_DISABLE) != 0 && sigaltstack(&stack, nullptr) == 0;
    slot_of_thread = &slot_;
  }
  ~SlotOfThread() {
    if (slot_.get().title != nullptr) return;  // an operator called exit(), and its name is still needed
    slot_of_thread = nullptr;
    stack_t none{};
    none.ss_flags = SS_DISABLE;
    if (gives_stack_) sigaltstack(&none, nullptr);
    slot_.taken = false;
  }
  SlotOfThread(const SlotOfThread&) = delete;
  SlotOfThread& operator=(const SlotOfThread&) = delete;

 private:
  Slot& slot_;
  bool gives_stack_ = false;
};

Slot& slot() {
  if (slot_of_thread == nullptr) thread_local const SlotOfThread made;
  return *slot_of_thread;
}

void name_change(const OperatorCall& call, const std::string& what) {
  static std::mutex mutex;
  static std::set<std::pair<const OperatorTitle*, std::string>> named;
  const std::lock_guard lock(mutex);
  if (call.title == nullptr || !named.emplace(call.title, what).second) return;
  const bool flushes = what.find("flush-to-zero") != std::string::npos;
  std::cerr << "warning: " << call.title->whole << ": it changed " << what
            << ", which has been put back; remove what changes it"
            << (flushes ? ", such as the compiler's option -ffast-math" : "") << '\n';
}

}  // namespace

const OperatorTitle* lasting_title(std::string_view kind, std::string_view name, const std::string& file) {
  static std::mutex mutex;
  static auto& titles = *new std::map<std::string, OperatorTitle>;
  std::string whole = std::string(kind) + (name.empty() ? " " : " operator \"" + std::string(name) + "\" of ") + file;
  const std::lock_guard lock(mutex);
  return &titles.try_emplace(whole, OperatorTitle{whole, file}).first->second;
}

Line& operator<<(Line& line, const OperatorCall& call) {
  line << (call.title != nullptr ? std::string_view(call.title->whole) : "operator");
  if (call.subject.individual != CallSubject::none) line << ", individual " << call.subject.individual;
  if (call.subject.cycle != CallSubject::none) line << ", cycle " << call.subject.cycle;
  if (call.seed != CallSubject::none) line << ", seed " << call.seed;
  return line;
}

std::string text_of(const OperatorCall& call) {
  Line line;
  line << call;
  return std::string(line.text());
}

OperatorCall current_call() { return slot_of_thread != nullptr ? slot_of_thread->get() : OperatorCall{}; }

const char* lowest_of_stack() { return slot_of_thread != nullptr ? slot_of_thread->lowest_of_stack : nullptr; }

void for_each_call(const std::function<void(const void*, std::uint64_t, const OperatorCall&)>& see) {
  for (const Slot* slot = slots; slot != nullptr; slot = slot->next) {
    const std::uint64_t version = slot->version.load(std::memory_order_acquire);
    const OperatorCall call = slot->get();
    const bool whole = version % 2 == 0 && slot->version.load(std::memory_order_relaxed) == version;
    if (whole && call.title != nullptr) see(slot, version, call);
  }
}

InOperator::InOperator(const OperatorCall& call) : before_(slot().get()) { slot().set(call); }

InOperator::~InOperator() {
  const std::string changed = surroundings_.restore();
  if (!changed.empty()) name_change(slot().get(), changed);
  slot().set(before_);
}

}  // namespace evodevo
