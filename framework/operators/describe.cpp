#include "operators/describe.hpp"

#include "operators/loader.hpp"

namespace evodevo {
namespace {

class ParameterDescriber final : public Describer<Parameters> {};

}  // namespace

std::vector<ParameterDescription> describe_parameters(Operator& op) {
  ParameterDescriber describer;
  op.parameters(describer);
  return std::move(describer.found);
}

std::vector<ParameterDescription> describe_parameters(const AvailableOperator& available) {
  return in_operator({available.title}, [&] { return describe_parameters(*create<Operator>(available)); });
}

}  // namespace evodevo
