# Writes the files of the list SOURCES (relative to ROOT) as constants of a C++ file: cmake -DROOT= -DSOURCES= -DOUTPUT= -P
set(entries "")
foreach(name IN LISTS SOURCES)
  file(READ ${ROOT}/${name} text)
  string(APPEND entries "      {\"${name}\", R\"embedded(${text})embedded\"},\n")
endforeach()
file(WRITE ${OUTPUT} "// Generated from kernels/ by cuda/embed.cmake.
#include \"cuda/compiler.hpp\"

namespace evodevo::cuda {

const std::vector<EmbeddedSource>& embedded_sources() {
  static const std::vector<EmbeddedSource> sources{
${entries}  };
  return sources;
}

}  // namespace evodevo::cuda
")
