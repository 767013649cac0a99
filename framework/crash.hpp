// Which operator a crash happens in.
#pragma once

namespace evodevo {

struct OperatorUse;

/// While it lives, this thread is in the code of an operator. What it is given must outlive it; nullptr: of none.
class InOperator {
 public:
  explicit InOperator(const OperatorUse* use);
  InOperator(const InOperator&) = delete;
  InOperator& operator=(const InOperator&) = delete;
  ~InOperator();

 private:
  const OperatorUse* before_;
};

/// From now on a signal that ends the process in an operator's code names the operator on stderr first.
void name_crashing_operators();

}  // namespace evodevo
