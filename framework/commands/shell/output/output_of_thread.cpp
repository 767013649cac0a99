#include "commands/shell/output/output_of_thread.hpp"

#include <unistd.h>

#include <iostream>

namespace evodevo {
namespace {

thread_local std::streambuf* target_of_thread = nullptr;

/// Passes what each thread writes on to the thread's target or, if it has none, to another buffer.
class Switch final : public std::streambuf {
 public:
  explicit Switch(std::ostream& stream) : otherwise_(stream.rdbuf()) { stream.rdbuf(this); }

 private:
  std::streambuf& target() const { return target_of_thread != nullptr ? *target_of_thread : *otherwise_; }

  int_type overflow(int_type character) override {
    if (traits_type::eq_int_type(character, traits_type::eof())) return traits_type::not_eof(character);
    return target().sputc(traits_type::to_char_type(character));
  }
  std::streamsize xsputn(const char* text, std::streamsize count) override { return target().sputn(text, count); }
  int sync() override { return target().pubsync(); }

  std::streambuf* otherwise_;
};

}  // namespace

OutputOfThread::OutputOfThread(std::streambuf* target) : before_(target_of_thread) {
  target_of_thread = target;
  if (target == nullptr) return;
  // never destroyed, because threads may print until the process ends
  static const Switch *const output = new Switch(std::cout), *const errors = new Switch(std::cerr);
  static_cast<void>(output), static_cast<void>(errors);
}

OutputOfThread::~OutputOfThread() { target_of_thread = before_; }

bool prints_on_terminal() { return target_of_thread == nullptr && isatty(STDOUT_FILENO) == 1; }

}  // namespace evodevo
