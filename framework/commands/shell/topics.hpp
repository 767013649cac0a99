// The topics that `evodevo help TOPIC` and the manual page explain.
#pragma once

#include <string>
#include <vector>

namespace evodevo {

struct Definition {
  std::string term;
  std::string text;
};

struct Topic {
  std::string name;
  std::string summary;                  ///< one line
  std::vector<std::string> text;        ///< paragraphs
  std::vector<Definition> definitions;  ///< definitions that follow the text
  std::string example;                  ///< lines that follow the definitions; they are not wrapped
};

const std::vector<Topic>& topics();

}  // namespace evodevo
