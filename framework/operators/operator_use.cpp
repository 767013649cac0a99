#include "operators/operator_use.hpp"

#include "base/text.hpp"

namespace evodevo {

void blame_operator(const OperatorCall& call, const std::string& what) {
  const std::string unnamed = call.title == nullptr ? std::string(call.kind) + " " : "";
  throw std::runtime_error(unnamed + text_of(call) + ": " + printable(what, 2000) +
                           "; correct the operator and build it again, or begin a new run without it");
}

}  // namespace evodevo
