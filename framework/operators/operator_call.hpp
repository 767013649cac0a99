// Calls of operators' code. Error messages can name the call that a thread is executing. Settings of the program that a
// call changes are restored after the call.
#pragma once

#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "operators/surroundings.hpp"

namespace evodevo {

/// The name of an operator, or of a library, in messages.
struct OperatorTitle {
  std::string whole;  ///< full name, such as: devo operator "erosion" of /home/me/erosion.evodevo.so
  std::string file;
};

/// Returns a title that stays valid until the process ends, because signal handlers and other threads may read it at
/// any time.
const OperatorTitle* lasting_title(std::string_view kind, std::string_view name, const std::string& file);

/// The individual, and the cycle of its life, for which an operator is called.
struct CallSubject {
  static constexpr std::int64_t none = -1;
  std::int64_t individual = none, cycle = none;
};

/// A call of an operator's code.
struct OperatorCall {
  const OperatorTitle* title = nullptr;  ///< nullptr if the operator does not come from a library
  CallSubject subject = {};
  std::int64_t seed = CallSubject::none;  ///< seed of the experiment
  std::string_view kind = {};  ///< kind of an operator without a title; empty in the result of current_call()
};

/// Returns a text such as: devo operator "erosion" of FILE, individual 5, cycle 3, seed 7. Unknown parts are left out.
std::string text_of(const OperatorCall& call);

class Line;
Line& operator<<(Line& line, const OperatorCall& call);

/// Returns the call that this thread is executing. The call has no title if the thread is not in an operator's code. A
/// signal handler may call this function.
OperatorCall current_call();

/// Calls `see(thread, number, call)` for each thread that is in an operator's code at this moment. `thread` and
/// `number` together identify the call.
void for_each_call(const std::function<void(const void*, std::uint64_t, const OperatorCall&)>& see);

/// Returns the lowest address of this thread's stack, towards which the stack grows, or nullptr before the thread's
/// first call of an operator. A signal handler may call this function.
const char* lowest_of_stack();

/// While this object exists, its thread counts as being in the code of an operator. The destructor restores those of
/// the program's Surroundings that the code has changed. It warns of each such change on stderr, once for each
/// operator.
class InOperator {
 public:
  explicit InOperator(const OperatorCall& call);
  InOperator(const InOperator&) = delete;
  InOperator& operator=(const InOperator&) = delete;
  ~InOperator();

 private:
  OperatorCall before_;
  Surroundings surroundings_;
};

/// Calls an operator's code. If the code throws something that is not a std::exception, throws std::runtime_error
/// instead.
template <class Call>
decltype(auto) in_operator(const OperatorCall& whose, const Call& call) {
  const InOperator guard(whose);
  try {
    return call();
  } catch (const std::exception&) {
    throw;
  } catch (...) {
    throw std::runtime_error("it threw something that is not a std::exception");
  }
}

}  // namespace evodevo
