// The base class of all operators.
#pragma once

#include "evodevo/parameters.hpp"

namespace evodevo {

/// The base class of all operators. An operator holds its parameters and no other data. Its functions are therefore
/// const, and several threads may call them at once; the host stores everything that outlives a call. An exception that
/// leaves an operator ends the run; the generations committed before are kept.
class Operator {
 public:
  virtual ~Operator() = default;

  /// Declares every parameter of the operator with one call of a function of Parameters.
  virtual void parameters(Parameters&) {}
};

}  // namespace evodevo
