// What `evodevo help TOPIC` explains, and the manual page as well.
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
  std::vector<Definition> definitions;  ///< behind the text
  std::string example;                  ///< behind the definitions; lines as they are
};

const std::vector<Topic>& topics();

}  // namespace evodevo
