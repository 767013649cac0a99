// Calls of operators' own code: known to whoever has to name them, and without effect on the rest of the program.
#pragma once

#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "operators/surroundings.hpp"

namespace evodevo {

/// How messages call an operator, or a library.
struct OperatorTitle {
  std::string whole;  ///< such as: devo operator "erosion" of /home/me/erosion.evodevo.so
  std::string file;
};

/// A title that stays where it is until the process ends: handlers of signals and other threads may look at it late.
const OperatorTitle* lasting_title(std::string_view kind, std::string_view name, const std::string& file);

/// For whom an operator is called.
struct CallSubject {
  static constexpr std::int64_t none = -1;
  std::int64_t individual = none, cycle = none;
};

/// A call of an operator's own code.
struct OperatorCall {
  const OperatorTitle* title = nullptr;  ///< nullptr: the operator is no library's
  CallSubject subject = {};
  std::int64_t seed = CallSubject::none;  ///< of the experiment
  std::string_view kind = {};             ///< of an operator without a title; not known to those who look on
};

/// "devo operator "erosion" of FILE, individual 5, cycle 3, seed 7", as far as it is known.
std::string text_of(const OperatorCall& call);

class Line;
Line& operator<<(Line& line, const OperatorCall& call);

/// What this thread is calling; without a title outside of operators. May be asked in a handler of signals.
OperatorCall current_call();

/// What all threads are calling at this moment. `see(thread, number, call)`: calls with equal numbers of one thread are
/// one and the same.
void for_each_call(const std::function<void(const void*, std::uint64_t, const OperatorCall&)>& see);

/// Where this thread's stack ends, towards which it grows; nullptr before its first call. May be asked in a handler of
/// signals.
const char* lowest_of_stack();

/// While it lives, this thread is in the code of an operator. When it goes it puts back what that code has changed of
/// the program's surroundings, and says so on stderr, once for each operator.
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

/// Calls the own code of an operator. Whatever it throws comes out as a std::exception.
template <class Call>
decltype(auto) in_operator(const OperatorCall& whose, const Call& call) {
  const InOperator guard(whose);
  try {
    return call();
  } catch (const std::exception&) {
    throw;
  } catch (...) {
    throw std::runtime_error("it threw something that is no std::exception");
  }
}

}  // namespace evodevo
