# evodevo_add_plugin(NAME SOURCES file... VERSION x.y.z LICENSE id)
#
# Adds a library of operators that the host loads at run time. The library exports one symbol, has no undefined symbols,
# and shares nothing with the host except function calls. Its sources can use the version and licence as the macros
# EVODEVO_PLUGIN_VERSION and EVODEVO_PLUGIN_LICENSE.
function(evodevo_add_plugin name)
  cmake_parse_arguments(arg "" "VERSION;LICENSE" "SOURCES" ${ARGN})
  if(NOT arg_SOURCES OR NOT arg_VERSION OR NOT arg_LICENSE)
    message(FATAL_ERROR "evodevo_add_plugin(${name}): SOURCES, VERSION and LICENSE are needed")
  endif()
  set(target evodevo_plugin_${name})
  add_library(${target} MODULE ${arg_SOURCES})
  evodevo_compile_as_plugin(${target})
  target_compile_definitions(${target} PRIVATE
    EVODEVO_PLUGIN_VERSION="${arg_VERSION}" EVODEVO_PLUGIN_LICENSE="${arg_LICENSE}")
  # hidden visibility does not apply to instances of the standard library's templates; the version script hides these
  target_link_options(${target} PRIVATE -Wl,-z,defs
    -Wl,--version-script=${CMAKE_CURRENT_FUNCTION_LIST_DIR}/evodevo_plugin.map)
  set_property(TARGET ${target} APPEND PROPERTY LINK_DEPENDS ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/evodevo_plugin.map)
  set_target_properties(${target} PROPERTIES
    PREFIX "" OUTPUT_NAME ${name} SUFFIX ".evodevo.so" LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib/evodevo)
  install(TARGETS ${target} LIBRARY DESTINATION lib/evodevo)
endfunction()

# Sets how the sources of a plugin are compiled.
function(evodevo_compile_as_plugin target)
  target_link_libraries(${target} PRIVATE evodevo::sdk)
  # an index out of range ends the program, instead of giving results that depend on what lies there
  target_compile_definitions(${target} PRIVATE _GLIBCXX_ASSERTIONS)
  # with GNU unique symbols, all libraries would use the class of whichever library was loaded first
  target_compile_options(${target} PRIVATE -ffp-contract=off $<$<CXX_COMPILER_ID:GNU>:-fno-gnu-unique>)
  if(evodevo_GCC_ABI AND CMAKE_CXX_COMPILER_ID STREQUAL GNU)  # set by evodevoConfig.cmake
    target_compile_options(${target} PRIVATE -fabi-version=${evodevo_GCC_ABI})
  endif()
  set_target_properties(${target} PROPERTIES
    CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON CXX_EXTENSIONS OFF)
endfunction()
